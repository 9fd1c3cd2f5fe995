#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "skeletons.h"

#include <math.h>
#include <string.h>

enum { blob_count = 16, shape_count = 20, level = 10 };

static void assert_near(double found, double expected, double tolerance)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%.17g, expected %.17g within %g", found, expected, tolerance);
}

static eskel_partition_signature *signature_of(const skeletons_blob *blobs, double voxel_volume, const uint32_t *order)
{
	eskel_partition_signature *signature = NULL;
	eskel_skeleton *skeleton = skeletons_new(blobs, blob_count, level, voxel_volume);
	assert_int_equal(eskel_partition_signature_new(skeleton, level, order, &signature), ESKEL_OK);
	eskel_skeleton_free(skeleton);
	return signature;
}

/* Of random blobs and of the same ones after a linear map, a shift and a little noise. */
static eskel_partition_difference compare(uint64_t seed, const double linear[3][3], double noise, eskel_size size)
{
	skeletons_blob a[blob_count], b[blob_count];
	const double offset[3] = {-100, 20, 3};
	eskel_partition_difference found;
	skeletons_scatter(seed, a, blob_count);
	memcpy(b, a, sizeof b);
	skeletons_disturb(seed, noise, b, blob_count);
	skeletons_move(linear, offset, b, blob_count);
	double volume = 0;
	for (int i = 0; i < 3; i++)
		volume += linear[0][i] * (linear[1][(i + 1) % 3] * linear[2][(i + 2) % 3] -
						 linear[1][(i + 2) % 3] * linear[2][(i + 1) % 3]);
	eskel_partition_signature *of_a = signature_of(a, 1, NULL), *of_b = signature_of(b, fabs(volume), NULL);
	assert_int_equal(eskel_partition_signature_compare(of_a, of_b, size, &found), ESKEL_OK);
	eskel_partition_signature_free(of_a);
	eskel_partition_signature_free(of_b);
	return found;
}

static void a_turned_shape_has_the_same_signature_and_a_mirrored_one_volumes_of_the_other_sign(void **state)
{
	(void)state;
	for (uint64_t seed = 0; seed < shape_count; seed++) {
		uint64_t random = seed;
		double map[3][3];
		skeletons_rotation(&random, map);
		eskel_partition_difference found = compare(seed, (const double(*)[3])map, 0, ESKEL_SIZE_FIXED);
		assert_near(found.distances, 0, 1e-9);
		assert_near(found.tetrahedra, 0, 1e-8);
		assert_near(found.same_tetrahedra, 0, 1e-8);
		assert_true(found.mirrored_tetrahedra > 10);
		for (int c = 0; c < 3; c++)
			map[0][c] = -map[0][c];
		eskel_partition_difference mirrored = compare(seed, (const double(*)[3])map, 0, ESKEL_SIZE_FIXED);
		assert_near(mirrored.distances, 0, 1e-9);
		assert_near(mirrored.tetrahedra, 0, 1e-8);
		assert_near(mirrored.mirrored_tetrahedra, 0, 1e-8);
		assert_near(mirrored.same_tetrahedra, found.mirrored_tetrahedra, 1e-8);
	}
}

static void size_counts_where_it_is_fixed(void **state)
{
	(void)state;
	static const double twice[3][3] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
	eskel_partition_difference found = compare(1, twice, 0, ESKEL_SIZE_FREE);
	assert_near(found.distances, 0, 1e-9);
	assert_near(found.same_tetrahedra, 0, 1e-8);
	assert_true(compare(1, twice, 0, ESKEL_SIZE_FIXED).distances > 5);
}

static void differences_grow_with_noise_and_the_unsigned_one_is_least(void **state)
{
	(void)state;
	static const double identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	eskel_partition_difference last = {0};
	for (double noise = 0.1; noise < 10; noise *= 3) {
		eskel_partition_difference sum = {0};
		for (uint64_t seed = 0; seed < shape_count; seed++) {
			eskel_partition_difference found = compare(seed, identity, noise, ESKEL_SIZE_FIXED);
			assert_true(found.tetrahedra <= fmin(found.same_tetrahedra, found.mirrored_tetrahedra) + 1e-9);
			sum.distances += found.distances;
			sum.same_tetrahedra += found.same_tetrahedra;
		}
		assert_true(sum.distances > last.distances && sum.same_tetrahedra > last.same_tetrahedra);
		last = sum;
	}
}

