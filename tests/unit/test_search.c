#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A library and the signatures in it, at key = 10 n + 3. */
typedef struct {
	eskel_library *library;
	eskel_signature **signatures;
	size_t count;
} shelf;

static int64_t key_of(size_t n)
{
	return 10 * (int64_t)n + 3;
}

/* A tenth of the shapes or less has a cluster in common; one in levels_vary has between 1 and 20 levels (0: none). */
static shelf make_shelf(size_t count, size_t clusters, double noise, size_t levels_vary)
{
	shelf s = {.count = count, .signatures = calloc(count + 1, sizeof *s.signatures)};
	assert_non_null(s.signatures);
	assert_int_equal(eskel_library_new(&s.library), ESKEL_OK);
	for (size_t n = 0; n < count; n++) {
		bool varies = levels_vary && n % levels_vary == 0;
		s.signatures[n] = synthetic_signature(n % clusters, n, noise, varies ? 1 + (uint32_t)(n / 3 % 20) : 16);
		assert_int_equal(eskel_library_add(s.library, key_of(n), s.signatures[n]), ESKEL_OK);
	}
	return s;
}

static void free_shelf(shelf *s)
{
	for (size_t n = 0; n < s->count; n++)
		eskel_signature_free(s->signatures[n]);
	free(s->signatures);
	eskel_library_free(s->library);
}

enum { combinations = 24 };
static eskel_distance_options combination(int n)
{
	return (eskel_distance_options){.signature = n & 1 ? ESKEL_SIGNATURE_PAPER : ESKEL_SIGNATURE_LOG,
		.distance = n & 2 ? ESKEL_DISTANCE_LEVEL : ESKEL_DISTANCE_SUM,
		.size = n & 4 ? ESKEL_SIZE_FREE : ESKEL_SIZE_FIXED,
		.metric = (eskel_metric)(n / 8)};
}

typedef struct {
	double distance;
	int64_t key;
} pair;

static int by_distance_then_key(const void *a, const void *b)
{
	const pair *x = a, *y = b;
	if (x->distance != y->distance)
		return x->distance < y->distance ? -1 : 1;
	return x->key < y->key ? -1 : x->key > y->key;
}

static int by_key(const void *a, const void *b)
{
	const int64_t *x = a, *y = b;
	return *x < *y ? -1 : *x > *y;
}

/* Compares with every shape. free() the pairs. */
static pair *search_exhaustively(const shelf *s, const eskel_signature *query, const eskel_distance_options *options)
{
	pair *pairs = calloc(s->count + 1, sizeof *pairs);
	assert_non_null(pairs);
	for (size_t n = 0; n < s->count; n++) {
		pairs[n].key = key_of(n);
		assert_int_equal(
			eskel_distance(query, s->signatures[n], options, &pairs[n].distance, NULL, NULL), ESKEL_OK);
	}
	qsort(pairs, s->count, sizeof *pairs, by_distance_then_key);
	return pairs;
}

static eskel_search_result *search(const shelf *s, const eskel_signature *query, const eskel_search_options *options)
{
	eskel_search_result *result = NULL;
	assert_int_equal(eskel_library_search(s->library, query, options, &result), ESKEL_OK);
	return result;
}

static void assert_is_answer(const eskel_search_result *result, const pair *expected, size_t count, int options)
{
	assert_int_equal(result->count, count);
	for (size_t n = 0; n < count; n++)
		if (result->neighbours[n].key != expected[n].key ||
			result->neighbours[n].distance != expected[n].distance)
			fail_msg("options %d, neighbour %zu of %zu: key %lld at %.17g, expected %lld at %.17g", options,
				n, count, (long long)result->neighbours[n].key, result->neighbours[n].distance,
				(long long)expected[n].key, expected[n].distance);
}

