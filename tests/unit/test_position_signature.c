#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "skeletons.h"

#include <math.h>
#include <string.h>

enum { BLOBS = 20, SHAPES = 12 };

static void assert_near(double found, double expected, double tolerance)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%.17g, expected %.17g within %g", found, expected, tolerance);
}

static eskel_skeleton *scattered(uint64_t seed, uint32_t levels)
{
	skeletons_blob blobs[BLOBS];
	skeletons_scatter(seed, blobs, BLOBS);
	return skeletons_new(blobs, BLOBS, levels, 1);
}

static eskel_position_signature *signature_of(const eskel_skeleton *skeleton)
{
	eskel_position_signature *signature = NULL;
	assert_int_equal(eskel_position_signature_new(skeleton, &signature), ESKEL_OK);
	return signature;
}

static double distance(const eskel_skeleton *a, const eskel_skeleton *b, eskel_size size)
{
	eskel_position_signature *of_a = signature_of(a), *of_b = signature_of(b);
	const double found = eskel_position_distance(of_a, of_b, size);
	assert_true(found == eskel_position_distance(of_b, of_a, size));
	assert_true(eskel_position_distance(of_a, of_a, size) == 0);
	eskel_position_signature_free(of_a);
	eskel_position_signature_free(of_b);
	return found;
}

/* ---- what changes nothing */

static void turned_moved_and_mirrored_shapes_are_the_same(void **state)
{
	(void)state;
	static const double offset[3] = {-100, 20, 3};
	for (uint64_t seed = 1; seed <= SHAPES; seed++) {
		uint64_t random = seed;
		double map[3][3];
		skeletons_blob blobs[BLOBS];
		skeletons_scatter(seed, blobs, BLOBS);
		skeletons_rotation(&random, map);
		for (int c = 0; seed % 2 && c < 3; c++)
			map[0][c] = -map[0][c];
		eskel_skeleton *a = skeletons_new(blobs, BLOBS, 16, 1);
		skeletons_move((const double(*)[3])map, offset, blobs, BLOBS);
		eskel_skeleton *b = skeletons_new(blobs, BLOBS, 16, 1), *other = scattered(seed + 1, 16);
		assert_near(distance(a, b, ESKEL_SIZE_FIXED), 0, 1e-4);
		assert_true(distance(a, other, ESKEL_SIZE_FIXED) > 0.1);
		eskel_skeleton_free(a);
		eskel_skeleton_free(b);
		eskel_skeleton_free(other);
	}
}

static void size_counts_where_it_is_fixed(void **state)
{
	(void)state;
	static const double twice[3][3] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, offset[3] = {0};
	skeletons_blob blobs[BLOBS];
	skeletons_scatter(5, blobs, BLOBS);
	eskel_skeleton *a = skeletons_new(blobs, BLOBS, 16, 1);
	skeletons_move(twice, offset, blobs, BLOBS);
	eskel_skeleton *b = skeletons_new(blobs, BLOBS, 16, 8);
	assert_near(distance(a, b, ESKEL_SIZE_FREE), 0, 1e-4);
	assert_near(distance(a, b, ESKEL_SIZE_FIXED), 0.2 * log(8), 1e-4);
	eskel_skeleton_free(a);
	eskel_skeleton_free(b);
}

