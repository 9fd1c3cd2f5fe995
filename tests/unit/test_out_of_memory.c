/* Lets the nth allocation of the engine fail, for n = 1, 2, 3 ... until there are no more. Each time the status must be
 * ESKEL_NO_MEMORY, the outputs untouched and, as a sanitizer sees, nothing leaked. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "failing_allocations.h"
#include "nifti_file.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* From a cloud to its skeleton, its encoding, the skeleton decoded from that, and its position signature. */
static eskel_status run_skeleton(const eskel_cloud *cloud, eskel_error *error)
{
	eskel_skeleton *skeleton = NULL, *again = NULL;
	eskel_position_signature *positions = NULL;
	uint8_t *encoded = NULL;
	size_t encoded_size = 0;
	const eskel_skeleton_options options = {.levels = 3, .coarse_start = true};
	eskel_status status = eskel_skeleton_new(cloud, &options, &skeleton, error);
	assert_int_equal(status != ESKEL_OK, skeleton == NULL);
	if (status == ESKEL_OK)
		status = eskel_skeleton_encode(skeleton, &encoded, &encoded_size);
	if (status == ESKEL_OK)
		status = eskel_skeleton_decode(encoded, encoded_size, &again, error);
	assert_int_equal(status != ESKEL_OK, again == NULL);
	if (status == ESKEL_OK) {
		status = eskel_position_signature_new(again, &positions);
		assert_int_equal(status != ESKEL_OK, positions == NULL);
		error->status = ESKEL_NO_MEMORY; /* it has no error of its own */
	}
	free(encoded);
	eskel_position_signature_free(positions);
	eskel_skeleton_free(again);
	eskel_skeleton_free(skeleton);
	return status;
}

/* Of the same cloud twice. */
static eskel_status run_skeletons(const eskel_cloud *cloud, eskel_error *error)
{
	const eskel_cloud *const clouds[2] = {cloud, cloud};
	eskel_skeleton *skeletons[2] = {NULL, NULL};
	eskel_status status = eskel_skeletons_new(clouds, 2, &(eskel_skeleton_options){.levels = 2}, skeletons, error);
	for (int i = 0; i < 2; i++) {
		assert_int_equal(status != ESKEL_OK, skeletons[i] == NULL);
		eskel_skeleton_free(skeletons[i]);
	}
	return status;
}

static eskel_status run_components(const eskel_cloud *cloud, eskel_error *error)
{
	eskel_components *components = NULL, *cavities = NULL;
	eskel_status status = eskel_cloud_components(cloud, &components);
	assert_int_equal(status != ESKEL_OK, components == NULL);
	if (status == ESKEL_OK) {
		status = eskel_cloud_cavities(cloud, &cavities);
		assert_int_equal(status != ESKEL_OK, cavities == NULL);
	}
	eskel_components_free(components);
	eskel_components_free(cavities);
	error->status = ESKEL_NO_MEMORY; /* these have no error of their own */
	return status;
}

/* From the bytes of a file to a cloud, its encoding, and the cloud decoded from that; and to a skeleton. */
static eskel_status run_pipeline(const uint8_t *bytes, size_t size, eskel_error *error)
{
	eskel_volume *volume = NULL;
	eskel_cloud *cloud = NULL, *again = NULL;
	uint8_t *encoded = NULL;
	size_t encoded_size = 0;
	const int32_t wanted[] = {2, 1};
	eskel_status status = eskel_volume_new(&(eskel_volume_options){.labels = wanted, .label_count = 2}, &volume);
	if (status == ESKEL_OK)
		status = eskel_volume_feed(volume, bytes, size, error);
	if (status == ESKEL_OK)
		status = eskel_volume_finish(volume, error);
	if (status == ESKEL_OK)
		status = eskel_volume_cloud(volume, 1, &cloud, error);
	if (status == ESKEL_OK)
		status = eskel_cloud_encode(cloud, &encoded, &encoded_size);
	if (status == ESKEL_OK)
		status = eskel_cloud_decode(encoded, encoded_size, &again, error);
	assert_int_equal(status != ESKEL_OK, again == NULL);
	if (status == ESKEL_OK)
		status = run_skeleton(again, error);
	if (status == ESKEL_OK)
		status = run_skeletons(again, error);
	if (status == ESKEL_OK)
		status = run_components(again, error);
	free(encoded);
	eskel_cloud_free(again);
	eskel_cloud_free(cloud);
	eskel_volume_free(volume);
	return status;
}

static void assert_failures_are_reported(const uint8_t *bytes, size_t size)
{
	int failures = 0;
	for (bool failed = true; failed && failures < 1000; failures++) {
		eskel_error error = {ESKEL_NO_MEMORY, ""};
		failing_allocations_begin(failures);
		eskel_status status = run_pipeline(bytes, size, &error);
		failed = failing_allocations_end();
		/* A failure to give memory back, when a buffer shrinks, does no harm. */
		if (status != ESKEL_OK && (!failed || status != ESKEL_NO_MEMORY || error.status != ESKEL_NO_MEMORY))
			fail_msg("allocation %d: %s (%s)", failures, eskel_status_text(status), error.text);
	}
	assert_in_range(failures, 15, 999);
}

