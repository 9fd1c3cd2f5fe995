#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "synthetic.h"

#include <math.h>
#include <string.h>

static void assert_near(double found, double expected, double tolerance)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%.17g, expected %.17g within %g", found, expected, tolerance);
}

/* Every combination of options, by number. */
enum { combinations = 24 };
static eskel_distance_options combination(int n)
{
	return (eskel_distance_options){.signature = n & 1 ? ESKEL_SIGNATURE_PAPER : ESKEL_SIGNATURE_LOG,
		.distance = n & 2 ? ESKEL_DISTANCE_LEVEL : ESKEL_DISTANCE_SUM,
		.level = 4,
		.size = n & 4 ? ESKEL_SIZE_FREE : ESKEL_SIZE_FIXED,
		.metric = (eskel_metric)(n / 8)};
}

/* ---- the definition in eskel_skeleton.h, read literally: doubles, the C library's logarithm, all permutations */

static double number(const eskel_signature *s, const eskel_distance_options *o, size_t row, int i)
{
	double unit = i < 4 ? cbrt(s->volume) : 1;
	if (o->signature == ESKEL_SIGNATURE_LOG)
		return log(s->rows[row][i] / unit + 0.02);
	return o->size == ESKEL_SIZE_FREE ? s->rows[row][i] / unit : s->rows[row][i];
}

static double class_cost(
	const eskel_signature *a, size_t i, const eskel_signature *b, size_t j, const eskel_distance_options *o)
{
	double cost = 0;
	for (int n = 0; n < (o->signature == ESKEL_SIGNATURE_LOG ? 5 : 4); n++) {
		double d = number(a, o, i, n) - number(b, o, j, n);
		cost += o->metric == ESKEL_METRIC_EUCLIDEAN ? d * d
			: o->metric == ESKEL_METRIC_ROOT    ? sqrt(fabs(d))
							    : fabs(d);
	}
	return o->metric == ESKEL_METRIC_EUCLIDEAN ? sqrt(cost) : cost;
}

static double least_matching(const eskel_signature *a, const eskel_signature *b, const eskel_distance_options *o,
	uint32_t k, uint32_t i, unsigned taken)
{
	if (i == k)
		return 0;
	double least = INFINITY;
	for (uint32_t j = 0; j < k; j++)
		if (!(taken >> j & 1))
			least = fmin(least, class_cost(a, ESKEL_NODES(k - 1) + i, b, ESKEL_NODES(k - 1) + j, o) +
						    least_matching(a, b, o, k, i + 1, taken | 1u << j));
	return least;
}

static double literal_level(
	const eskel_signature *a, const eskel_signature *b, const eskel_distance_options *o, uint32_t k)
{
	double cost = least_matching(a, b, o, k, 0, 0);
	return o->signature == ESKEL_SIGNATURE_LOG ? cost / k : cost;
}

static double literal_distance(
	const eskel_signature *a, const eskel_signature *b, const eskel_distance_options *o, uint32_t depth)
{
	double distance = 0;
	if (o->distance == ESKEL_DISTANCE_LEVEL)
		distance = literal_level(a, b, o, depth);
	else if (o->signature == ESKEL_SIGNATURE_LOG)
		for (uint32_t k = 1; k <= depth; k++)
			distance += literal_level(a, b, o, k) / depth;
	else
		for (uint32_t k = 1; k <= depth; k++)
			distance += literal_level(a, b, o, k) / k;
	if (o->signature == ESKEL_SIGNATURE_LOG && o->size == ESKEL_SIZE_FIXED)
		distance += o->metric == ESKEL_METRIC_ROOT ? 0.15 * sqrt(fabs(log(a->volume) - log(b->volume)))
							   : 0.2 * fabs(log(a->volume) - log(b->volume));
	return distance;
}

