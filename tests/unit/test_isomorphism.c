#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "shapes.h"
#include "skeletons.h"
#include "synthetic.h"

#include <math.h>
#include <string.h>

enum { pairs = 60, levels = 6, most_levels = 16 };

/* A tree of random classes with these splits. */
static eskel_skeleton *tree_of(uint64_t seed, uint32_t level_count, const int32_t *splits)
{
	skeletons_blob blobs[most_levels];
	skeletons_scatter(seed, blobs, most_levels);
	eskel_skeleton *tree = skeletons_new(blobs, most_levels, level_count, 1);
	for (uint32_t k = 1; k < level_count; k++)
		tree->levels[k].split_class = splits[k];
	return tree;
}

static void random_splits(uint64_t *random, int32_t splits[levels])
{
	for (int32_t k = 1; k < levels; k++)
		splits[k] = (int32_t)(synthetic_random(random) % (uint64_t)k);
}

static void swap(uint8_t *a, uint8_t *b)
{
	uint8_t kept = *a;
	*a = *b;
	*b = kept;
}

/* The next of all orders of k classes, lexicographic. */
static bool next_order(uint8_t *order, int k)
{
	int i = k - 2, j = k - 1;
	while (i >= 0 && order[i] >= order[i + 1])
		i--;
	if (i < 0)
		return false;
	while (order[j] <= order[i])
		j--;
	swap(&order[i], &order[j]);
	for (i++, j = k - 1; i < j; i++, j--)
		swap(&order[i], &order[j]);
	return true;
}

/* The class of level k that class c of level k + 1 comes from. */
static uint8_t parent(const eskel_skeleton *tree, uint32_t k, uint8_t c)
{
	return c == k ? (uint8_t)tree->levels[k].split_class : c;
}

static double cost(const eskel_signature *a, const eskel_signature *b, uint32_t k, const uint8_t *order)
{
	double sum = 0;
	for (uint32_t c = 0; c < k; c++)
		for (int n = 0; n < ESKEL_SIGNATURE_NUMBERS; n++) {
			double unit_a = n < 4 ? cbrt(a->volume) : 1, unit_b = n < 4 ? cbrt(b->volume) : 1;
			sum += fabs(log(a->rows[ESKEL_NODES(k - 1) + c][n] / unit_a + 0.02) -
				    log(b->rows[ESKEL_NODES(k - 1) + order[c]][n] / unit_b + 0.02));
		}
	return sum;
}

static bool respects_parents(
	const eskel_skeleton *a, const eskel_skeleton *b, uint32_t k, const uint8_t *above, const uint8_t *order)
{
	for (uint8_t c = 0; c <= k; c++)
		if (parent(b, k, order[c]) != above[parent(a, k, c)])
			return false;
	return true;
}

/* Of all bijections of level k + 1 the one of least cost that sends children of matched classes to one another. */
static bool best_order(const eskel_skeleton *const trees[2], eskel_signature *const signatures[2], uint32_t k,
	const uint8_t *above, uint8_t *best)
{
	uint8_t order[levels];
	double least = INFINITY;
	for (uint8_t c = 0; c <= k; c++)
		order[c] = c;
	do {
		if (!respects_parents(trees[0], trees[1], k, above, order))
			continue;
		double found = cost(signatures[0], signatures[1], k + 1, order);
		if (found < least)
			memcpy(best, order, k + 1);
		least = fmin(least, found);
	} while (next_order(order, (int)k + 1));
	return least < INFINITY;
}

static void the_bijection_is_the_best_of_all_that_respect_parents(void **state)
{
	(void)state;
	uint64_t random = 1;
	uint32_t deep = 0;
	for (uint64_t seed = 0; seed < pairs; seed++) {
		int32_t splits[2][levels];
		random_splits(&random, splits[0]);
		random_splits(&random, splits[1]);
		if (seed % 3) /* alike down to some level, or all the way */
			memcpy(splits[1], splits[0], (1 + seed % levels) * sizeof splits[0][0]);
		eskel_skeleton *trees[2] = {
			tree_of(2 * seed, levels, splits[0]), tree_of(2 * seed + 1, levels, splits[1])};
		eskel_signature *signatures[2];
		eskel_isomorphism found;
		for (int t = 0; t < 2; t++)
			assert_int_equal(eskel_signature_new(trees[t], &signatures[t]), ESKEL_OK);
		assert_int_equal(eskel_isomorphism_find(trees[0], trees[1], NULL, &found), ESKEL_OK);
		uint8_t above[levels] = {0}, best[levels] = {0};
		uint32_t k = 1;
		while (k < levels && best_order((const eskel_skeleton *const *)trees, signatures, k, above, best)) {
			memcpy(above, best, ++k);
			assert_memory_equal(&found.other[ESKEL_NODES(k - 1)], best, k);
		}
		assert_int_equal(found.depth, k);
		assert_int_equal(found.complete, k == levels);
		deep += k > 3;
		for (int t = 0; t < 2; t++) {
			assert_int_equal(found.split_class[t], k == levels ? -1 : trees[t]->levels[k].split_class);
			eskel_signature_free(signatures[t]);
			eskel_skeleton_free(trees[t]);
		}
	}
	assert_in_range(deep, pairs / 4, pairs - 1);
}

