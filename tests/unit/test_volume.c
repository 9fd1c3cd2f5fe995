#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "nifti_file.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t random_number(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(*state >> 33);
}

/* Decodes in pieces of the given size; 0: in one piece; random_pieces: of 1 to 40 bytes. On failure *volume is NULL. */
enum { whole = 0, random_pieces = -1 };

static eskel_status decode(const uint8_t *bytes, size_t size, int pieces, const eskel_volume_options *options,
	eskel_volume **volume, eskel_error *error)
{
	uint64_t seed = size;
	eskel_volume *v = NULL;
	assert_int_equal(eskel_volume_new(options, &v), ESKEL_OK);
	eskel_status status = ESKEL_OK;
	for (size_t at = 0; at < size && status == ESKEL_OK;) {
		size_t piece = pieces == whole ? size : pieces > 0 ? (size_t)pieces : 1 + random_number(&seed) % 40;
		if (piece > size - at)
			piece = size - at;
		status = eskel_volume_feed(v, bytes + at, piece, error);
		at += piece;
	}
	if (status == ESKEL_OK)
		status = eskel_volume_finish(v, error);
	if (status != ESKEL_OK) {
		eskel_volume_free(v);
		v = NULL;
	}
	*volume = v;
	return status;
}

static eskel_volume *decoded(
	const nifti_file *file, const double *values, size_t count, const eskel_volume_options *options)
{
	size_t size;
	uint8_t *bytes = nifti_file_write(file, values, count, &size);
	eskel_volume *volume;
	eskel_error error;
	if (decode(bytes, size, whole, options, &volume, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	free(bytes);
	return volume;
}

static void assert_refused(const nifti_file *file, const double *values, size_t count,
	const eskel_volume_options *options, eskel_status status, const char *text)
{
	size_t size;
	uint8_t *bytes = nifti_file_write(file, values, count, &size);
	eskel_volume *volume;
	eskel_error error;
	assert_int_equal(decode(bytes, size, whole, options, &volume, &error), status);
	assert_int_equal(error.status, status);
	assert_string_equal(error.text, text);
	free(bytes);
}

/* Whether the volume, of an identity affine, has exactly these labels: its clouds painted back into a grid. */
static void assert_labels(const eskel_volume *volume, const double *values, size_t count)
{
	const uint32_t *extent = eskel_volume_get_info(volume)->extent;
	double *painted = calloc(count, sizeof *painted);
	assert_non_null(painted);
	for (size_t i = 0; i < eskel_volume_label_count(volume); i++) {
		int32_t label = eskel_volume_label(volume, i);
		eskel_cloud *cloud = NULL;
		assert_int_equal(eskel_volume_cloud(volume, label, &cloud, NULL), ESKEL_OK);
		for (size_t r = 0; r < cloud->run_count; r++)
			for (unsigned x = cloud->runs[r].x_first; x <= cloud->runs[r].x_last; x++) {
				size_t gx = x + (size_t)cloud->affine.m[0][3];
				size_t gy = cloud->runs[r].y + (size_t)cloud->affine.m[1][3];
				size_t gz = cloud->runs[r].z + (size_t)cloud->affine.m[2][3];
				painted[gx + extent[0] * (gy + extent[1] * gz)] = label;
			}
		eskel_cloud_free(cloud);
	}
	for (size_t i = 0; i < count; i++)
		if (painted[i] != values[i])
			fail_msg("voxel %zu is %g, expected %g", i, painted[i], values[i]);
	free(painted);
}

/* Long and short stretches, full rows and slices, some labels next to each other. */
static void fill_random(uint64_t *seed, double *values, size_t count, const double *labels, size_t label_count)
{
	for (size_t i = 0; i < count;) {
		size_t length = 1 + random_number(seed) % (random_number(seed) % 4 ? 5 : 400);
		double label = random_number(seed) % 2 ? 0 : labels[random_number(seed) % label_count];
		for (; length > 0 && i < count; length--)
			values[i++] = label;
	}
}

static void every_datatype_byte_order_and_version_gives_the_same_labels(void **state)
{
	(void)state;
	static const struct {
		int datatype;
		double labels[4];
	} types[] = {
		{2, {1, 2, 127, 255}},
		{256, {1, -1, 127, -128}},
		{4, {1, -256, 32767, -32768}},
		{512, {1, 255, 256, 65535}},
		{8, {1, -65536, 2147483647, -2147483647}},
		{768, {1, 65536, 2147483647, 255}},
		{1024, {1, -65536, 2147483647, -2147483647}},
		{1280, {1, 65536, 2147483647, 255}},
		{16, {1, -2, 300, 16777216}},
		{64, {1, -2, 2147483647, -2147483647}},
	};
	double values[37 * 11 * 9];
	const size_t count = sizeof values / sizeof values[0];
	uint64_t seed = 1;
	for (size_t t = 0; t < sizeof types / sizeof types[0]; t++)
		for (int variant = 0; variant < 4; variant++) {
			nifti_file file = nifti_file_new(1 + variant / 2, variant % 2, types[t].datatype, 37, 11, 9);
			fill_random(&seed, values, count, types[t].labels, 4);
			eskel_volume *volume = decoded(&file, values, count, NULL);
			assert_labels(volume, values, count);
			assert_string_equal(eskel_volume_get_info(volume)->format, variant < 2 ? "NIfTI-1" : "NIfTI-2");
			assert_int_equal(eskel_volume_get_info(volume)->warning_count, 0);
			eskel_volume_free(volume);
		}
}

static void labels_are_listed_ascending(void **state)
{
	(void)state;
	const double values[] = {7, -3, 2147483647, 0, -2147483647, 7};
	nifti_file file = nifti_file_new(1, false, 8, 6, 1, 1);
	eskel_volume *volume = decoded(&file, values, 6, NULL);
	const int32_t expected[] = {-2147483647, -3, 7, 2147483647};
	assert_int_equal(eskel_volume_label_count(volume), 4);
	for (size_t i = 0; i < 4; i++)
		assert_int_equal(eskel_volume_label(volume, i), expected[i]);
	eskel_cloud *cloud = NULL;
	eskel_error error;
	assert_int_equal(eskel_volume_cloud(volume, 8, &cloud, &error), ESKEL_NOT_FOUND);
	assert_string_equal(error.text, "no voxel has label 8");
	eskel_volume_free(volume);
}

static void a_gzipped_file_gives_the_same_labels(void **state)
{
	(void)state;
	double values[300 * 200 * 3]; /* more than the inflater's window */
	const size_t count = sizeof values / sizeof values[0];
	uint64_t seed = 2;
	fill_random(&seed, values, count, (double[]){1, 2, 3}, 3);
	nifti_file file = nifti_file_new(1, false, 4, 300, 200, 3);
	size_t size, gzip_size;
	uint8_t *bytes = nifti_file_write(&file, values, count, &size);
	uint8_t *gzipped = nifti_file_gzip(bytes, size, &gzip_size);
	eskel_volume *volume;
	assert_int_equal(decode(gzipped, gzip_size, whole, NULL, &volume, NULL), ESKEL_OK);
	assert_true(eskel_volume_get_info(volume)->gzipped);
	assert_labels(volume, values, count);
	eskel_volume_free(volume);
	free(gzipped);
	free(bytes);
}

static void gzip_members_are_joined(void **state)
{
	(void)state;
	const double values[] = {0, 5, 5, 0, 5, 5};
	nifti_file file = nifti_file_new(1, false, 512, 3, 2, 1);
	size_t size, first_size, second_size;
	uint8_t *bytes = nifti_file_write(&file, values, 6, &size);
	uint8_t *first = nifti_file_gzip(bytes, size - 7, &first_size); /* ends within a voxel */
	uint8_t *second = nifti_file_gzip(bytes + size - 7, 7, &second_size);
	uint8_t *joined = malloc(first_size + second_size);
	assert_non_null(joined);
	memcpy(joined, first, first_size);
	memcpy(joined + first_size, second, second_size);
	eskel_volume *volume;
	assert_int_equal(decode(joined, first_size + second_size, whole, NULL, &volume, NULL), ESKEL_OK);
	assert_labels(volume, values, 6);
	eskel_volume_free(volume);
	free(joined);
	free(second);
	free(first);
	free(bytes);
}

static void any_cut_of_a_file_gives_the_same_clouds(void **state)
{
	(void)state;
	static const int pieces[] = {1, 3, 7, 64, 353, random_pieces};
	static const int datatypes[] = {2, 4, 8, 64};
	double values[70 * 6 * 5];
	const size_t count = sizeof values / sizeof values[0];
	uint64_t seed = 3;
	for (size_t t = 0; t < 4; t++) {
		fill_random(&seed, values, count, (double[]){1, 2, 77}, 3);
		nifti_file file = nifti_file_new(2, t % 2, datatypes[t], 70, 6, 5);
		file.vox_offset = 1003;
		size_t size, gzip_size;
		uint8_t *bytes = nifti_file_write(&file, values, count, &size);
		uint8_t *gzipped = nifti_file_gzip(bytes, size, &gzip_size);
		for (size_t p = 0; p < sizeof pieces / sizeof pieces[0]; p++) {
			eskel_volume *plain, *inflated;
			assert_int_equal(decode(bytes, size, pieces[p], NULL, &plain, NULL), ESKEL_OK);
			assert_int_equal(decode(gzipped, gzip_size, pieces[p], NULL, &inflated, NULL), ESKEL_OK);
			assert_labels(plain, values, count);
			assert_labels(inflated, values, count);
			eskel_volume_free(plain);
			eskel_volume_free(inflated);
		}
		free(gzipped);
		free(bytes);
	}
}

static void minus_zero_is_background_and_equal_labels_make_one_run(void **state)
{
	(void)state;
	/* 2.0 and 1.9999999 x 1.0000001 are different bytes that mean label 2 once they are scaled. */
	const double values[] = {0.0, -0.0, 2.0, 1.99999988, 2.0, -0.0};
	const double expected[] = {0, 0, 2, 2, 2, 0};
	nifti_file file = nifti_file_new(1, false, 16, 6, 1, 1);
	file.slope = 1.00000012;
	eskel_volume *volume = decoded(&file, values, 6, NULL);
	assert_labels(volume, expected, 6);
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_volume_cloud(volume, 2, &cloud, NULL), ESKEL_OK);
	assert_int_equal(cloud->run_count, 1);
	eskel_cloud_free(cloud);
	eskel_volume_free(volume);
}

static void scaled_values_are_labels(void **state)
{
	(void)state;
	static const struct {
		double slope, inter, stored[4], labels[4];
	} cases[] = {
		{2, 1, {0, 1, 2, 255}, {1, 3, 5, 511}}, {1.0 / 255, 0, {0, 255, 0, 255}, {0, 1, 0, 1}},
		{-1, 0, {0, 1, 2, 3}, {0, -1, -2, -3}}, {1, -3, {0, 3, 4, 5}, {-3, 0, 1, 2}},
		{0, 7, {0, 1, 2, 3}, {0, 1, 2, 3}},     /* slope 0: no scaling */
		{NAN, NAN, {0, 1, 2, 3}, {0, 1, 2, 3}}, /* written by some libraries for the same */
	};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		nifti_file file = nifti_file_new(1, false, 2, 4, 1, 1);
		file.slope = cases[i].slope;
		file.inter = cases[i].inter;
		eskel_volume *volume = decoded(&file, cases[i].stored, 4, NULL);
		assert_labels(volume, cases[i].labels, 4);
		eskel_volume_free(volume);
	}
}