static void distances_are_what_their_definition_says(void **state)
{
	(void)state;
	for (uint64_t n = 0; n < 12; n++) {
		eskel_signature *a = synthetic_signature(n, 1, 0.2, 6),
				*b = synthetic_signature(n / 2 + 100, 2, 0.2, 7);
		for (int c = 0; c < combinations; c++) {
			eskel_distance_options o = combination(c);
			double distance, levels[ESKEL_LEVELS_MAX];
			uint32_t depth;
			assert_int_equal(eskel_distance(a, b, &o, &distance, levels, &depth), ESKEL_OK);
			assert_int_equal(depth, o.distance == ESKEL_DISTANCE_LEVEL ? 4 : 6);
			double expected = literal_distance(a, b, &o, depth);
			assert_near(distance, expected, 3e-6 * expected + 2e-6);
			for (uint32_t k = 1; k <= depth; k++) {
				expected = literal_level(a, b, &o, k);
				assert_near(levels[k - 1], expected, 3e-6 * expected + 2e-6);
			}
		}
		eskel_signature_free(a);
		eskel_signature_free(b);
	}
}

static void a_distance_is_symmetric_to_the_last_bit(void **state)
{
	(void)state;
	for (uint64_t n = 0; n < 60; n++) {
		eskel_signature *a = synthetic_signature(n % 7, n, 0.3, 16),
				*b = synthetic_signature(n % 5, n + 1, 0.3, 18);
		for (int c = 0; c < combinations; c++) {
			eskel_distance_options o = combination(c);
			o.level = 16;
			double there, back, levels_there[ESKEL_LEVELS_MAX], levels_back[ESKEL_LEVELS_MAX];
			assert_int_equal(eskel_distance(a, b, &o, &there, levels_there, NULL), ESKEL_OK);
			assert_int_equal(eskel_distance(b, a, &o, &back, levels_back, NULL), ESKEL_OK);
			if (there != back)
				fail_msg("pair %d, options %d: %.17g and %.17g", (int)n, c, there, back);
			assert_memory_equal(levels_there, levels_back, 16 * sizeof(double));
		}
		eskel_signature_free(a);
		eskel_signature_free(b);
	}
}

static void a_shape_is_at_distance_zero_from_itself_only(void **state)
{
	(void)state;
	eskel_signature *a = synthetic_signature(3, 1, 0.1, 20), *b = synthetic_signature(3, 2, 0.1, 20);
	for (int c = 0; c < combinations; c++) {
		eskel_distance_options o = combination(c);
		double distance;
		assert_int_equal(eskel_distance(a, a, &o, &distance, NULL, NULL), ESKEL_OK);
		assert_near(distance, 0, 0);
		assert_int_equal(eskel_distance(a, b, &o, &distance, NULL, NULL), ESKEL_OK);
		assert_true(distance > 0);
	}
	eskel_signature_free(a);
	eskel_signature_free(b);
}

static void distances_obey_the_triangle_inequality(void **state)
{
	(void)state;
	enum { shapes = 8 };
	eskel_signature *s[shapes];
	double d[shapes][shapes];
	for (uint64_t n = 0; n < shapes; n++)
		s[n] = synthetic_signature(n / 2, n, 0.3, 12);
	for (int c = 0; c < combinations; c++) {
		eskel_distance_options o = combination(c);
		for (int i = 0; i < shapes; i++)
			for (int j = 0; j < shapes; j++)
				assert_int_equal(eskel_distance(s[i], s[j], &o, &d[i][j], NULL, NULL), ESKEL_OK);
		for (int i = 0; i < shapes; i++)
			for (int j = 0; j < shapes; j++)
				for (int k = 0; k < shapes; k++)
					if (d[i][j] > (d[i][k] + d[k][j]) * (1 + 1e-6))
						fail_msg("options %d: %g > %g + %g", c, d[i][j], d[i][k], d[k][j]);
	}
	for (int n = 0; n < shapes; n++)
		eskel_signature_free(s[n]);
}

