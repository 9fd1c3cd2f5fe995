/* Volumes whose voxels are weights, against sums over the voxels themselves. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "nifti_file.h"
#include "volume_decode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { nx = 17, ny = 12, nz = 9, voxel_count = nx * ny * nz, float32 = 16, float64 = 64, uint8 = 2 };

static eskel_status decode(
	const double *values, int datatype, size_t piece, size_t most_runs, eskel_volume **volume, eskel_error *error)
{
	const nifti_file file = nifti_file_new(1, false, datatype, nx, ny, nz);
	const eskel_volume_options options = {.weights = true, .most_runs = most_runs};
	size_t size;
	uint8_t *bytes = nifti_file_write(&file, values, voxel_count, &size);
	const eskel_status status = volume_decode(bytes, size, piece, &options, volume, error);
	free(bytes);
	return status;
}

static eskel_cloud *cloud_of(const double *values, int datatype, size_t piece)
{
	eskel_volume *volume;
	eskel_error error = {0};
	eskel_cloud *cloud;
	if (decode(values, datatype, piece, 0, &volume, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	assert_int_equal(eskel_volume_label_count(volume), 1);
	assert_int_equal(eskel_volume_label(volume, 0), 1);
	assert_int_equal(eskel_volume_cloud(volume, 1, &cloud, &error), ESKEL_OK);
	eskel_volume_free(volume);
	return cloud;
}

/* A blurred ball off the middle. */
static void fill_ball(double *values, double scale)
{
	for (int i = 0; i < voxel_count; i++) {
		const double x = i % nx - 7, y = i / nx % ny - 6, z = i / (nx * ny) - 4;
		values[i] = scale / (1 + exp(3 * (sqrt(x * x + y * y + z * z) - 3)));
	}
}

static void assert_same(const eskel_cloud *a, const eskel_cloud *b)
{
	assert_int_equal(a->run_count, b->run_count);
	assert_int_equal(a->weight, b->weight);
	assert_memory_equal(a->runs, b->runs, a->run_count * sizeof *a->runs);
	assert_int_equal(a->weights == NULL, b->weights == NULL);
	if (a->weights)
		assert_memory_equal(a->weights, b->weights, a->run_count * sizeof *a->weights);
}

static void moments_are_those_of_the_weighted_voxels(void **state)
{
	(void)state;
	double values[voxel_count], sum = 0, mean[3] = {0}, scatter[3][3] = {{0}};
	fill_ball(values, .9);
	for (int i = 0; i < voxel_count; i++) {
		const double u[3] = {i % nx, i / nx % ny, i / (nx * ny)};
		sum += values[i];
		for (int a = 0; a < 3; a++) {
			mean[a] += values[i] * u[a];
			for (int b = 0; b < 3; b++)
				scatter[a][b] += values[i] * u[a] * u[b];
		}
	}
	eskel_cloud *cloud = cloud_of(values, float64, 1 << 20);
	eskel_skeleton *skeleton;
	eskel_error error;
	assert_int_equal(
		eskel_skeleton_new(cloud, &(eskel_skeleton_options){.levels = 4}, &skeleton, &error), ESKEL_OK);
	const eskel_node *whole = eskel_skeleton_node(skeleton, 1, 0);
	for (int a = 0; a < 3; a++) {
		assert_true(fabs(whole->centre[a] - mean[a] / sum) < 1e-3);
		for (int b = 0; b < 3; b++) {
			const double expected = scatter[a][b] / sum - mean[a] * mean[b] / (sum * sum);
			if (!(fabs(whole->covariance[a][b] - expected) < 5e-3))
				fail_msg(
					"covariance %d %d is %g, expected %g", a, b, whole->covariance[a][b], expected);
		}
	}
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
}

static void the_unit_of_weights_and_the_cut_of_the_file_do_not_matter(void **state)
{
	(void)state;
	double values[voxel_count];
	fill_ball(values, 1);
	eskel_cloud *expected = cloud_of(values, float64, 1 << 20);
	assert_non_null(expected->weights);
	for (size_t pieces = 7; pieces < 2000; pieces = 3 * pieces + 2) {
		eskel_cloud *cloud = cloud_of(values, float64, pieces);
		assert_same(expected, cloud);
		eskel_cloud_free(cloud);
	}
	fill_ball(values, 1024);
	eskel_cloud *cloud = cloud_of(values, float64, 1 << 20);
	assert_same(expected, cloud);
	eskel_cloud_free(cloud);
	eskel_cloud_free(expected);
}