static void only_wanted_labels_are_kept(void **state)
{
	(void)state;
	const double values[] = {1, 2, 3, 4, 0, 3, 3, 1};
	const double expected[] = {1, 0, 3, 0, 0, 3, 3, 1};
	const int32_t wanted[] = {3, 9, 1, 3};
	nifti_file file = nifti_file_new(1, false, 2, 8, 1, 1);
	eskel_volume *volume = decoded(&file, values, 8, &(eskel_volume_options){.labels = wanted, .label_count = 4});
	assert_int_equal(eskel_volume_label_count(volume), 2);
	assert_labels(volume, expected, 8);
	eskel_volume_free(volume);
	assert_refused(&file, values, 8, &(eskel_volume_options){.labels = wanted + 1, .label_count = 1}, ESKEL_EMPTY,
		"no voxel has a wanted label");
	const int32_t background = 0;
	eskel_volume_options zero = {.labels = &background, .label_count = 1};
	assert_int_equal(eskel_volume_new(&zero, &volume), ESKEL_INVALID);
}

static void limits_are_kept_exactly(void **state)
{
	(void)state;
	const double values[] = {1, 2, 3, 0, 3, 3, 3, 3};
	nifti_file file = nifti_file_new(1, false, 2, 4, 2, 1);
	eskel_volume *volume =
		decoded(&file, values, 8, &(eskel_volume_options){.most_voxels = 8, .most_runs = 4, .most_labels = 3});
	eskel_volume_free(volume);
	assert_refused(&file, values, 8, &(eskel_volume_options){.most_voxels = 7}, ESKEL_TOO_LARGE,
		"the grid has 4 x 2 x 1 = 8 voxels, expected at most 7");
	assert_refused(&file, values, 8, &(eskel_volume_options){.most_runs = 3}, ESKEL_TOO_LARGE,
		"the labels have more than 3 runs of voxels");
	assert_refused(&file, values, 8, &(eskel_volume_options){.most_labels = 2}, ESKEL_TOO_LARGE,
		"the volume has more than 2 labels: is it an image rather than a label map?");
}