static void the_exact_search_gives_the_answer_of_comparing_with_every_shape(void **state)
{
	(void)state;
	static const size_t limits[] = {1, 5, 37};
	const struct {
		size_t clusters, levels_vary;
		double noise;
	} cases[] = {{12, 0, 0.1}, {40, 2, 0.3}, {300, 5, 0.3}, {3, 1, 0.02}};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		shelf s = make_shelf(300, cases[c].clusters, cases[c].noise, cases[c].levels_vary);
		for (int o = 0; o < combinations; o++)
			for (uint64_t q = 0; q < 4; q++) {
				eskel_signature *query =
					synthetic_signature(q, 1000 + q, cases[c].noise, q == 3 ? 7 : 16);
				eskel_search_options options = {.distance = combination(o), .mode = ESKEL_SEARCH_EXACT};
				pair *expected = search_exhaustively(&s, query, &options.distance);
				for (size_t l = 0; l < 3; l++) {
					options.limit = limits[l];
					eskel_search_result *result = search(&s, query, &options);
					assert_is_answer(result, expected, limits[l], o);
					assert_true(result->proven);
					eskel_search_result_free(result);
				}
				free(expected);
				eskel_signature_free(query);
			}
		free_shelf(&s);
	}
}

static void the_exact_search_is_right_at_levels_beyond_those_of_the_sum(void **state)
{
	(void)state;
	shelf s = {.count = 60, .signatures = calloc(60, sizeof *s.signatures)};
	assert_int_equal(eskel_library_new(&s.library), ESKEL_OK);
	for (size_t n = 0; n < s.count; n++) {
		s.signatures[n] = synthetic_signature(n % 6, n, 0.2, n % 4 ? 30 : 12);
		assert_int_equal(eskel_library_add(s.library, key_of(n), s.signatures[n]), ESKEL_OK);
	}
	for (int o = 0; o < combinations; o++) {
		eskel_search_options options = {.distance = combination(o), .mode = ESKEL_SEARCH_EXACT};
		options.distance.level = 24;
		pair *expected = search_exhaustively(&s, s.signatures[5], &options.distance);
		eskel_search_result *result = search(&s, s.signatures[5], &options);
		assert_is_answer(result, expected, 5, o);
		eskel_search_result_free(result);
		free(expected);
	}
	free_shelf(&s);
}

static void neighbours_come_with_their_levels(void **state)
{
	(void)state;
	shelf s = make_shelf(50, 10, 0.2, 4);
	for (int o = 0; o < combinations; o++) {
		eskel_search_options options = {.distance = combination(o), .limit = 50};
		eskel_search_result *result = search(&s, s.signatures[1], &options);
		for (size_t n = 0; n < result->count; n++) {
			const eskel_neighbour *neighbour = &result->neighbours[n];
			double distance, levels[ESKEL_LEVELS_MAX];
			uint32_t level_count;
			assert_int_equal(eskel_distance(s.signatures[1], s.signatures[neighbour->key / 10],
						 &options.distance, &distance, levels, &level_count),
				ESKEL_OK);
			assert_true(neighbour->distance == distance);
			assert_int_equal(neighbour->level_count, level_count);
			assert_memory_equal(neighbour->levels, levels, level_count * sizeof *levels);
		}
		eskel_search_result_free(result);
	}
	free_shelf(&s);
}

static void the_exact_search_compares_few_of_a_clustered_library(void **state)
{
	(void)state;
	shelf s = make_shelf(2000, 200, 0.1, 0);
	for (int o = 0; o < combinations; o++) {
		size_t compared = 0;
		for (uint64_t q = 0; q < 5; q++) {
			eskel_signature *query = synthetic_signature(q, 5000 + q, 0.1, 16);
			eskel_search_options options = {.distance = combination(o), .mode = ESKEL_SEARCH_EXACT};
			eskel_search_result *result = search(&s, query, &options);
			assert_int_equal(result->library, 2000);
			for (uint32_t step = 1; step < result->step_count; step++)
				assert_true(result->kept[step] <= result->kept[step - 1]);
			assert_true(result->compared <= result->kept[result->step_count - 1]);
			if (result->compared >= 500)
				fail_msg("options %d: %zu of 2000 compared", o, result->compared);
			compared += result->compared;
			eskel_search_result_free(result);
			eskel_signature_free(query);
		}
		print_message("options %2d: %.1f of 2000 compared\n", o, (double)compared / 5);
	}
	free_shelf(&s);
}