static void levels_that_one_lacks_or_above_16_are_left_out(void **state)
{
	(void)state;
	eskel_skeleton *deep = scattered(3, 20), *full = scattered(3, 16), *shallow = scattered(3, 4);
	eskel_skeleton *other = scattered(4, 20), *shallow_other = scattered(4, 4);
	assert_true(distance(deep, full, ESKEL_SIZE_FIXED) == 0);
	assert_true(distance(deep, other, ESKEL_SIZE_FIXED) == distance(full, other, ESKEL_SIZE_FIXED));
	assert_true(
		distance(deep, shallow_other, ESKEL_SIZE_FIXED) == distance(shallow, shallow_other, ESKEL_SIZE_FIXED));
	assert_true(distance(shallow, other, ESKEL_SIZE_FIXED) != distance(full, other, ESKEL_SIZE_FIXED));
	eskel_position_signature *signature = signature_of(deep);
	assert_in_range(eskel_position_signature_size(signature), 136 * 7 * 4, 136 * 7 * 4 + 16);
	eskel_position_signature_free(signature);
	eskel_skeleton_free(deep);
	eskel_skeleton_free(full);
	eskel_skeleton_free(shallow);
	eskel_skeleton_free(other);
	eskel_skeleton_free(shallow_other);
}

/* ---- what it is */

static double solidity(const eskel_node *node, const eskel_skeleton *skeleton)
{
	const double root = sqrt(node->eigenvalues[0] * node->eigenvalues[1] * node->eigenvalues[2]);
	return fmin(skeleton->volume * node->weight / skeleton->weight / (4 * acos(-1) / 3 * pow(5, 1.5) * root), 1.25);
}

/* Straight from the definition. */
static void numbers_of(const eskel_skeleton *skeleton, uint32_t level, uint32_t class_index, double numbers[7])
{
	const eskel_node *whole = skeleton->nodes, *node = eskel_skeleton_node(skeleton, level, class_index);
	for (int i = 0; i < 3; i++) {
		double along = 0;
		for (int n = 0; n < 3; n++)
			along += (node->centre[n] - whole->centre[n]) * whole->axes[i][n];
		numbers[i] = log(sqrt(node->eigenvalues[i]) / cbrt(skeleton->volume) + 0.02);
		numbers[3 + i] = log(fabs(along) / cbrt(skeleton->volume) + 0.02);
	}
	numbers[6] = log(solidity(node, skeleton) + 0.02);
}

static double pair_cost(const eskel_skeleton *a, uint32_t i, const eskel_skeleton *b, uint32_t j, uint32_t level)
{
	double p[7], q[7], cost = 0;
	numbers_of(a, level, i, p);
	numbers_of(b, level, j, q);
	for (int n = 0; n < 7; n++)
		cost += fabs(p[n] - q[n]);
	return cost;
}

/* The least over all ways to give class i and those after it the classes that are not taken. */
static double least_cost(const eskel_skeleton *a, const eskel_skeleton *b, uint32_t level, uint32_t i, uint32_t taken)
{
	double least = i == level ? 0 : INFINITY;
	for (uint32_t j = 0; j < level && i < level; j++)
		if (!(taken >> j & 1))
			least = fmin(least, pair_cost(a, i, b, j, level) +
						    least_cost(a, b, level, i + 1, taken | UINT32_C(1) << j));
	return least;
}

static void distances_are_those_of_every_bijection_tried(void **state)
{
	(void)state;
	enum { LEVELS = 6 };
	for (uint64_t seed = 1; seed <= SHAPES; seed++) {
		eskel_skeleton *a = scattered(seed, LEVELS), *b = scattered(seed + 100, LEVELS);
		double sum = 0;
		b->volume *= 3;
		for (uint32_t k = 1; k <= LEVELS; k++)
			sum += least_cost(a, b, k, 0, 0) / k;
		assert_near(distance(a, b, ESKEL_SIZE_FREE), sum / LEVELS, 1e-5);
		assert_near(
			distance(a, b, ESKEL_SIZE_FIXED), sum / LEVELS + 0.2 * fabs(log(b->volume / a->volume)), 1e-5);
		eskel_skeleton_free(a);
		eskel_skeleton_free(b);
	}
}

/* Two equal ellipsoids side by side along x; both lie at |x| = half the gap and |y| = |z| = 0, and are matched at no cost but
 * that of the gap, at level 1 that of the longer whole. */
