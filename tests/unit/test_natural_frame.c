#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "natural_frame.h"
#include "skeletons.h"

#include <math.h>
#include <string.h>

enum { blob_count = 16, levels = 16 };

static eskel_skeleton *sample(uint64_t seed)
{
	skeletons_blob blobs[blob_count];
	skeletons_scatter(seed, blobs, blob_count);
	return skeletons_new(blobs, blob_count, levels, 0.5);
}

static double distance_between(const esk_placed_class *a, const esk_placed_class *b)
{
	double square = 0;
	for (int c = 0; c < ESK_PLACED_COORDINATES; c++)
		square += (a->at[c] - b->at[c]) * (a->at[c] - b->at[c]);
	return sqrt(square);
}

/* The square root of a covariance by Newton's iteration X <- (X + M X^-1) / 2, which knows of no eigenvectors. */
static void square_root(const double m[3][3], double x[3][3])
{
	memset(x, 0, 9 * sizeof x[0][0]);
	for (int i = 0; i < 3; i++)
		x[i][i] = m[0][0] + m[1][1] + m[2][2];
	for (int step = 0; step < 60; step++) {
		double inverse[3][3], next[3][3], determinant = 0;
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				inverse[c][r] = x[(r + 1) % 3][(c + 1) % 3] * x[(r + 2) % 3][(c + 2) % 3] -
						x[(r + 1) % 3][(c + 2) % 3] * x[(r + 2) % 3][(c + 1) % 3];
		for (int c = 0; c < 3; c++)
			determinant += x[0][c] * inverse[c][0];
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				next[r][c] = (x[r][c] + (m[r][0] * inverse[0][c] + m[r][1] * inverse[1][c] +
								m[r][2] * inverse[2][c]) /
								determinant) /
					     2;
		memcpy(x, next, sizeof next);
	}
}

static void distances_are_those_of_centres_and_roots_of_covariances_in_the_world(void **state)
{
	(void)state;
	eskel_skeleton *s = sample(1);
	const eskel_node *nodes = s->nodes + ESKEL_NODES(levels - 1);
	esk_placed_class placed[levels];
	esk_natural_frame_place(s, levels, placed);
	for (uint32_t i = 0; i < levels; i++)
		for (uint32_t j = 0; j < levels; j++) {
			double root_i[3][3], root_j[3][3], square = 0;
			square_root((const double(*)[3])nodes[i].covariance, root_i);
			square_root((const double(*)[3])nodes[j].covariance, root_j);
			for (int r = 0; r < 3; r++) {
				square += pow(nodes[i].centre[r] - nodes[j].centre[r], 2);
				for (int c = 0; c < 3; c++)
					square += pow(root_i[r][c] - root_j[r][c], 2);
			}
			double expected = sqrt(square) / cbrt(s->volume);
			double found = distance_between(&placed[i], &placed[j]);
			if (fabs(found - expected) > 1e-12)
				fail_msg("classes %u and %u are %.17g apart, expected %.17g", i, j, found, expected);
		}
	eskel_skeleton_free(s);
}

static void the_whole_lies_at_the_origin_along_the_axes(void **state)
{
	(void)state;
	eskel_skeleton *s = sample(2);
	esk_placed_class placed;
	esk_natural_frame_place(s, 1, &placed);
	for (int c = 0; c < ESK_PLACED_COORDINATES; c++) {
		double expected = c < 3 || c >= 6 ? 0 : sqrt(s->nodes->eigenvalues[c - 3]) / cbrt(s->volume);
		if (fabs(placed.at[c] - expected) > 1e-13)
			fail_msg("coordinate %d is %.17g, expected %.17g", c, placed.at[c], expected);
	}
	assert_true(placed.share == 1);
	eskel_skeleton_free(s);
}

static void shares_of_a_level_sum_to_1(void **state)
{
	(void)state;
	eskel_skeleton *s = sample(3);
	for (uint32_t k = 1; k <= levels; k++) {
		esk_placed_class placed[levels];
		double sum = 0;
		esk_natural_frame_place(s, k, placed);
		for (uint32_t c = 0; c < k; c++)
			sum += placed[c].share;
		if (fabs(sum - 1) > 1e-14)
			fail_msg("the shares of level %u sum to %.17g", k, sum);
	}
	eskel_skeleton_free(s);
}

/* The other lanes are shrunk to a point. */
static void move_in_lane(int lane, const double move[3][3], const esk_placed_class *classes, esk_placed_class *moved)
{
	esk_lanes orthogonal[3][3] = {{{0}}};
	esk_posed_level posed;
	for (int e = 0; e < 9; e++)
		orthogonal[e / 3][e % 3][lane] = move[e / 3][e % 3];
	esk_placed_pose(classes, levels, (const esk_lanes(*)[3])orthogonal, &posed);
	for (int c = 0; c < ESK_PLACED_COORDINATES; c++)
		for (uint32_t j = 0; j < levels; j++)
			moved[j].at[c] = posed.at[c][j][lane];
}