static void the_pruned_search_keeps_a_tenth_but_never_fewer_than_ten_or_the_limit(void **state)
{
	(void)state;
	shelf s = make_shelf(1234, 100, 0.2, 3);
	eskel_search_result *result = search(&s, s.signatures[7], &(eskel_search_options){.mode = ESKEL_SEARCH_PRUNED});
	assert_int_equal(result->library, 1234);
	assert_int_equal(result->step_count, 3);
	assert_int_equal(result->kept[0], 124);
	assert_int_equal(result->kept[1], 13);
	assert_int_equal(result->kept[2], 10);
	assert_int_equal(result->compared, 10);
	assert_int_equal(result->count, 5);
	assert_false(result->proven);
	eskel_search_result_free(result);
	result = search(&s, s.signatures[7], &(eskel_search_options){.mode = ESKEL_SEARCH_PRUNED, .limit = 40});
	assert_int_equal(result->step_count, 2);
	assert_int_equal(result->kept[0], 124);
	assert_int_equal(result->kept[1], 40);
	assert_int_equal(result->count, 40);
	eskel_search_result_free(result);
	free_shelf(&s);
}

/* The steps of section 5.3, by sorting. free() the pairs. */
static pair *prune_by_sorting(const shelf *s, const eskel_signature *query, const eskel_search_options *chosen)
{
	const eskel_distance_options *options = &chosen->distance;
	const size_t minimum = chosen->minimum ? chosen->minimum : 10, one_in = chosen->keep > 0 ? 4 : 10;
	pair *left = search_exhaustively(s, query, options);
	size_t count = s->count;
	for (uint32_t level = 1; count > minimum; level++) {
		eskel_distance_options step = *options;
		step.distance = ESKEL_DISTANCE_LEVEL;
		step.level = level;
		for (size_t n = 0; n < count; n++)
			assert_int_equal(eskel_distance(query, s->signatures[left[n].key / 10], &step,
						 &left[n].distance, NULL, NULL),
				ESKEL_OK);
		qsort(left, count, sizeof *left, by_distance_then_key);
		count = (count + one_in - 1) / one_in;
		count = count > minimum ? count : minimum;
	}
	for (size_t n = 0; n < count; n++)
		assert_int_equal(
			eskel_distance(query, s->signatures[left[n].key / 10], options, &left[n].distance, NULL, NULL),
			ESKEL_OK);
	qsort(left, count, sizeof *left, by_distance_then_key);
	return left;
}

static void assert_prunes_by_sorting(const shelf *s, const eskel_signature *query, int options)
{
	const eskel_search_options chosen = {.distance = combination(options), .mode = ESKEL_SEARCH_PRUNED};
	pair *expected = prune_by_sorting(s, query, &chosen);
	eskel_search_result *result = search(s, query, &chosen);
	assert_is_answer(result, expected, 5, options);
	eskel_search_result_free(result);
	free(expected);
}

static void the_pruned_search_keeps_what_it_is_asked_to(void **state)
{
	(void)state;
	shelf s = make_shelf(700, 70, 0.3, 3);
	for (int o = 0; o < combinations; o++)
		for (size_t minimum = 5; minimum <= 45; minimum += 20) {
			const eskel_search_options chosen = {.distance = combination(o),
				.mode = ESKEL_SEARCH_PRUNED,
				.keep = 0.25,
				.minimum = minimum};
			pair *expected = prune_by_sorting(&s, s.signatures[8], &chosen);
			eskel_search_result *result = search(&s, s.signatures[8], &chosen);
			assert_is_answer(result, expected, 5, o);
			assert_int_equal(result->kept[0], 175);
			assert_int_equal(result->kept[1], 44 > minimum ? 44 : minimum);
			eskel_search_result_free(result);
			free(expected);
		}
	eskel_search_result *result = NULL;
	const double refused[] = {-0.1, 1.1, NAN};
	for (size_t i = 0; i < 3; i++)
		assert_int_equal(
			eskel_library_search(s.library, s.signatures[0],
				&(eskel_search_options){.mode = ESKEL_SEARCH_PRUNED, .keep = refused[i]}, &result),
			ESKEL_INVALID);
	free_shelf(&s);
}

