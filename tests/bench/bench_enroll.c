/* Where the time of an enrollment goes: bench_enroll [DATABASE, default bench_enroll.db, removed afterwards]
 *
 * A femur-like shape of 150,000 voxels, from the bytes of a gzipped volume to rows on disk; each stage the least of a
 * few runs. The store's stage is one durable transaction, so it is as fast as the disk's fsync. */
#include "eskel_store.h"
#include "measure.h"
#include "nifti_file.h"
#include "shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { REPEATS = 7, UINT8 = 2 };

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "%s\n", what);
	exit(1);
}

static uint8_t *gzipped_volume(const eskel_cloud *cloud, size_t *size)
{
	const size_t row = cloud->extent[0], slice = row * cloud->extent[1], voxels = slice * cloud->extent[2];
	double *values = calloc(voxels, sizeof *values);
	require(values != NULL, "memory ran out");
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *r = &cloud->runs[i];
		for (unsigned x = r->x_first; x <= r->x_last; x++)
			values[r->z * slice + r->y * row + x] = 1;
	}
	const nifti_file file = nifti_file_new(1, false, UINT8, cloud->extent[0], cloud->extent[1], cloud->extent[2]);
	size_t plain_size = 0;
	uint8_t *plain = nifti_file_write(&file, values, voxels, &plain_size);
	uint8_t *gzip = nifti_file_gzip(plain, plain_size, size);
	free(plain);
	free(values);
	return gzip;
}

static eskel_cloud *decode(const uint8_t *bytes, size_t size)
{
	eskel_volume *volume = NULL;
	eskel_cloud *cloud = NULL;
	require(!eskel_volume_new(NULL, &volume) && !eskel_volume_feed(volume, bytes, size, NULL) &&
			!eskel_volume_finish(volume, NULL) && !eskel_volume_cloud(volume, 1, &cloud, NULL),
		"the volume was not decoded");
	eskel_volume_free(volume);
	return cloud;
}

typedef enum { DECODE, SKELETON, SIGNATURE, STORE, STAGES } stage;
static const char *const names[STAGES] = {"- volume to cloud", "- skeleton", "- signature", "- store, on disk"};

/* One enrollment; each stage's milliseconds into least where they are less. */
static void enroll(const uint8_t *bytes, size_t size, uint32_t levels, eskel_store *store, double least[STAGES])
{
	const eskel_description description = {.age = NAN};
	double at[STAGES + 1];
	eskel_skeleton *skeleton = NULL;
	eskel_signature *signature = NULL;
	eskel_shape shape;
	bool created = false;

	at[DECODE] = measure_milliseconds();
	eskel_cloud *cloud = decode(bytes, size);
	at[SKELETON] = measure_milliseconds();
	require(!eskel_skeleton_new(cloud, &(eskel_skeleton_options){.levels = levels}, &skeleton, NULL),
		"no skeleton");
	at[SIGNATURE] = measure_milliseconds();
	require(!eskel_signature_new(skeleton, &signature), "no signature");
	at[STORE] = measure_milliseconds();
	const eskel_enrollment enrollment = {
		.cloud = cloud, .skeleton = skeleton, .signature = signature, .description = &description, .label = 1};
	require(!eskel_store_enroll(store, NULL, &enrollment, 1, &shape, &created, NULL) && created,
		"nothing was stored");
	at[STAGES] = measure_milliseconds();

	for (stage s = 0; s < STAGES; s++)
		least[s] = fmin(least[s], at[s + 1] - at[s]);
	require(!eskel_store_delete(store, NULL, shape.id, 0, NULL, NULL), "the shape was not deleted");
	eskel_shape_clear(&shape);
	eskel_signature_free(signature);
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
}

static void report(const uint8_t *bytes, size_t size, uint32_t levels, eskel_store *store)
{
	double least[STAGES] = {INFINITY, INFINITY, INFINITY, INFINITY}, sum = 0;
	for (int i = 0; i < REPEATS; i++)
		enroll(bytes, size, levels, store, least);
	char figure[32];
	snprintf(figure, sizeof figure, "enroll/levels=%u", levels);
	for (stage s = 0; s < STAGES; s++)
		sum += least[s];
	measure_print(figure, "eskel, all stages", sum, "ms");
	for (stage s = 0; s < STAGES; s++)
		measure_print(figure, names[s], least[s], "ms");
}

static void remove_database(const char *path)
{
	static const char *const endings[] = {"", "-wal", "-shm", "-lock"};
	char name[4096];
	for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
		snprintf(name, sizeof name, "%s%s", path, endings[i]);
		unlink(name);
	}
}

int main(int argc, char **argv)
{
	const char *path = argc > 1 ? argv[1] : "bench_enroll.db";
	eskel_store *store = NULL;
	eskel_store_error error;
	require(access(path, F_OK) != 0, "the database is there already: name a new file");
	if (eskel_store_open(path, NULL, &store, &error) != ESKEL_STORE_OK)
		require(false, error.text);
	eskel_cloud *femur = shapes_cloud(&shapes_femur, &shapes_identity);
	size_t size = 0;
	uint8_t *bytes = gzipped_volume(femur, &size);
	eskel_cloud_free(femur);
	report(bytes, size, 10, store);
	report(bytes, size, 16, store);
	free(bytes);
	eskel_store_close(store);
	remove_database(path);
	return 0;
}
