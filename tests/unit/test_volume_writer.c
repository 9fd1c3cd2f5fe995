#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"

#include <stdlib.h>
#include <string.h>

static uint32_t random_number(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(*state >> 33);
}

static double between(uint64_t *state, double low, double high)
{
	return low + (high - low) * random_number(state) / 2147483648.0;
}

/* Oblique, sheared, anisotropic, of either hand. */
static eskel_affine any_affine(uint64_t *state, double farthest)
{
	eskel_affine a;
	do {
		for (int i = 0; i < 12; i++)
			a.m[i / 4][i % 4] = i % 4 == 3 ? between(state, -farthest, farthest) : between(state, -2, 2);
	} while (eskel_affine_check(&a, NULL) != ESKEL_OK);
	return a;
}

/* A run in each of some rows, at distances that leave rows, planes and pieces of the file empty. */
static eskel_cloud *any_cloud(uint64_t *state, const eskel_affine *affine, unsigned extent)
{
	enum { count = 30 };
	eskel_run runs[count];
	eskel_cloud *cloud = NULL;
	for (unsigned i = 0; i < count; i++) {
		const unsigned a = random_number(state) % extent, b = random_number(state) % extent;
		runs[i] = (eskel_run){(uint16_t)(a < b ? a : b), (uint16_t)(a < b ? b : a),
			(uint16_t)(random_number(state) % extent), (uint16_t)(i * 3)};
	}
	assert_int_equal(eskel_cloud_new(runs, NULL, count, affine, &cloud, NULL), ESKEL_OK);
	return cloud;
}

/* The file's bytes, taken capacity at a time, decoded; the volume. */
static eskel_volume *read_back(const eskel_cloud *cloud, int32_t label, eskel_volume_format format, size_t capacity)
{
	static uint8_t bytes[1 << 16];
	eskel_volume_writer *writer = NULL;
	eskel_volume *volume = NULL;
	eskel_error error;
	assert_int_equal(eskel_volume_writer_new(cloud, label, format, &writer), ESKEL_OK);
	assert_int_equal(eskel_volume_new(&(eskel_volume_options){.weights = cloud->weights}, &volume), ESKEL_OK);
	for (size_t size; (size = eskel_volume_writer_next(writer, bytes, capacity)) > 0;)
		if (eskel_volume_feed(volume, bytes, size, &error))
			fail_msg("%s", error.text);
	assert_int_equal(eskel_volume_writer_next(writer, bytes, capacity), 0);
	if (eskel_volume_finish(volume, &error))
		fail_msg("%s", error.text);
	eskel_volume_writer_free(writer);
	return volume;
}

static void assert_same(const eskel_cloud *a, const eskel_cloud *b)
{
	uint8_t *a_bytes, *b_bytes;
	size_t a_size, b_size;
	assert_int_equal(eskel_cloud_encode(a, &a_bytes, &a_size), ESKEL_OK);
	assert_int_equal(eskel_cloud_encode(b, &b_bytes, &b_size), ESKEL_OK);
	assert_int_equal(a_size, b_size);
	assert_memory_equal(a_bytes, b_bytes, a_size);
	free(a_bytes);
	free(b_bytes);
}

/* Returns the format that was read. */
static const char *check(const eskel_cloud *cloud, int32_t label, eskel_volume_format format, size_t capacity)
{
	eskel_volume *volume = read_back(cloud, label, format, capacity);
	eskel_cloud *again = NULL;
	unsigned sides = 0;
	assert_int_equal(eskel_volume_label_count(volume), 1);
	assert_int_equal(eskel_volume_label(volume, 0), label);
	assert_int_equal(eskel_volume_cloud(volume, label, &again, NULL), ESKEL_OK);
	assert_int_equal(eskel_volume_border(volume, label, &sides), ESKEL_OK);
	assert_true(sides == 0 || cloud->extent[0] > 65533);
	assert_int_equal(eskel_volume_get_info(volume)->warning_count, 0);
	assert_same(cloud, again);
	const char *read = eskel_volume_get_info(volume)->format;
	eskel_cloud_free(again);
	eskel_volume_free(volume);
	return read;
}

static void a_cloud_is_read_back_bit_for_bit(void **state)
{
	(void)state;
	static const int32_t labels[] = {1, 255, 256, 32767, 40000, -1, -32768, -32769, 2147483647};
	static const size_t capacities[] = {1 << 16, 1 << 15, 997, 1};
	uint64_t seed = 7;
	for (unsigned i = 0; i < 140; i++) {
		const eskel_affine affine = any_affine(&seed, i % 5 ? 300 : 100000);
		eskel_cloud *cloud = any_cloud(&seed, &affine, i % 7 ? 40 : 100);
		const int32_t label = labels[i % 9];
		const size_t capacity = capacities[i % 4];
		const char *format = check(cloud, label, ESKEL_VOLUME_NIFTI, capacity);
		if (i % 5)
			assert_string_equal(format, "NIfTI-1");
		assert_string_equal(check(cloud, label, ESKEL_VOLUME_NRRD, capacity), "NRRD");
		eskel_cloud_free(cloud);
	}
}