static void after_a_failure_every_call_repeats_it(void **state)
{
	(void)state;
	const double values[] = {1, 1.5, 0, 0};
	nifti_file file = nifti_file_new(1, false, 16, 4, 1, 1);
	size_t size;
	uint8_t *bytes = nifti_file_write(&file, values, 4, &size);
	eskel_volume *volume;
	eskel_error error;
	const char *sentence = "voxel (1, 0, 0) is 1.5, expected an integer between -2^31 and 2^31";
	assert_int_equal(eskel_volume_new(NULL, &volume), ESKEL_OK);
	assert_int_equal(eskel_volume_feed(volume, bytes, size - 4, NULL), ESKEL_BAD_VALUE);
	assert_int_equal(eskel_volume_feed(volume, bytes + size - 4, 4, &error), ESKEL_BAD_VALUE);
	assert_string_equal(error.text, sentence);
	memset(&error, 0, sizeof error);
	assert_int_equal(eskel_volume_finish(volume, &error), ESKEL_BAD_VALUE);
	assert_string_equal(error.text, sentence);
	assert_int_equal(eskel_volume_label_count(volume), 0);
	eskel_volume_free(volume);
	free(bytes);
}

static void a_finished_volume_takes_no_more_bytes_and_stays_good(void **state)
{
	(void)state;
	const double values[] = {1};
	nifti_file file = nifti_file_new(1, false, 2, 1, 1, 1);
	eskel_volume *volume = decoded(&file, values, 1, NULL);
	assert_int_equal(eskel_volume_feed(volume, "x", 1, NULL), ESKEL_INVALID);
	assert_int_equal(eskel_volume_finish(volume, NULL), ESKEL_OK);
	assert_int_equal(eskel_volume_label_count(volume), 1);
	eskel_volume_free(volume);
}