static void the_pruned_search_takes_the_steps_of_the_paper(void **state)
{
	(void)state;
	shelf s = make_shelf(700, 70, 0.3, 3);
	for (int o = 0; o < combinations; o++)
		assert_prunes_by_sorting(&s, s.signatures[8], o);
	free_shelf(&s);
}

/* The watched shapes that outlive a step are as many as it keeps, those that outlive all are the ones left by sorting. */
static void a_shape_can_be_watched_through_the_steps_of_the_pruned_search(void **state)
{
	(void)state;
	shelf s = make_shelf(150, 15, 0.3, 3);
	for (int o = 0; o < combinations; o++) {
		eskel_search_options options = {.distance = combination(o), .mode = ESKEL_SEARCH_PRUNED, .watch = true};
		pair *left = prune_by_sorting(&s, s.signatures[8], &options);
		size_t outlived[ESKEL_LEVELS_MAX] = {0}, kept[ESKEL_LEVELS_MAX] = {0};
		for (size_t n = 0; n < s.count; n++) {
			options.watched_key = key_of(n);
			eskel_search_result *result = search(&s, s.signatures[8], &options);
			bool is_left = false;
			for (size_t i = 0; i < 10; i++)
				is_left |= left[i].key == key_of(n);
			assert_true(is_left == (result->watched_steps == result->step_count));
			for (uint32_t step = 0; step < result->watched_steps; step++)
				outlived[step]++;
			memcpy(kept, result->kept, sizeof kept);
			eskel_search_result_free(result);
		}
		assert_int_equal(outlived[0], 15);
		assert_memory_equal(outlived, kept, sizeof kept);
		free(left);
	}
	free_shelf(&s);
}

/* Shapes come in batches of like ones, so that every second chunk has all that are near. */
static void the_pruned_search_does_not_depend_on_the_order_in_which_shapes_were_added(void **state)
{
	(void)state;
	enum { count = 9 * 512, batch = 512 };
	for (size_t near = 0; near < 2; near++) {
		shelf s = {.count = count, .signatures = calloc(count, sizeof *s.signatures)};
		assert_int_equal(eskel_library_new(&s.library), ESKEL_OK);
		for (size_t n = 0; n < count; n++) {
			const bool is_near = n / batch % 2 == near;
			s.signatures[n] = synthetic_signature(is_near ? 1 : 2 + n % 50, n, 0.3, 4);
			assert_int_equal(eskel_library_add(s.library, key_of(n), s.signatures[n]), ESKEL_OK);
		}
		eskel_signature *query = synthetic_signature(1, count, 0.3, 4);
		for (int o = 0; o < 4; o++)
			assert_prunes_by_sorting(&s, query, o);
		eskel_signature_free(query);
		free_shelf(&s);
	}
}

/* Longer than the codes of the columns can say; some in the library, and the query. */
static void shapes_beyond_the_codes_are_found_all_the_same(void **state)
{
	(void)state;
	enum { count = 400 };
	shelf s = {.count = count, .signatures = calloc(count, sizeof *s.signatures)};
	assert_int_equal(eskel_library_new(&s.library), ESKEL_OK);
	for (size_t n = 0; n < count; n++) {
		s.signatures[n] = synthetic_signature(n % 40, n, 0.2, n % 7 ? 16 : 3);
		for (size_t row = 0; n % 5 == 0 && row < ESKEL_NODES(s.signatures[n]->level_count); row++)
			s.signatures[n]->rows[row][n % 4] *= 1e7;
		assert_int_equal(eskel_library_add(s.library, key_of(n), s.signatures[n]), ESKEL_OK);
	}
	for (int o = 0; o < combinations; o++)
		for (size_t q = 10; q < 13; q++) {
			eskel_search_options options = {.distance = combination(o)};
			pair *expected = search_exhaustively(&s, s.signatures[q], &options.distance);
			eskel_search_result *result = search(&s, s.signatures[q], &options);
			assert_is_answer(result, expected, 5, o);
			eskel_search_result_free(result);
			free(expected);
			assert_prunes_by_sorting(&s, s.signatures[q], o);
		}
	free_shelf(&s);
}