static void every_failed_allocation_is_reported_and_leaks_nothing(void **state)
{
	(void)state;
	/* The axes are stored y, x, z, so that the runs change their axis. */
	nifti_file file = nifti_file_new(1, false, 4, 8, 6, 5);
	for (int r = 0; r < 2; r++)
		for (int c = 0; c < 2; c++)
			file.srow[r][c] = r != c;
	double values[8 * 6 * 5];
	for (int i = 0; i < 240; i++)
		values[i] = i % 7 % 3;
	size_t size, gzip_size;
	uint8_t *bytes = nifti_file_write(&file, values, 240, &size);
	uint8_t *gzipped = nifti_file_gzip(bytes, size, &gzip_size);
	assert_failures_are_reported(gzipped, gzip_size);
	free(gzipped);
	free(bytes);
}

static void so_is_each_in_a_file_of_layers(void **state)
{
	(void)state;
	static const char header[] = "NRRD0004\ntype: uint8\nencoding: gzip\ndimension: 4\nsizes: 2 8 6 5\nspace: LPS\n"
				     "space directions: none (1,0,0) (0,1,0) (0,0,1)\n"
				     "Segment0_Name:=a\nSegment1_Name:=b\n\n";
	enum { header_size = sizeof header - 1 };
	uint8_t voxels[2 * 8 * 6 * 5], file[2000];
	for (int i = 0; i < 480; i++)
		voxels[i] = i % 7 == 1;
	size_t size;
	uint8_t *gzipped = nifti_file_gzip(voxels, sizeof voxels, &size);
	assert_true(header_size + size <= sizeof file);
	memcpy(file, header, header_size);
	memcpy(file + header_size, gzipped, size);
	assert_failures_are_reported(file, header_size + size);
	free(gzipped);
}

static void so_is_each_that_a_metaimage_needs(void **state)
{
	(void)state;
	static const char header[] = "NDims = 3\nDimSize = 8 6 5\nElementType = MET_UCHAR\nCompressedData = True\n"
				     "ElementDataFile = LOCAL\n";
	uint8_t voxels[240], file[1000];
	uLongf stream_size = sizeof file - sizeof header;
	for (int i = 0; i < 240; i++)
		voxels[i] = (uint8_t)(i % 7 % 3);
	memcpy(file, header, sizeof header - 1);
	assert_int_equal(compress(file + sizeof header - 1, &stream_size, voxels, sizeof voxels), Z_OK);
	assert_failures_are_reported(file, sizeof header - 1 + stream_size);
}

static void so_is_each_that_names_in_a_header_extension_need(void **state)
{
	(void)state;
	static const char xml[] =
		"<CaretExtension><LabelTable><Label Key=\"1\">a</Label><Label Key=\"2\">b</Label></LabelTable>";
	enum { extension_size = 128 };
	nifti_file file = nifti_file_new(1, false, 2, 8, 6, 5);
	file.vox_offset += extension_size;
	double values[240];
	for (int i = 0; i < 240; i++)
		values[i] = i % 7 % 3;
	size_t size;
	uint8_t *bytes = nifti_file_write(&file, values, 240, &size);
	bytes[348] = 1;
	bytes[352] = extension_size;
	memcpy(bytes + 360, xml, sizeof xml);
	assert_failures_are_reported(bytes, size);
	free(bytes);
}

/* Without a colour table, so that the name of label 2 is FreeSurfer's. */
static void so_is_each_that_an_mgh_file_needs(void **state)
{
	(void)state;
	uint8_t file[284 + 240 + 20] = {[3] = 1, [7] = 8, [11] = 6, [15] = 5, [19] = 1};
	for (int i = 0; i < 240; i++)
		file[284 + i] = (uint8_t)(i % 7 % 3);
	assert_failures_are_reported(file, sizeof file);
}

static void so_is_each_that_a_mesh_needs(void **state)
{
	(void)state;
	static const char mesh[] = "v 0 0 0\nv 9 0 0\nv 0 8 0\nv 0 0 7\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
	assert_failures_are_reported((const uint8_t *)mesh, sizeof mesh - 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_failed_allocation_is_reported_and_leaks_nothing),
		cmocka_unit_test(so_is_each_in_a_file_of_layers),
		cmocka_unit_test(so_is_each_that_a_metaimage_needs),
		cmocka_unit_test(so_is_each_that_names_in_a_header_extension_need),
		cmocka_unit_test(so_is_each_that_an_mgh_file_needs),
		cmocka_unit_test(so_is_each_that_a_mesh_needs),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