/* An odd exchange of two classes flips the tetrahedra that have both, and moves all other entries. */
static void the_order_of_classes_undoes_their_numbers(void **state)
{
	(void)state;
	skeletons_blob blobs[blob_count];
	eskel_partition_difference found;
	uint32_t order[level];
	skeletons_scatter(5, blobs, blob_count);
	eskel_skeleton *a = skeletons_new(blobs, blob_count, level, 1), *b = skeletons_new(blobs, blob_count, level, 1);
	eskel_node *classes = &b->nodes[ESKEL_NODES(level - 1)];
	for (uint32_t i = 0; i < level; i++) {
		order[i] = (7 * i + 2) % level;
		classes[order[i]] = a->nodes[ESKEL_NODES(level - 1) + i];
	}
	eskel_partition_signature *of_a = NULL, *of_b = NULL;
	assert_int_equal(eskel_partition_signature_new(a, level, NULL, &of_a), ESKEL_OK);
	assert_int_equal(eskel_partition_signature_new(b, level, order, &of_b), ESKEL_OK);
	assert_int_equal(of_a->distance_count, 45);
	assert_int_equal(of_a->tetrahedron_count, 210);
	assert_int_equal(eskel_partition_signature_compare(of_a, of_b, ESKEL_SIZE_FIXED, &found), ESKEL_OK);
	assert_true(found.distances == 0 && found.same_tetrahedra == 0);
	eskel_partition_signature_free(of_a);
	eskel_partition_signature_free(of_b);
	eskel_skeleton_free(a);
	eskel_skeleton_free(b);
}

static void levels_and_orders_that_do_not_fit_are_refused(void **state)
{
	(void)state;
	skeletons_blob blobs[blob_count];
	skeletons_scatter(5, blobs, blob_count);
	eskel_skeleton *s = skeletons_new(blobs, blob_count, 4, 1);
	eskel_partition_signature *none = NULL, *three = NULL, *four = NULL;
	eskel_partition_difference found = {.distances = 7};
	static const uint32_t twice[] = {0, 1, 1, 3}, beyond[] = {0, 1, 2, 4};
	assert_int_equal(eskel_partition_signature_new(s, 0, NULL, &none), ESKEL_INVALID);
	assert_int_equal(eskel_partition_signature_new(s, 5, NULL, &none), ESKEL_INVALID);
	assert_int_equal(eskel_partition_signature_new(s, 4, twice, &none), ESKEL_INVALID);
	assert_int_equal(eskel_partition_signature_new(s, 4, beyond, &none), ESKEL_INVALID);
	assert_null(none);
	assert_int_equal(eskel_partition_signature_new(s, 3, NULL, &three), ESKEL_OK);
	assert_int_equal(eskel_partition_signature_new(s, 4, NULL, &four), ESKEL_OK);
	assert_int_equal(three->tetrahedron_count, 0);
	assert_int_equal(eskel_partition_signature_compare(three, four, ESKEL_SIZE_FIXED, &found), ESKEL_INVALID);
	assert_true(found.distances == 7);
	eskel_partition_signature_free(NULL);
	eskel_partition_signature_free(three);
	eskel_partition_signature_free(four);
	eskel_skeleton_free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_turned_shape_has_the_same_signature_and_a_mirrored_one_volumes_of_the_other_sign),
		cmocka_unit_test(size_counts_where_it_is_fixed),
		cmocka_unit_test(differences_grow_with_noise_and_the_unsigned_one_is_least),
		cmocka_unit_test(the_order_of_classes_undoes_their_numbers),
		cmocka_unit_test(levels_and_orders_that_do_not_fit_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