static void the_pruned_search_of_ten_shapes_compares_them_all(void **state)
{
	(void)state;
	shelf s = make_shelf(10, 10, 0.2, 3);
	for (int o = 0; o < combinations; o++) {
		eskel_search_options options = {.distance = combination(o), .mode = ESKEL_SEARCH_PRUNED};
		pair *expected = search_exhaustively(&s, s.signatures[4], &options.distance);
		eskel_search_result *result = search(&s, s.signatures[4], &options);
		assert_is_answer(result, expected, 5, o);
		assert_int_equal(result->step_count, 0);
		assert_int_equal(result->compared, 10);
		assert_true(result->proven);
		eskel_search_result_free(result);
		free(expected);
	}
	free_shelf(&s);
}

static void the_pruned_search_finds_most_nearest_neighbours(void **state)
{
	(void)state;
	enum { queries = 100 };
	shelf s = make_shelf(2000, 200, 0.2, 0);
	int found = 0;
	for (uint64_t q = 0; q < queries; q++) {
		eskel_signature *query = synthetic_signature(q, 9000 + q, 0.2, 16);
		eskel_search_result *pruned = search(&s, query, &(eskel_search_options){.mode = ESKEL_SEARCH_PRUNED});
		eskel_search_result *exact = search(&s, query, NULL);
		found += pruned->neighbours[0].key == exact->neighbours[0].key;
		assert_true(pruned->neighbours[0].distance >= exact->neighbours[0].distance);
		eskel_search_result_free(pruned);
		eskel_search_result_free(exact);
		eskel_signature_free(query);
	}
	print_message("the nearest was found in %d of %d pruned searches\n", found, queries);
	assert_true(found >= queries / 2);
	free_shelf(&s);
}

static void equal_distances_are_ordered_by_key(void **state)
{
	(void)state;
	eskel_library *library = NULL;
	eskel_signature *twin = synthetic_signature(1, 1, 0.1, 16);
	assert_int_equal(eskel_library_new(&library), ESKEL_OK);
	for (int64_t n = 0; n < 600; n++)
		assert_int_equal(eskel_library_add(library, n * 7919 % 600 - 300, twin), ESKEL_OK);
	for (int mode = 0; mode < 2; mode++) {
		eskel_search_result *result = NULL;
		assert_int_equal(
			eskel_library_search(library, twin,
				&(eskel_search_options){.mode = (eskel_search_mode)mode, .limit = 20}, &result),
			ESKEL_OK);
		for (size_t n = 0; n < 20; n++) {
			assert_true(result->neighbours[n].distance == 0);
			assert_int_equal(result->neighbours[n].key, (int64_t)n - 300);
		}
		eskel_search_result_free(result);
	}
	eskel_library_free(library);
	eskel_signature_free(twin);
}

/* ---- scaled by neighbourhoods */

enum { whole = 110, part = 100, shortlist = 40 };

/* The mean distance to the nearest 8 of the library but for the key. */
static double neighbourhood(
	const shelf *s, const eskel_signature *signature, int64_t but, const eskel_distance_options *options)
{
	pair *pairs = search_exhaustively(s, signature, options);
	double sum = 0;
	int taken = 0;
	for (size_t n = 0; n < s->count && taken < 8; n++)
		if (pairs[n].key != but) {
			sum += pairs[n].distance;
			taken++;
		}
	free(pairs);
	return taken ? sum / taken : 1;
}

/* The shortlist in the order of scaled distances. free() the pairs. */
static pair *scale_exhaustively(const shelf *s, size_t query, const int64_t *keys, size_t key_count, size_t *count,
	const eskel_distance_options *options)
{
	const double mine = neighbourhood(s, s->signatures[query], key_of(query), options);
	pair *pairs = search_exhaustively(s, s->signatures[query], options);
	*count = 0;
	for (size_t n = 0; n < s->count && *count < shortlist; n++) {
		bool takes_part = pairs[n].key != key_of(query);
		if (takes_part && keys)
			takes_part = bsearch(&pairs[n].key, keys, key_count, sizeof *keys, by_key) != NULL;
		if (takes_part)
			pairs[(*count)++] = pairs[n];
	}
	for (size_t n = 0; n < *count; n++)
		pairs[n].distance /=
			sqrt(mine * neighbourhood(s, s->signatures[pairs[n].key / 10], pairs[n].key, options));
	qsort(pairs, *count, sizeof *pairs, by_distance_then_key);
	return pairs;
}