static void borders_are_told_by_side(void **state)
{
	(void)state;
	double values[5 * 4 * 3] = {0};
	values[1 + 5 * (1 + 4 * 1)] = 1; /* inside */
	values[0 + 5 * (2 + 4 * 1)] = 2; /* x low */
	values[4 + 5 * (2 + 4 * 1)] = 3; /* x high */
	values[2 + 5 * (0 + 4 * 1)] = 4; /* y low */
	values[2 + 5 * (3 + 4 * 1)] = 5; /* y high */
	values[2 + 5 * (1 + 4 * 0)] = 6; /* z low */
	values[0 + 5 * (3 + 4 * 2)] = 7; /* x low, y high, z high */
	const unsigned expected[] = {0, 1, 2, 4, 8, 16, 1 + 8 + 32};
	nifti_file file = nifti_file_new(1, false, 2, 5, 4, 3);
	eskel_volume *volume = decoded(&file, values, 60, NULL);
	unsigned sides = 99;
	for (int32_t label = 1; label <= 7; label++) {
		assert_int_equal(eskel_volume_border(volume, label, &sides), ESKEL_OK);
		assert_int_equal(sides, expected[label - 1]);
	}
	assert_int_equal(eskel_volume_border(volume, 8, &sides), ESKEL_NOT_FOUND);
	eskel_volume_free(volume);
}