static void a_gap_between_two_ellipsoids_is_told_in_closed_form(void **state)
{
	(void)state;
	static const double half_gaps[2] = {10, 14}, variances[3] = {20, 8, 5}, weight = 2000;
	const double size = cbrt(2 * weight);
	eskel_skeleton *skeletons[2];
	double whole[2], solid[2], at[2];
	for (int s = 0; s < 2; s++) {
		skeletons_blob blobs[2] = {{.weight = weight, .centre = {half_gaps[s], 0, 0}},
			{.weight = weight, .centre = {-half_gaps[s], 0, 0}}};
		for (int b = 0; b < 2; b++)
			for (int i = 0; i < 3; i++)
				blobs[b].covariance[i][i] = variances[i];
		skeletons[s] = skeletons_new(blobs, 2, 2, 1);
		const double longest = variances[0] + half_gaps[s] * half_gaps[s];
		const double root = sqrt(longest * variances[1] * variances[2]);
		whole[s] = log(sqrt(longest) / size + 0.02);
		solid[s] = log(fmin(2 * weight / (4 * acos(-1) / 3 * pow(5, 1.5) * root), 1.25) + 0.02);
		at[s] = log(half_gaps[s] / size + 0.02);
	}
	const double first = fabs(whole[0] - whole[1]) + fabs(solid[0] - solid[1]), second = fabs(at[0] - at[1]);
	assert_near(distance(skeletons[0], skeletons[1], ESKEL_SIZE_FIXED), (first + second) / 2, 1e-5);
	eskel_skeleton_free(skeletons[0]);
	eskel_skeleton_free(skeletons[1]);
}

/* A small ball beside a large ellipsoid, along its longest or its middle axis: as far from its centre, so that the log
 * signature hardly tells the two apart. */
static void the_direction_of_a_class_counts(void **state)
{
	(void)state;
	eskel_skeleton *skeletons[2];
	eskel_signature *signatures[2] = {NULL, NULL};
	double by_rho;
	for (int axis = 0; axis < 2; axis++) {
		skeletons_blob blobs[2] = {{.weight = 10000}, {.weight = 10}};
		for (int i = 0; i < 3; i++) {
			blobs[0].covariance[i][i] = 120 - 50 * i;
			blobs[1].covariance[i][i] = 1;
		}
		blobs[1].centre[axis] = 25;
		skeletons[axis] = skeletons_new(blobs, 2, 2, 1);
		assert_int_equal(eskel_signature_new(skeletons[axis], &signatures[axis]), ESKEL_OK);
	}
	assert_int_equal(eskel_distance(signatures[0], signatures[1], NULL, &by_rho, NULL, NULL), ESKEL_OK);
	assert_true(by_rho < 0.05);
	assert_true(distance(skeletons[0], skeletons[1], ESKEL_SIZE_FIXED) > 1);
	for (int i = 0; i < 2; i++) {
		eskel_signature_free(signatures[i]);
		eskel_skeleton_free(skeletons[i]);
	}
}

static void a_skeleton_without_a_volume_is_refused(void **state)
{
	(void)state;
	eskel_position_signature *none = NULL;
	eskel_skeleton *skeleton = scattered(1, 3);
	skeleton->volume = 0;
	assert_int_equal(eskel_position_signature_new(skeleton, &none), ESKEL_INVALID);
	assert_null(none);
	eskel_position_signature_free(none);
	eskel_skeleton_free(skeleton);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(turned_moved_and_mirrored_shapes_are_the_same),
		cmocka_unit_test(size_counts_where_it_is_fixed),
		cmocka_unit_test(levels_that_one_lacks_or_above_16_are_left_out),
		cmocka_unit_test(distances_are_those_of_every_bijection_tried),
		cmocka_unit_test(a_gap_between_two_ellipsoids_is_told_in_closed_form),
		cmocka_unit_test(the_direction_of_a_class_counts),
		cmocka_unit_test(a_skeleton_without_a_volume_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