static void assert_scales(const shelf *s, size_t query, const int64_t *keys, size_t key_count, int o)
{
	eskel_key_block *blocks = calloc(key_count + 1, sizeof *blocks);
	size_t block_count = 0;
	for (size_t i = 0; i < key_count; i++)
		block_count = eskel_key_blocks_add(blocks, block_count, keys[i], 1);
	const eskel_search_options options = {.distance = combination(o),
		.scale = ESKEL_SCALE_NEIGHBOURHOOD,
		.keys = keys ? blocks : NULL,
		.key_block_count = block_count,
		.leave_out = true,
		.left_out_key = key_of(query)};
	size_t count;
	pair *expected = scale_exhaustively(s, query, keys, key_count, &count, &options.distance);
	eskel_search_result *result = search(s, s->signatures[query], &options);
	assert_int_equal(result->count, count < 5 ? count : 5);
	for (size_t n = 0; n < result->count; n++) {
		const eskel_neighbour *found = &result->neighbours[n];
		double distance;
		eskel_distance(
			s->signatures[query], s->signatures[found->key / 10], &options.distance, &distance, NULL, NULL);
		assert_true(found->distance == distance);
		if (found->key != expected[n].key || fabs(found->scaled - expected[n].distance) > 1e-12 * found->scaled)
			fail_msg("options %d, neighbour %zu: key %lld at %.17g, expected %lld at %.17g", o, n,
				(long long)found->key, found->scaled, (long long)expected[n].key, expected[n].distance);
	}
	assert_int_equal(result->proven, result->library <= shortlist);
	eskel_search_result_free(result);
	free(expected);
	free(blocks);
}

static void scaled_distances_order_the_shortlist_by_neighbourhoods_in_the_whole_library(void **state)
{
	(void)state;
	shelf s = make_shelf(whole, 30, 0.3, 3);
	int64_t few[20];
	for (size_t n = 0; n < 20; n++)
		few[n] = key_of(3 * n + 1);
	for (int o = 0; o < combinations; o++) {
		assert_scales(&s, 6, NULL, 0, o);
		if (o % 5 == 0)
			assert_scales(&s, 7, few, 20, o);
	}
	free_shelf(&s);
}

/* Whatever was searched, added and removed before. */
static void scaled_distances_do_not_depend_on_history(void **state)
{
	(void)state;
	shelf s = make_shelf(whole, 30, 0.3, 3);
	s.count = part;
	for (size_t n = whole; n-- > part;) {
		assert_scales(&(shelf){s.library, s.signatures, n + 1}, n % part, NULL, 0, (int)n % 3);
		assert_int_equal(eskel_library_remove(s.library, key_of(n)), ESKEL_OK);
	}
	assert_scales(&s, 5, NULL, 0, 0);
	for (size_t n = part; n < part + 5; n++) {
		assert_int_equal(eskel_library_add(s.library, key_of(n), s.signatures[n]), ESKEL_OK);
		assert_scales(&(shelf){s.library, s.signatures, n + 1}, 5, NULL, 0, 0);
	}
	s.count = whole;
	free_shelf(&s);
}

static void a_shape_among_copies_and_one_by_itself_have_finite_scaled_distances(void **state)
{
	(void)state;
	shelf s = make_shelf(1, 1, 0, 0);
	eskel_search_options options = {.scale = ESKEL_SCALE_NEIGHBOURHOOD};
	eskel_search_result *result = search(&s, s.signatures[0], &options);
	assert_int_equal(result->count, 1);
	assert_true(result->neighbours[0].scaled == 0);
	eskel_search_result_free(result);
	for (int64_t key = 100; key < 120; key++)
		assert_int_equal(eskel_library_add(s.library, key, s.signatures[0]), ESKEL_OK);
	eskel_signature *other = synthetic_signature(2, 1, 0, 16);
	result = search(&s, other, &options);
	assert_int_equal(result->count, 5);
	assert_int_equal(result->neighbours[0].key, 3);
	assert_true(isfinite(result->neighbours[0].scaled) && result->neighbours[0].scaled > 0);
	eskel_search_result_free(result);
	eskel_signature_free(other);
	free_shelf(&s);
}