static void slices_and_trailing_single_axes_are_volumes(void **state)
{
	(void)state;
	const double values[] = {0, 1, 1, 0, 1, 0};
	nifti_file file = nifti_file_new(1, false, 2, 3, 2, 0);
	file.dim[0] = 2;
	eskel_volume *volume = decoded(&file, values, 6, NULL);
	assert_int_equal(eskel_volume_get_info(volume)->extent[2], 1);
	assert_labels(volume, values, 6);
	eskel_volume_free(volume);
	file = nifti_file_new(1, false, 2, 3, 1, 2);
	file.dim[0] = 7;
	volume = decoded(&file, values, 6, NULL);
	assert_labels(volume, values, 6);
	eskel_volume_free(volume);
}

static void assert_affine(const nifti_file *file, const double expected[3][4], const char *warnings)
{
	const double value = 1;
	eskel_volume *volume = decoded(file, &value, 1, NULL);
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			if (fabs(info->affine.m[r][c] - expected[r][c]) > 1e-6)
				fail_msg("entry %d,%d is %g, expected %g", r, c, info->affine.m[r][c], expected[r][c]);
	char names[200] = "";
	for (size_t i = 0; i < info->warning_count; i++)
		snprintf(names + strlen(names), sizeof names - strlen(names), "%s ",
			eskel_warning_name(info->warnings[i].code));
	assert_string_equal(names, warnings);
	eskel_volume_free(volume);
}

/* A sheared sform and a qform of a quarter turn about z with a reversed third axis. */
static nifti_file file_with_forms(int sform_code, int qform_code)
{
	nifti_file file = nifti_file_new(1, false, 2, 1, 1, 1);
	const double srow[3][4] = {{-2, 0, 0.5, 10}, {0, 3, 0, 20}, {0, 0, 4, 30}};
	memcpy(file.srow, srow, sizeof srow);
	file.sform_code = sform_code;
	file.qform_code = qform_code;
	file.quatern[2] = sqrt(0.5);
	file.pixdim[0] = -1;
	for (int a = 0; a < 3; a++) {
		file.pixdim[a + 1] = a + 1;
		file.qoffset[a] = a + 7;
	}
	return file;
}

static const double from_sform[3][4] = {{-2, 0, 0.5, 10}, {0, 3, 0, 20}, {0, 0, 4, 30}};
static const double from_qform[3][4] = {{0, -2, 0, 7}, {1, 0, 0, 8}, {0, 0, -3, 9}};
static const double from_pixdim[3][4] = {{1, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 3, 0}};

static void sform_goes_before_qform_before_spacing(void **state)
{
	(void)state;
	nifti_file file = file_with_forms(1, 0);
	assert_affine(&file, from_sform, "");
	file = file_with_forms(0, 1);
	assert_affine(&file, from_qform, "");
	file = file_with_forms(2, 1);
	assert_affine(&file, from_sform, "sform_qform_disagree ");
	file = file_with_forms(0, 0);
	assert_affine(&file, from_pixdim, "no_orientation ");
	file.version = 2;
	file.vox_offset = 544;
	file.units = 0;
	assert_affine(&file, from_pixdim, "no_orientation unit_assumed ");
}

