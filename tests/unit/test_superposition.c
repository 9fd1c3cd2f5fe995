#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "skeletons.h"

#include <math.h>
#include <string.h>

enum { blob_count = 16, shape_count = 12 };

static void assert_near(double found, double expected, double tolerance)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%.17g, expected %.17g within %g", found, expected, tolerance);
}

static void assert_orthogonal(const eskel_affine *map, double determinant)
{
	assert_near(eskel_affine_determinant(map), determinant, 1e-12);
	for (int r = 0; r < 3; r++)
		for (int s = 0; s < 3; s++) {
			double dot = 0;
			for (int c = 0; c < 3; c++)
				dot += map->m[r][c] * map->m[s][c];
			assert_near(dot, r == s, 1e-12);
		}
}

/* A random isometry: proper or improper. */
static void random_isometry(uint64_t seed, bool mirrored, eskel_affine *map)
{
	double linear[3][3];
	uint64_t random = seed;
	skeletons_rotation(&random, linear);
	*map = (eskel_affine){{{0, 0, 0, 100}, {0, 0, 0, -50}, {0, 0, 0, 7 + (double)seed}}};
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			map->m[r][c] = mirrored && r == 0 ? -linear[r][c] : linear[r][c];
}

static void apply(const eskel_affine *map, skeletons_blob *blobs)
{
	double linear[3][3], offset[3];
	for (int r = 0; r < 3; r++) {
		memcpy(linear[r], map->m[r], sizeof linear[r]);
		offset[r] = map->m[r][3];
	}
	skeletons_move((const double(*)[3])linear, offset, blobs, blob_count);
}

/* The greatest distance between where two maps send the centres of the blobs. */
static double disagreement(const eskel_affine *a, const eskel_affine *b, const skeletons_blob *blobs)
{
	double greatest = 0;
	for (int i = 0; i < blob_count; i++) {
		double square = 0;
		for (int r = 0; r < 3; r++) {
			double d = a->m[r][3] - b->m[r][3];
			for (int c = 0; c < 3; c++)
				d += (a->m[r][c] - b->m[r][c]) * blobs[i].centre[c];
			square += d * d;
		}
		greatest = fmax(greatest, sqrt(square));
	}
	return greatest;
}

typedef struct {
	double off; /* mm, of the right hand */
	eskel_superposition right, wrong;
} outcome;

/* Blobs are moved by an isometry after a little noise, and it is looked for. */
static outcome recover(uint64_t seed, bool mirrored, double noise, uint32_t levels)
{
	skeletons_blob a[blob_count], b[blob_count];
	eskel_superposition found[2];
	eskel_affine map;
	skeletons_scatter(seed, a, blob_count);
	memcpy(b, a, sizeof b);
	skeletons_disturb(seed, noise, b, blob_count);
	random_isometry(seed, mirrored, &map);
	apply(&map, b);
	eskel_skeleton *of_a = skeletons_new(a, blob_count, levels, 1), *of_b = skeletons_new(b, blob_count, levels, 1);
	eskel_superposition_find(of_a, of_b, &found[0], &found[1]);
	assert_orthogonal(&found[0].map, 1);
	assert_orthogonal(&found[1].map, -1);
	eskel_skeleton_free(of_a);
	eskel_skeleton_free(of_b);
	return (outcome){disagreement(&map, &found[mirrored].map, a), found[mirrored], found[!mirrored]};
}

static void an_isometry_is_recovered(void **state)
{
	(void)state;
	for (uint64_t seed = 0; seed < shape_count; seed++)
		for (int mirrored = 0; mirrored < 2; mirrored++) {
			outcome found = recover(seed, mirrored, 0, 16);
			assert_near(found.off, 0, 1e-8);
			assert_near(found.right.rms, 0, 1e-8);
			assert_true(found.wrong.rms > 0.5);
		}
}

static void noise_moves_it_by_no_more_than_itself(void **state)
{
	(void)state;
	static const double noise[] = {0.1, 1, 3};
	for (size_t n = 0; n < sizeof noise / sizeof *noise; n++) {
		double worst = 0, rms = 0;
		for (uint64_t seed = 0; seed < shape_count; seed++)
			for (int mirrored = 0; mirrored < 2; mirrored++) {
				outcome found = recover(seed, mirrored, noise[n], 16);
				worst = fmax(worst, found.off);
				rms = fmax(rms, found.right.rms);
			}
		print_message(
			"    noise up to %g mm an axis: off by %.3g mm at most, rms %.3g\n", noise[n], worst, rms);
		assert_true(worst < 1.5 * noise[n] && rms < 1.5 * noise[n]);
	}
}

static void few_levels_superpose_as_far_as_they_tell(void **state)
{
	(void)state;
	for (uint64_t seed = 0; seed < shape_count; seed++)
		for (uint32_t levels = 1; levels < 8; levels++) {
			outcome found = recover(seed, false, 0, levels);
			assert_near(found.right.rms, 0, 1e-8);
			if (levels > 4)
				assert_near(found.off, 0, 1e-8);
		}
}

static void swapping_the_shapes_inverts_it(void **state)
{
	(void)state;
	for (uint64_t seed = 0; seed < shape_count; seed++) {
		skeletons_blob a[blob_count], b[blob_count];
		eskel_superposition there[2], back[2];
		skeletons_scatter(seed, a, blob_count);
		memcpy(b, a, sizeof b);
		skeletons_disturb(seed, 1, b, blob_count);
		eskel_skeleton *of_a = skeletons_new(a, blob_count, 16, 1), *of_b = skeletons_new(b, blob_count, 16, 1);
		eskel_superposition_find(of_a, of_b, &there[0], &there[1]);
		eskel_superposition_find(of_b, of_a, &back[0], &back[1]);
		assert_near(there[0].rms, back[0].rms, 1e-6);
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				assert_near(there[0].map.m[r][c], back[0].map.m[c][r], 1e-6);
		eskel_skeleton_free(of_a);
		eskel_skeleton_free(of_b);
	}
}

static void size_is_not_changed(void **state)
{
	(void)state;
	skeletons_blob a[blob_count], b[blob_count];
	static const double twice[3][3] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, nowhere[3] = {0};
	eskel_superposition proper, improper;
	skeletons_scatter(3, a, blob_count);
	memcpy(b, a, sizeof b);
	skeletons_move(twice, nowhere, b, blob_count);
	eskel_skeleton *of_a = skeletons_new(a, blob_count, 16, 1), *of_b = skeletons_new(b, blob_count, 16, 8);
	eskel_superposition_find(of_a, of_b, &proper, &improper);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			assert_near(proper.map.m[r][c], r == c, 1e-8);
	assert_true(proper.rms > 5);
	eskel_skeleton_free(of_a);
	eskel_skeleton_free(of_b);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_isometry_is_recovered),
		cmocka_unit_test(noise_moves_it_by_no_more_than_itself),
		cmocka_unit_test(few_levels_superpose_as_far_as_they_tell),
		cmocka_unit_test(swapping_the_shapes_inverts_it),
		cmocka_unit_test(size_is_not_changed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