static void a_place_that_floats_cannot_hold_is_written_as_nifti_2(void **state)
{
	(void)state;
	const eskel_run run = {3, 9, 1, 2};
	const eskel_affine affine = {{{0.3, 0, 0, 123456.789}, {0, 0.3, 0, 0}, {0, 0, 0.3, 0}}};
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(&run, NULL, 1, &affine, &cloud, NULL), ESKEL_OK);
	assert_string_equal(check(cloud, 1, ESKEL_VOLUME_NIFTI, 1 << 16), "NIfTI-2");
	eskel_cloud_free(cloud);
}

static void an_axis_that_nifti_1_cannot_count_is_written_as_nifti_2(void **state)
{
	(void)state;
	static const uint16_t lasts[] = {32764, 32765, 65532, 65534};
	static const char *const formats[] = {"NIfTI-1", "NIfTI-2", "NIfTI-2", "NIfTI-2"};
	const eskel_affine affine = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
	for (size_t i = 0; i < 4; i++) {
		const eskel_run runs[] = {{0, lasts[i], 0, 0}, {0, 5, 2, 1}};
		eskel_cloud *cloud = NULL;
		assert_int_equal(eskel_cloud_new(runs, NULL, 2, &affine, &cloud, NULL), ESKEL_OK);
		assert_string_equal(check(cloud, 1, ESKEL_VOLUME_NIFTI, 1 << 16), formats[i]);
		assert_string_equal(check(cloud, 1, ESKEL_VOLUME_NRRD, 1 << 16), "NRRD");
		eskel_cloud_free(cloud);
	}
}

static const eskel_affine unit = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static eskel_cloud *weighted(const uint32_t *weights, size_t count)
{
	eskel_run runs[64];
	eskel_cloud *cloud = NULL;
	assert_true(count <= 64);
	for (size_t i = 0; i < count; i++)
		runs[i] =
			(eskel_run){(uint16_t)(2 * i), (uint16_t)(2 * i + i % 2), (uint16_t)(i % 3), (uint16_t)(i / 3)};
	assert_int_equal(eskel_cloud_new(runs, weights, count, &unit, &cloud, NULL), ESKEL_OK);
	return cloud;
}

static void weights_come_back_when_they_are_read_as_such(void **state)
{
	(void)state;
	static const uint32_t wide[] = {4080, 1, 77, 4079, 4080, 256}, narrow[] = {255, 1, 2, 254, 255, 13},
			      half[] = {1, 2, 2, 1, 1, 2};
	static const uint32_t *const all[] = {wide, narrow, half};
	for (size_t i = 0; i < 6; i++) {
		eskel_cloud *cloud = weighted(all[i / 2], 6), *again = NULL;
		eskel_volume *volume = read_back(cloud, 1, i % 2 ? ESKEL_VOLUME_NRRD : ESKEL_VOLUME_NIFTI, 1 << 16);
		assert_int_equal(eskel_volume_cloud(volume, 1, &again, NULL), ESKEL_OK);
		assert_non_null(again->weights);
		assert_same(cloud, again);
		eskel_cloud_free(again);
		eskel_cloud_free(cloud);
		eskel_volume_free(volume);
	}
}

static void weights_that_no_file_gives_are_refused(void **state)
{
	(void)state;
	static const uint32_t sevenths[] = {7, 1, 2}, even[] = {2, 4, 4}, huge[] = {1 << 20, 1, 1},
			      good[] = {255, 1, 2};
	static const uint32_t *const all[] = {sevenths, even, huge, good};
	for (size_t i = 0; i < 4; i++) {
		eskel_cloud *cloud = weighted(all[i], 3);
		eskel_volume_writer *writer = NULL;
		assert_int_equal(eskel_volume_writer_new(cloud, all[i] == good ? 2 : 1, ESKEL_VOLUME_NIFTI, &writer),
			ESKEL_UNSUPPORTED);
		assert_null(writer);
		eskel_cloud_free(cloud);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_cloud_is_read_back_bit_for_bit),
		cmocka_unit_test(a_place_that_floats_cannot_hold_is_written_as_nifti_2),
		cmocka_unit_test(an_axis_that_nifti_1_cannot_count_is_written_as_nifti_2),
		cmocka_unit_test(weights_come_back_when_they_are_read_as_such),
		cmocka_unit_test(weights_that_no_file_gives_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