static void a_scaled_shape_differs_in_size_alone(void **state)
{
	(void)state;
	const double scale = 1.7;
	eskel_signature *a = synthetic_signature(9, 1, 0, 16), *b = synthetic_signature(9, 1, 0, 16);
	b->volume *= scale * scale * scale;
	for (size_t n = 0; n < ESKEL_NODES(16); n++)
		for (int i = 0; i < 4; i++)
			b->rows[n][i] *= scale;
	double distance;
	for (int c = 0; c < combinations; c++) {
		eskel_distance_options o = combination(c);
		o.size = ESKEL_SIZE_FREE;
		assert_int_equal(eskel_distance(a, b, &o, &distance, NULL, NULL), ESKEL_OK);
		/* Roots of rounding errors are not so small. */
		assert_near(distance, 0, o.metric == ESKEL_METRIC_ROOT ? 2e-2 : 2e-5);
	}
	assert_int_equal(eskel_distance(a, b, NULL, &distance, NULL, NULL), ESKEL_OK);
	assert_near(distance, 0.2 * 3 * log(scale), 2e-5);
	eskel_distance_options root = {.metric = ESKEL_METRIC_ROOT};
	assert_int_equal(eskel_distance(a, b, &root, &distance, NULL, NULL), ESKEL_OK);
	assert_near(distance, 0.15 * sqrt(3 * log(scale)), 2e-3);
	/* In mm every number differs by the factor. */
	eskel_distance_options paper = {
		.signature = ESKEL_SIGNATURE_PAPER, .distance = ESKEL_DISTANCE_LEVEL, .level = 1};
	assert_int_equal(eskel_distance(a, b, &paper, &distance, NULL, NULL), ESKEL_OK);
	double sum = a->rows[0][0] + a->rows[0][1] + a->rows[0][2];
	assert_near(distance, (scale - 1) * sum, 1e-5 * sum);
	eskel_signature_free(a);
	eskel_signature_free(b);
}

static void a_level_that_one_lacks_gives_way_to_the_deepest_common_one(void **state)
{
	(void)state;
	eskel_signature *a = synthetic_signature(1, 1, 0.1, 6), *b = synthetic_signature(2, 1, 0.1, 40);
	eskel_distance_options deep = {.distance = ESKEL_DISTANCE_LEVEL, .level = 30}, six = deep;
	six.level = 6;
	double lowered, expected;
	uint32_t depth;
	assert_int_equal(eskel_distance(a, b, &deep, &lowered, NULL, &depth), ESKEL_OK);
	assert_int_equal(eskel_distance(a, b, &six, &expected, NULL, NULL), ESKEL_OK);
	assert_int_equal(depth, 6);
	assert_true(lowered == expected);
	/* The default level is 10, and a sum stops at 16. */
	assert_int_equal(eskel_distance(b, b, &(eskel_distance_options){.distance = ESKEL_DISTANCE_LEVEL}, &expected,
				 NULL, &depth),
		ESKEL_OK);
	assert_int_equal(depth, 10);
	assert_int_equal(eskel_distance(b, b, NULL, &expected, NULL, &depth), ESKEL_OK);
	assert_int_equal(depth, 16);
	eskel_signature_free(a);
	eskel_signature_free(b);
}

static void one_voxel_and_flat_shapes_have_finite_distances(void **state)
{
	(void)state;
	double voxel_rows[1][ESKEL_SIGNATURE_NUMBERS] = {{0, 0, 0, 0, 1.25}};
	double plane_rows[3][ESKEL_SIGNATURE_NUMBERS] = {
		{30, 20, 0, 0, 1.25}, {15, 12, 0, 14, 1.25}, {15, 12, 0, 15, 1.25}};
	eskel_signature voxel = {.level_count = 1, .volume = 1e-15, .rows = voxel_rows};
	eskel_signature plane = {.level_count = 2, .volume = 8e21, .rows = plane_rows};
	for (int c = 0; c < combinations; c++) {
		eskel_distance_options o = combination(c);
		double distance;
		assert_int_equal(eskel_distance(&voxel, &plane, &o, &distance, NULL, NULL), ESKEL_OK);
		if (!(isfinite(distance) && distance > 0))
			fail_msg("options %d: %g", c, distance);
		assert_int_equal(eskel_distance(&voxel, &voxel, &o, &distance, NULL, NULL), ESKEL_OK);
		assert_near(distance, 0, 0);
	}
}