static void a_filter_and_a_left_out_key_decide_who_takes_part(void **state)
{
	(void)state;
	shelf s = make_shelf(900, 30, 0.2, 3);
	/* Every third shape, and keys that no shape has. */
	eskel_key_block keys[700];
	size_t blocks = eskel_key_blocks_add(keys, 0, -50, 1);
	for (size_t n = 0; n < s.count; n += 3)
		blocks = eskel_key_blocks_add(keys, blocks, key_of(n), 3);
	for (int mode = 0; mode < 2; mode++)
		for (int o = 0; o < combinations; o++) {
			eskel_search_options options = {.distance = combination(o),
				.mode = (eskel_search_mode)mode,
				.limit = 400,
				.keys = keys,
				.key_block_count = blocks,
				.leave_out = true,
				.left_out_key = key_of(6)};
			eskel_search_result *result = search(&s, s.signatures[6], &options);
			pair *expected = search_exhaustively(&s, s.signatures[6], &options.distance);
			size_t left = 0;
			for (size_t n = 0; n < s.count; n++)
				if (expected[n].key / 10 % 3 == 0 && expected[n].key != key_of(6))
					expected[left++] = expected[n];
			assert_int_equal(left, 299);
			assert_int_equal(result->library, 299);
			assert_is_answer(result, expected, 299, o);
			assert_true(result->proven);
			eskel_search_result_free(result);
			free(expected);
		}
	eskel_search_result *result =
		search(&s, s.signatures[0], &(eskel_search_options){.keys = keys, .key_block_count = 1});
	assert_int_equal(result->library, 0);
	assert_int_equal(result->count, 0);
	assert_true(result->proven);
	eskel_search_result_free(result);
	free_shelf(&s);
}

static void an_empty_library_gives_an_empty_proven_answer(void **state)
{
	(void)state;
	shelf s = make_shelf(0, 1, 0, 0);
	eskel_signature *query = synthetic_signature(1, 1, 0, 4);
	for (int mode = 0; mode < 2; mode++) {
		eskel_search_result *result =
			search(&s, query, &(eskel_search_options){.mode = (eskel_search_mode)mode});
		assert_int_equal(result->count, 0);
		assert_int_equal(result->library, 0);
		assert_true(result->proven);
		eskel_search_result_free(result);
	}
	eskel_signature_free(query);
	free_shelf(&s);
}

static void arguments_outside_their_range_are_refused(void **state)
{
	(void)state;
	shelf s = make_shelf(3, 1, 0.1, 0);
	eskel_search_result *result = NULL;
	assert_int_equal(eskel_library_search(s.library, s.signatures[0],
				 &(eskel_search_options){.mode = (eskel_search_mode)2}, &result),
		ESKEL_INVALID);
	assert_int_equal(eskel_library_search(
				 s.library, s.signatures[0], &(eskel_search_options){.scale = (eskel_scale)2}, &result),
		ESKEL_INVALID);
	assert_int_equal(eskel_library_search(
				 s.library, s.signatures[0], &(eskel_search_options){.distance.level = 65}, &result),
		ESKEL_INVALID);
	s.signatures[0]->rows[0][0] = -1;
	assert_int_equal(eskel_library_search(s.library, s.signatures[0], NULL, &result), ESKEL_INVALID);
	assert_int_equal(eskel_library_add(s.library, 1000, s.signatures[0]), ESKEL_INVALID);
	assert_null(result);
	assert_int_equal(eskel_library_count(s.library), 3);
	eskel_library_free(NULL);
	eskel_search_result_free(NULL);
	free_shelf(&s);
}