static void bytes_keep_their_values(void **state)
{
	(void)state;
	double values[voxel_count] = {0};
	values[100] = 255;
	values[101] = 1;
	values[500] = 128;
	eskel_cloud *cloud = cloud_of(values, uint8, 1 << 20);
	assert_int_equal(cloud->run_count, 3);
	assert_int_equal(cloud->weights[0], 255);
	assert_int_equal(cloud->weights[1], 1);
	assert_int_equal(cloud->weights[2], 128);
	eskel_cloud_free(cloud);
}

static void a_mask_of_any_one_weight_is_the_cloud_without_weights(void **state)
{
	(void)state;
	double values[voxel_count] = {0};
	for (int i = 300; i < 900; i++)
		values[i] = .37 * (i % 5 != 0);
	eskel_cloud *cloud = cloud_of(values, float32, 1 << 20);
	assert_null(cloud->weights);
	assert_int_equal(cloud->weight, cloud->voxels);
	assert_int_equal(cloud->voxels, 480);
	eskel_cloud_free(cloud);
}

static void what_is_nothing_beside_the_largest_is_left_out_in_whatever_order_it_comes(void **state)
{
	(void)state;
	double values[voxel_count];
	for (int i = 0; i < voxel_count; i++)
		values[i] = 1e-6 * (1 + i % 97);
	values[1700] = 1;
	values[5] = 1. / 4080;
	eskel_cloud *cloud = cloud_of(values, float64, 1 << 20);
	assert_int_equal(cloud->voxels, 2);
	assert_int_equal(cloud->weight, 4081);
	eskel_cloud_free(cloud);
	/* So it counts against no limit once room is made. */
	eskel_volume *volume;
	eskel_error error = {0};
	values[5] = 1;
	values[1700] = 0;
	assert_int_equal(decode(values, float64, 1 << 20, 6, &volume, &error), ESKEL_OK);
	eskel_volume_free(volume);
}

static void assert_refused(double *values, int place, double value, eskel_status expected, const char *sentence)
{
	eskel_volume *volume;
	eskel_error error = {0};
	values[place] = value;
	assert_int_equal(decode(values, float64, 1 << 20, 3, &volume, &error), expected);
	assert_string_equal(error.text, sentence);
	eskel_volume_free(volume);
	values[place] = 0;
}

static void what_is_no_weight_is_refused_with_its_place(void **state)
{
	(void)state;
	double values[voxel_count] = {0};
	const int place = 3 + nx * (4 + ny * 5);
	assert_refused(values, place, -.5, ESKEL_BAD_VALUE,
		"voxel (3, 4, 5) is -0.5, expected a weight: a finite number from 0");
	assert_refused(values, place, NAN, ESKEL_BAD_VALUE,
		"voxel (3, 4, 5) is nan, expected a weight: a finite number from 0");
	assert_refused(values, place, INFINITY, ESKEL_BAD_VALUE,
		"voxel (3, 4, 5) is inf, expected a weight: a finite number from 0");
	assert_refused(values, place, 0, ESKEL_EMPTY, "no voxel has a weight above 0");
	for (int i = 0; i < 9; i += 2)
		values[i] = 1 + .1 * i;
	assert_refused(values, place, 1, ESKEL_TOO_LARGE, "the weights have more than 3 runs of voxels");
}

static void encoded_a_weighted_cloud_is_the_same(void **state)
{
	(void)state;
	double values[voxel_count];
	fill_ball(values, 1);
	eskel_cloud *cloud = cloud_of(values, float32, 1 << 20), *again;
	uint8_t *bytes;
	size_t size;
	eskel_error error;
	assert_int_equal(eskel_cloud_encode(cloud, &bytes, &size), ESKEL_OK);
	assert_int_equal(eskel_cloud_decode(bytes, size, &again, &error), ESKEL_OK);
	assert_same(cloud, again);
	free(bytes);
	eskel_cloud_free(cloud);
	eskel_cloud_free(again);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(moments_are_those_of_the_weighted_voxels),
		cmocka_unit_test(the_unit_of_weights_and_the_cut_of_the_file_do_not_matter),
		cmocka_unit_test(bytes_keep_their_values),
		cmocka_unit_test(a_mask_of_any_one_weight_is_the_cloud_without_weights),
		cmocka_unit_test(what_is_nothing_beside_the_largest_is_left_out_in_whatever_order_it_comes),
		cmocka_unit_test(what_is_no_weight_is_refused_with_its_place),
		cmocka_unit_test(encoded_a_weighted_cloud_is_the_same),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