static void swapping_the_trees_inverts_the_bijection(void **state)
{
	(void)state;
	uint64_t random = 2;
	static const eskel_distance_options paper = {
		.signature = ESKEL_SIGNATURE_PAPER, .metric = ESKEL_METRIC_EUCLIDEAN};
	for (uint64_t seed = 0; seed < pairs; seed++) {
		int32_t splits[levels];
		eskel_isomorphism there, back;
		random_splits(&random, splits);
		eskel_skeleton *a = tree_of(seed, levels, splits), *b = tree_of(seed + pairs, levels, splits);
		const eskel_distance_options *options = seed % 2 ? &paper : NULL;
		assert_int_equal(eskel_isomorphism_find(a, b, options, &there), ESKEL_OK);
		assert_int_equal(eskel_isomorphism_find(b, a, options, &back), ESKEL_OK);
		assert_int_equal(there.depth, back.depth);
		for (uint32_t k = 1; k <= there.depth; k++)
			for (uint32_t c = 0; c < k; c++)
				assert_int_equal(
					back.other[ESKEL_NODES(k - 1) + there.other[ESKEL_NODES(k - 1) + c]], c);
		eskel_skeleton_free(a);
		eskel_skeleton_free(b);
	}
}

static void assert_identity(const eskel_skeleton *a, const eskel_skeleton *b)
{
	eskel_isomorphism found;
	assert_int_equal(eskel_isomorphism_find(a, b, NULL, &found), ESKEL_OK);
	assert_int_equal(found.depth, a->level_count);
	assert_true(found.complete);
	for (uint32_t k = 1; k <= found.depth; k++)
		for (uint32_t c = 0; c < k; c++)
			assert_int_equal(found.other[ESKEL_NODES(k - 1) + c], c);
}

/* The same voxels under other affines: turned, mirrored, shifted. */
static void a_shape_and_its_turned_and_mirrored_copies_have_full_depth(void **state)
{
	(void)state;
	static const eskel_affine affines[] = {
		{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
		{{{0, 0, 1, 40}, {1, 0, 0, -7}, {0, 1, 0, 300}}},
		{{{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
		{{{0.6, 0.8, 0, 1}, {0.8, -0.6, 0, 2}, {0, 0, 1, 3}}},
		{{{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}}},
	};
	shapes_solid solid = shapes_hamate;
	solid.scale *= 0.3;
	eskel_skeleton *first = NULL;
	for (size_t i = 0; i < sizeof affines / sizeof *affines; i++) {
		eskel_cloud *cloud = shapes_cloud(&solid, &affines[i]);
		eskel_skeleton *skeleton = NULL;
		assert_int_equal(eskel_skeleton_new(cloud, NULL, &skeleton, NULL), ESKEL_OK);
		if (!first)
			first = skeleton;
		assert_identity(first, skeleton);
		eskel_cloud_free(cloud);
		if (skeleton != first)
			eskel_skeleton_free(skeleton);
	}
	eskel_skeleton_free(first);
}

static void the_shorter_tree_ends_it(void **state)
{
	(void)state;
	static const int32_t splits[levels] = {-1, 0, 1, 0, 2, 1};
	eskel_isomorphism found;
	eskel_skeleton *a = tree_of(1, levels, splits), *b = tree_of(1, 4, splits), *one = tree_of(1, 1, splits);
	assert_int_equal(eskel_isomorphism_find(a, b, NULL, &found), ESKEL_OK);
	assert_int_equal(found.depth, 4);
	assert_true(found.complete);
	assert_int_equal(found.split_class[0], 2);
	assert_int_equal(found.split_class[1], -1);
	assert_int_equal(eskel_isomorphism_find(one, a, NULL, &found), ESKEL_OK);
	assert_int_equal(found.depth, 1);
	assert_true(found.complete);
	eskel_skeleton_free(a);
	eskel_skeleton_free(b);
	eskel_skeleton_free(one);
}

static void options_out_of_range_are_refused(void **state)
{
	(void)state;
	static const int32_t splits[levels] = {-1, 0, 0, 0, 0, 0};
	eskel_isomorphism found = {.depth = 77};
	eskel_skeleton *a = tree_of(1, levels, splits);
	assert_int_equal(eskel_isomorphism_find(a, a, &(eskel_distance_options){.metric = (eskel_metric)3}, &found),
		ESKEL_INVALID);
	assert_int_equal(found.depth, 77);
	eskel_skeleton_free(a);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_bijection_is_the_best_of_all_that_respect_parents),
		cmocka_unit_test(swapping_the_trees_inverts_the_bijection),
		cmocka_unit_test(a_shape_and_its_turned_and_mirrored_copies_have_full_depth),
		cmocka_unit_test(the_shorter_tree_ends_it),
		cmocka_unit_test(options_out_of_range_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