static void a_tenth_of_a_voxel_anywhere_in_the_grid_is_a_disagreement(void **state)
{
	(void)state;
	const double values[11] = {1};
	nifti_file file = nifti_file_new(2, false, 2, 11, 1, 1);
	file.qform_code = 1;
	file.srow[0][0] = 1.0099; /* 0.099 of a voxel at the far corner */
	eskel_volume *volume = decoded(&file, values, 11, NULL);
	assert_int_equal(eskel_volume_get_info(volume)->warning_count, 0);
	eskel_volume_free(volume);
	file.srow[0][0] = 1.0101;
	volume = decoded(&file, values, 11, NULL);
	assert_int_equal(eskel_volume_get_info(volume)->warning_count, 1);
	assert_string_equal(eskel_volume_get_info(volume)->warnings[0].text,
		"the sform and the qform place a corner of the grid 0.101 voxels apart; the sform is used");
	eskel_volume_free(volume);
	file.quatern[0] = 2;
	volume = decoded(&file, values, 11, NULL);
	assert_string_equal(
		eskel_volume_get_info(volume)->warnings[0].text, "the qform is unusable; the sform is used");
	eskel_volume_free(volume);
}

static void microns_and_metres_become_millimetres(void **state)
{
	(void)state;
	static const double microns[3][4] = {{-0.002, 0, 0.0005, 0.01}, {0, 0.003, 0, 0.02}, {0, 0, 0.004, 0.03}};
	static const double metres[3][4] = {{-2000, 0, 500, 10000}, {0, 3000, 0, 20000}, {0, 0, 4000, 30000}};
	nifti_file file = file_with_forms(1, 0);
	file.units = 3 + 8; /* with seconds */
	assert_affine(&file, microns, "");
	file.units = 1;
	assert_affine(&file, metres, "");
	file.units = 5;
	assert_affine(&file, from_sform, "unit_assumed ");
}

static uint8_t *read_file(const char *path, size_t *size)
{
	FILE *file = fopen(path, "rb");
	if (!file)
		return NULL;
	uint8_t *bytes = NULL;
	size_t read = 0, capacity = 0;
	for (size_t got = 1; got > 0; read += got) {
		capacity = read + (1 << 16);
		bytes = realloc(bytes, capacity);
		assert_non_null(bytes);
		got = fread(bytes + read, 1, capacity - read, file);
	}
	fclose(file);
	*size = read;
	return bytes;
}

static eskel_status status_named(const char *name)
{
#define STATUS_NAME(code, text) {#code, code},
	static const struct {
		const char *name;
		eskel_status status;
	} names[] = {ESKEL_STATUSES(STATUS_NAME)};
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (strcmp(names[i].name, name) == 0)
			return names[i].status;
	fail_msg("%s is no status", name);
	return ESKEL_OK;
}

/* fixtures/volumes/refusals.txt: file, status and sentence, a tab between them. */
static void every_bad_file_is_refused_in_its_own_words_however_it_is_cut(void **state)
{
	(void)state;
	FILE *table = fopen("fixtures/volumes/refusals.txt", "r");
	char line[512], path[256];
	int rows = 0, files = 0;
	assert_non_null(table);
	while (fgets(line, sizeof line, table)) {
		const char *name = strtok(line, "\t"), *status = strtok(NULL, "\t"), *sentence = strtok(NULL, "\n");
		assert_non_null(sentence);
		snprintf(path, sizeof path, "fixtures/volumes/%s", name);
		size_t size;
		uint8_t *bytes = read_file(path, &size);
		if (!bytes)
			fail_msg("%s cannot be read", path);
		for (int pieces = -1; pieces <= 1; pieces++) {
			eskel_error error = {0};
			eskel_volume *volume = NULL;
			eskel_status got = decode(bytes, size, pieces, NULL, &volume, &error);
			if (got != status_named(status) || error.status != got || strcmp(error.text, sentence) != 0)
				fail_msg("%s: %s\n%s\n%s", name, eskel_status_text(got), error.text, sentence);
		}
		free(bytes);
		rows++;
	}
	fclose(table);
	DIR *folder = opendir("fixtures/volumes");
	assert_non_null(folder);
	for (struct dirent *entry; (entry = readdir(folder));)
		files += entry->d_name[0] != '.';
	closedir(folder);
	assert_int_equal(files, rows + 2); /* the table, and what writes it and the files */
}