static void a_match_is_a_bijection_at_the_cost_of_its_level(void **state)
{
	(void)state;
	eskel_signature *a = synthetic_signature(4, 1, 0.3, 16), *b = synthetic_signature(5, 2, 0.3, 16);
	for (int c = 0; c < combinations; c++) {
		eskel_distance_options o = combination(c);
		double distance, levels[ESKEL_LEVELS_MAX];
		o.level = 16;
		assert_int_equal(eskel_distance(a, b, &o, &distance, levels, NULL), ESKEL_OK);
		for (uint32_t k = 1; k <= 16; k++) {
			eskel_match there, back;
			assert_int_equal(eskel_match_level(a, b, &o, k, &there), ESKEL_OK);
			assert_int_equal(eskel_match_level(b, a, &o, k, &back), ESKEL_OK);
			assert_int_equal(there.level, k);
			assert_true(there.cost == back.cost);
			assert_near(levels[k - 1] * (o.signature == ESKEL_SIGNATURE_LOG ? k : 1), there.cost, 1e-12);
			double sum = 0;
			for (uint32_t i = 0; i < k; i++) {
				uint32_t j = there.other[i];
				assert_true(j < k);
				assert_int_equal(back.other[j], i);
				assert_true(there.pair_cost[i] == back.pair_cost[j]);
				double expected = class_cost(a, ESKEL_NODES(k - 1) + i, b, ESKEL_NODES(k - 1) + j, &o);
				assert_near(there.pair_cost[i], expected,
					3e-6 * expected + (o.metric == ESKEL_METRIC_ROOT ? 1e-4 : 2e-6));
				sum += there.pair_cost[i];
			}
			assert_near(sum, there.cost, 1e-12 * sum);
		}
	}
	eskel_signature_free(a);
	eskel_signature_free(b);
}

static void arguments_outside_their_range_are_refused_and_outputs_untouched(void **state)
{
	(void)state;
	eskel_signature *a = synthetic_signature(1, 1, 0.1, 5), *b = synthetic_signature(1, 2, 0.1, 4);
	const eskel_distance_options bad[] = {{.signature = (eskel_signature_kind)2},
		{.distance = (eskel_distance_kind)2}, {.metric = (eskel_metric)3}, {.size = (eskel_size)2},
		{.level = 65}};
	double distance = -1;
	eskel_match match = {.level = 77};
	for (size_t n = 0; n < sizeof bad / sizeof *bad; n++) {
		assert_int_equal(eskel_distance(a, b, &bad[n], &distance, NULL, NULL), ESKEL_INVALID);
		assert_int_equal(eskel_match_level(a, b, &bad[n], 1, &match), ESKEL_INVALID);
	}
	assert_int_equal(eskel_match_level(a, b, NULL, 0, &match), ESKEL_INVALID);
	assert_int_equal(eskel_match_level(a, b, NULL, 5, &match), ESKEL_INVALID);
	a->rows[7][2] = NAN;
	assert_int_equal(eskel_distance(a, b, NULL, &distance, NULL, NULL), ESKEL_INVALID);
	a->rows[7][2] = 1;
	a->volume = 0;
	assert_int_equal(eskel_distance(b, a, NULL, &distance, NULL, NULL), ESKEL_INVALID);
	assert_true(distance == -1);
	assert_int_equal(match.level, 77);
	eskel_signature_free(a);
	eskel_signature_free(b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(distances_are_what_their_definition_says),
		cmocka_unit_test(a_distance_is_symmetric_to_the_last_bit),
		cmocka_unit_test(a_shape_is_at_distance_zero_from_itself_only),
		cmocka_unit_test(distances_obey_the_triangle_inequality),
		cmocka_unit_test(a_scaled_shape_differs_in_size_alone),
		cmocka_unit_test(a_level_that_one_lacks_gives_way_to_the_deepest_common_one),
		cmocka_unit_test(one_voxel_and_flat_shapes_have_finite_distances),
		cmocka_unit_test(a_match_is_a_bijection_at_the_cost_of_its_level),
		cmocka_unit_test(arguments_outside_their_range_are_refused_and_outputs_untouched),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