static void moving_a_level_equals_placing_it_in_other_axes(void **state)
{
	(void)state;
	eskel_skeleton *s = sample(4);
	uint64_t random = 5;
	for (int n = 0; n < 20; n++) {
		double move[3][3], axes[3][3];
		skeletons_rotation(&random, move);
		if (n & 1) /* a reflection */
			for (int c = 0; c < 3; c++)
				move[2][c] = -move[2][c];
		esk_placed_class expected[levels], moved[levels];
		esk_natural_frame_place(s, levels, expected);
		move_in_lane(n % ESK_LANES, (const double(*)[3])move, expected, moved);
		memcpy(axes, s->nodes->axes, sizeof axes);
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				s->nodes->axes[r][c] =
					move[r][0] * axes[0][c] + move[r][1] * axes[1][c] + move[r][2] * axes[2][c];
		esk_natural_frame_place(s, levels, expected);
		memcpy(s->nodes->axes, axes, sizeof axes);
		for (uint32_t c = 0; c < levels; c++)
			if (distance_between(&expected[c], &moved[c]) > 1e-14)
				fail_msg("class %u is off by %g", c, distance_between(&expected[c], &moved[c]));
	}
	eskel_skeleton_free(s);
}

/* The matrix of a class's square root. */
static void matrix_of_root(const esk_placed_class *placed, double root[3][3])
{
	for (int r = 0; r < 3; r++) {
		int s = (r + 1) % 3, t = (r + 2) % 3;
		root[r][r] = placed->at[3 + r];
		root[s][t] = root[t][s] = placed->at[6 + r] / sqrt(2);
	}
}

/* Class by class: covariance entry (r, c) is that in the natural frame times stretch_r stretch_c. */
static void a_stretched_class_has_the_stretched_covariance(void **state)
{
	(void)state;
	eskel_skeleton *s = sample(6);
	const double *variances = s->nodes->eigenvalues;
	double stretch[3], mean = cbrt(pow(variances[0] * variances[1] * variances[2], -0.25));
	for (int i = 0; i < 3; i++)
		stretch[i] = pow(variances[i], -0.25) / mean;
	esk_placed_class plain[levels], stretched[levels];
	esk_natural_frame_place(s, levels, plain);
	assert_int_equal(esk_natural_frame_place_stretched(s, levels, stretched), ESKEL_OK);
	for (int k = 0; k < levels; k++) {
		double root[3][3], stretched_root[3][3];
		matrix_of_root(&plain[k], root);
		matrix_of_root(&stretched[k], stretched_root);
		assert_true(stretched[k].share == plain[k].share);
		for (int r = 0; r < 3; r++) {
			assert_true(fabs(stretched[k].at[r] - stretch[r] * plain[k].at[r]) < 1e-13);
			for (int c = 0; c < 3; c++) {
				double expected = 0, found = 0;
				for (int i = 0; i < 3; i++) {
					expected += stretch[r] * root[r][i] * root[i][c] * stretch[c];
					found += stretched_root[r][i] * stretched_root[i][c];
				}
				if (!(fabs(found - expected) < 1e-13))
					fail_msg("class %d (%d, %d): %g, expected %g", k, r, c, found, expected);
			}
		}
	}
	eskel_skeleton_free(s);
}

/* A variance below 2^-20 of the greatest one counts as that much, and its fourth root is 1/32. */
static void flat_shapes_are_stretched_so_far_and_no_farther(void **state)
{
	(void)state;
	for (int flat = 0; flat < 2; flat++) {
		skeletons_blob blobs[blob_count];
		const double nowhere[3] = {0}, flatten[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, flat ? 0 : 1e-4}};
		skeletons_scatter(7, blobs, blob_count);
		skeletons_move(flatten, nowhere, blobs, blob_count);
		eskel_skeleton *s = skeletons_new(blobs, blob_count, levels, 0.5);
		esk_placed_class plain[levels], stretched[levels];
		esk_natural_frame_place(s, levels, plain);
		assert_int_equal(esk_natural_frame_place_stretched(s, levels, stretched), ESKEL_OK);
		double first = stretched[0].at[0] / plain[0].at[0];
		for (int k = 0; k < levels; k++) {
			double expected = 32 * first * plain[k].at[2];
			if (!(fabs(stretched[k].at[2] - expected) < 1e-12))
				fail_msg("class %d is at %g, expected %g", k, stretched[k].at[2], expected);
		}
		eskel_skeleton_free(s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(distances_are_those_of_centres_and_roots_of_covariances_in_the_world),
		cmocka_unit_test(the_whole_lies_at_the_origin_along_the_axes),
		cmocka_unit_test(shares_of_a_level_sum_to_1),
		cmocka_unit_test(moving_a_level_equals_placing_it_in_other_axes),
		cmocka_unit_test(a_stretched_class_has_the_stretched_covariance),
		cmocka_unit_test(flat_shapes_are_stretched_so_far_and_no_farther),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