static eskel_cloud *cloud_of_file(const char *path)
{
	size_t size;
	uint8_t *bytes = read_file(path, &size);
	if (!bytes)
		return NULL;
	eskel_volume *volume;
	eskel_error error;
	if (decode(bytes, size, random_pieces, NULL, &volume, &error) != ESKEL_OK)
		fail_msg("%s: %s", path, error.text);
	free(bytes);
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_volume_cloud(volume, eskel_volume_label(volume, 0), &cloud, NULL), ESKEL_OK);
	eskel_volume_free(volume);
	return cloud;
}

static void one_bone_in_six_files_is_one_cloud(void **state)
{
	(void)state;
	static const char *const variants[] = {"RAS", "LAS", "LPS", "PIR", "ASL", "label300_uint16"};
	uint8_t *expected = NULL;
	size_t expected_size = 0;
	for (size_t i = 0; i < sizeof variants / sizeof variants[0]; i++) {
		char path[256];
		snprintf(path, sizeof path, "../shared/data/io_variants/VHF_talus_L_%s.nii.gz", variants[i]);
		eskel_cloud *cloud = cloud_of_file(path);
		if (!cloud) {
			print_message("skipped: %s is absent\n", path);
			skip();
		}
		uint8_t *bytes = NULL;
		size_t size = 0;
		assert_int_equal(eskel_cloud_encode(cloud, &bytes, &size), ESKEL_OK);
		eskel_cloud_free(cloud);
		if (!expected) {
			expected = bytes;
			expected_size = size;
			continue;
		}
		assert_int_equal(size, expected_size);
		assert_memory_equal(bytes, expected, size);
		free(bytes);
	}
	eskel_cloud *mirrored = cloud_of_file("../shared/data/io_variants/VHF_talus_L_MIRRORED_x.nii.gz");
	uint8_t *bytes = NULL;
	size_t size = 0;
	assert_non_null(mirrored);
	assert_int_equal(eskel_cloud_encode(mirrored, &bytes, &size), ESKEL_OK);
	assert_true(size != expected_size || memcmp(bytes, expected, size) != 0);
	free(bytes);
	free(expected);
	eskel_cloud_free(mirrored);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_datatype_byte_order_and_version_gives_the_same_labels),
		cmocka_unit_test(labels_are_listed_ascending),
		cmocka_unit_test(a_gzipped_file_gives_the_same_labels),
		cmocka_unit_test(gzip_members_are_joined),
		cmocka_unit_test(any_cut_of_a_file_gives_the_same_clouds),
		cmocka_unit_test(minus_zero_is_background_and_equal_labels_make_one_run),
		cmocka_unit_test(scaled_values_are_labels),
		cmocka_unit_test(only_wanted_labels_are_kept),
		cmocka_unit_test(limits_are_kept_exactly),
		cmocka_unit_test(after_a_failure_every_call_repeats_it),
		cmocka_unit_test(a_finished_volume_takes_no_more_bytes_and_stays_good),
		cmocka_unit_test(borders_are_told_by_side),
		cmocka_unit_test(slices_and_trailing_single_axes_are_volumes),
		cmocka_unit_test(sform_goes_before_qform_before_spacing),
		cmocka_unit_test(a_tenth_of_a_voxel_anywhere_in_the_grid_is_a_disagreement),
		cmocka_unit_test(microns_and_metres_become_millimetres),
		cmocka_unit_test(every_bad_file_is_refused_in_its_own_words_however_it_is_cut),
		cmocka_unit_test(one_bone_in_six_files_is_one_cloud),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