static void tables_hold_the_distances_of_their_pairs(void **state)
{
	(void)state;
	enum { rows = 40, columns = 25 };
	static double square[rows * rows], again[rows * rows], oblong[rows * columns];
	shelf s = make_shelf(300, 20, 0.3, 3);
	int64_t row_keys[rows], column_keys[columns];
	for (size_t n = 0; n < rows; n++)
		row_keys[n] = key_of((n * 131) % 300);
	for (size_t n = 0; n < columns; n++)
		column_keys[n] = key_of((n * 77 + 5) % 300);
	column_keys[3] = column_keys[2];
	for (int o = 0; o < combinations; o++) {
		eskel_distance_options options = combination(o);
		assert_int_equal(
			eskel_library_distances(s.library, row_keys, rows, row_keys, rows, &options, square), ESKEL_OK);
		assert_int_equal(
			eskel_library_distances(s.library, row_keys, rows, row_keys, rows, &options, again), ESKEL_OK);
		assert_memory_equal(square, again, sizeof square);
		assert_int_equal(
			eskel_library_distances(s.library, row_keys, rows, column_keys, columns, &options, oblong),
			ESKEL_OK);
		for (size_t r = 0; r < rows; r++) {
			double expected;
			for (size_t c = 0; c < rows; c++) {
				assert_true(square[r * rows + c] == square[c * rows + r]);
				eskel_distance(s.signatures[row_keys[r] / 10], s.signatures[row_keys[c] / 10], &options,
					&expected, NULL, NULL);
				assert_true(square[r * rows + c] == expected);
			}
			for (size_t c = 0; c < columns; c++) {
				eskel_distance(s.signatures[row_keys[r] / 10], s.signatures[column_keys[c] / 10],
					&options, &expected, NULL, NULL);
				assert_true(oblong[r * columns + c] == expected);
			}
		}
	}
	free_shelf(&s);
}

static void a_table_with_an_unknown_key_is_refused_untouched(void **state)
{
	(void)state;
	shelf s = make_shelf(5, 5, 0.1, 0);
	int64_t known[2] = {key_of(0), key_of(1)}, unknown[2] = {key_of(0), 1};
	double distances[4] = {-1, -1, -1, -1};
	assert_int_equal(eskel_library_distances(s.library, known, 2, unknown, 2, NULL, distances), ESKEL_NOT_FOUND);
	assert_int_equal(eskel_library_distances(s.library, unknown, 2, known, 2, NULL, distances), ESKEL_NOT_FOUND);
	assert_int_equal(eskel_library_distances(
				 s.library, known, 2, known, 2, &(eskel_distance_options){.level = 99}, distances),
		ESKEL_INVALID);
	for (int n = 0; n < 4; n++)
		assert_true(distances[n] == -1);
	free_shelf(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_exact_search_gives_the_answer_of_comparing_with_every_shape),
		cmocka_unit_test(the_exact_search_is_right_at_levels_beyond_those_of_the_sum),
		cmocka_unit_test(neighbours_come_with_their_levels),
		cmocka_unit_test(the_exact_search_compares_few_of_a_clustered_library),
		cmocka_unit_test(the_pruned_search_keeps_a_tenth_but_never_fewer_than_ten_or_the_limit),
		cmocka_unit_test(the_pruned_search_takes_the_steps_of_the_paper),
		cmocka_unit_test(the_pruned_search_keeps_what_it_is_asked_to),
		cmocka_unit_test(a_shape_can_be_watched_through_the_steps_of_the_pruned_search),
		cmocka_unit_test(the_pruned_search_does_not_depend_on_the_order_in_which_shapes_were_added),
		cmocka_unit_test(shapes_beyond_the_codes_are_found_all_the_same),
		cmocka_unit_test(the_pruned_search_of_ten_shapes_compares_them_all),
		cmocka_unit_test(the_pruned_search_finds_most_nearest_neighbours),
		cmocka_unit_test(equal_distances_are_ordered_by_key),
		cmocka_unit_test(scaled_distances_order_the_shortlist_by_neighbourhoods_in_the_whole_library),
		cmocka_unit_test(scaled_distances_do_not_depend_on_history),
		cmocka_unit_test(a_shape_among_copies_and_one_by_itself_have_finite_scaled_distances),
		cmocka_unit_test(a_filter_and_a_left_out_key_decide_who_takes_part),
		cmocka_unit_test(an_empty_library_gives_an_empty_proven_answer),
		cmocka_unit_test(arguments_outside_their_range_are_refused),
		cmocka_unit_test(tables_hold_the_distances_of_their_pairs),
		cmocka_unit_test(a_table_with_an_unknown_key_is_refused_untouched),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
