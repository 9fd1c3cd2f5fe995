/* Writes what the benchmarks read, ours and the peers' alike, the same on every run:
 *
 *	bench_inputs shapes FOLDER    hamate, femur, large and the hamate's formula from 20,000 to 20,000,000 voxels
 *	bench_inputs costs FOLDER     matrices of matching costs: classes-K of shapes, uniform-K at random
 *	bench_inputs maps FOLDER      two gzipped label maps of the size of a whole-body scan
 *	bench_inputs posts FOLDER     4,000 different shapes of about 20,000 voxels to be enrolled, as files */
#include "distance.h"
#include "nifti_file.h"
#include "shapes.h"
#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { UINT8 = 2, UINT16 = 512 };

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "bench_inputs: %s\n", what);
	exit(1);
}

static void *allocate(size_t count, size_t size)
{
	void *bytes = calloc(count, size);
	require(bytes != NULL, "memory ran out");
	return bytes;
}

/* ---- volumes, written slice by slice */

static gzFile begin_volume(const char *folder, const char *name, const nifti_file *header)
{
	char path[4096];
	size_t size = 0;
	snprintf(path, sizeof path, "%s/%s.nii.gz", folder, name);
	gzFile file = gzopen(path, "wb6");
	uint8_t *bytes = nifti_file_write(header, NULL, 0, &size);
	require(file && gzwrite(file, bytes, (unsigned)size) == (int)size, path);
	free(bytes);
	return file;
}

static void write_cloud(const char *folder, const char *name, const eskel_cloud *cloud, double offset)
{
	nifti_file header = nifti_file_new(1, false, UINT8, cloud->extent[0], cloud->extent[1], cloud->extent[2]);
	header.srow[0][3] = offset;
	gzFile file = begin_volume(folder, name, &header);
	const size_t row = cloud->extent[0], slice = row * cloud->extent[1];
	uint8_t *values = allocate(slice, 1);
	const eskel_run *run = cloud->runs, *end = run + cloud->run_count;
	for (unsigned z = 0; z < cloud->extent[2]; z++) {
		memset(values, 0, slice);
		for (; run < end && run->z == z; run++)
			memset(values + run->y * row + run->x_first, 1, run->x_last - run->x_first + 1u);
		require(gzwrite(file, values, (unsigned)slice) == (int)slice, "a volume was not written");
	}
	require(gzclose(file) == Z_OK, "a volume was not written");
	free(values);
}

static void write_shapes(const char *folder)
{
	static const struct {
		const char *name;
		const shapes_solid *like;
		double scale; /* 0: as it is */
	} shapes[] = {
		{"hamate", &shapes_hamate, 0},
		{"femur", &shapes_femur, 0},
		{"large", &shapes_large, 0},
		{"voxels=20000", &shapes_large, 0.967},
		{"voxels=200000", &shapes_large, 2.083},
		{"voxels=2000000", &shapes_large, 4.487},
		{"voxels=20000000", &shapes_large, 9.667},
	};
	for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
		shapes_solid solid = *shapes[i].like;
		solid.scale = shapes[i].scale > 0 ? shapes[i].scale : solid.scale;
		eskel_cloud *cloud = shapes_cloud(&solid, &shapes_identity);
		write_cloud(folder, shapes[i].name, cloud, 0);
		eskel_cloud_free(cloud);
	}
}

/* A hamate whose parts are moved a little is another shape; the same one elsewhere in the world is another object, so
 * it is stored on its own. */
static void write_posts(const char *folder)
{
	enum { SHAPES = 100, PLACES = 40, RODS = 8 };
	uint64_t random = 1;
	for (int s = 0; s < SHAPES; s++) {
		shapes_rod rods[RODS];
		shapes_solid solid = shapes_hamate;
		require(solid.count <= RODS, "the hamate has more rods than foreseen");
		memcpy(rods, solid.rods, solid.count * sizeof *rods);
		for (size_t r = 0; r < solid.count; r++)
			for (int axis = 0; axis < 3; axis++)
				rods[r].to[axis] += 4 * synthetic_uniform(&random) - 2;
		solid.rods = rods;
		solid.scale = 0.967;
		eskel_cloud *cloud = shapes_cloud(&solid, &shapes_identity);
		for (int place = 0; place < PLACES; place++) {
			char name[32];
			snprintf(name, sizeof name, "post-%d", place * SHAPES + s);
			write_cloud(folder, name, cloud, place);
		}
		eskel_cloud_free(cloud);
	}
}

/* ---- label maps */

typedef struct {
	double centre[3], radius[3];
	uint16_t label;
} ellipsoid;

/* The ellipsoid's part of a slice, row by row; its ends lie up to a voxel off, as segmentations are rough. */
static void draw_slice(const ellipsoid *e, const size_t size[3], size_t z, uint64_t *random, uint16_t *slice)
{
	const double dz = ((double)z - e->centre[2]) / e->radius[2];
	for (size_t y = 0; y < size[1]; y++) {
		const double dy = ((double)y - e->centre[1]) / e->radius[1], rest = 1 - dy * dy - dz * dz;
		if (rest <= 0)
			continue;
		const double half = e->radius[0] * sqrt(rest);
		const double first = e->centre[0] - half + 2 * synthetic_uniform(random) - 1;
		const double last = e->centre[0] + half + 2 * synthetic_uniform(random) - 1;
		for (size_t x = (size_t)fmax(first, 0); (double)x <= last && x < size[0]; x++)
			slice[y * size[0] + x] = e->label;
	}
}

static void write_map(const char *folder, const char *name, int datatype, size_t depth, size_t count)
{
	const size_t size[3] = {512, 512, depth}, slice_size = size[0] * size[1];
	const size_t bytes = slice_size * (datatype == UINT8 ? 1 : 2);
	ellipsoid *parts = allocate(count, sizeof *parts);
	uint16_t *slice = allocate(slice_size, sizeof *slice);
	uint8_t *narrow = allocate(slice_size, 1);
	uint64_t random = count;
	for (size_t i = 0; i < count; i++) {
		parts[i].label = (uint16_t)(i + 1);
		for (int axis = 0; axis < 3; axis++) {
			parts[i].centre[axis] = (double)size[axis] * (0.15 + 0.7 * synthetic_uniform(&random));
			parts[i].radius[axis] = 8 + 40 * synthetic_uniform(&random);
		}
	}
	const nifti_file header = nifti_file_new(1, false, datatype, (int)size[0], (int)size[1], (int)size[2]);
	gzFile file = begin_volume(folder, name, &header);
	for (size_t z = 0; z < depth; z++) {
		memset(slice, 0, slice_size * sizeof *slice);
		for (size_t i = 0; i < count; i++)
			draw_slice(&parts[i], size, z, &random, slice);
		for (size_t v = 0; v < slice_size; v++)
			narrow[v] = (uint8_t)slice[v];
		const void *values = datatype == UINT8 ? (const void *)narrow : slice;
		require(gzwrite(file, values, (unsigned)bytes) == (int)bytes, "a map was not written");
	}
	require(gzclose(file) == Z_OK, "a map was not written");
	free(parts);
	free(slice);
	free(narrow);
}

/* ---- costs */

enum { MATRICES = 64 };

static void write_floats(const char *folder, const char *name, uint32_t k, const float *costs)
{
	char path[4096];
	const size_t count = (size_t)MATRICES * k * k;
	snprintf(path, sizeof path, "%s/%s-%u", folder, name, k);
	FILE *file = fopen(path, "wb");
	require(file && fwrite(costs, sizeof *costs, count, file) == count && fclose(file) == 0, path);
}

/* Manhattan distances between the classes of two shapes, in the log signature. */
static void class_costs(const esk_query *a, const esk_query *b, uint32_t k, float *costs)
{
	const float *rows = a->rows[k - 1], *columns = b->rows[k - 1];
	for (uint32_t i = 0; i < k; i++)
		for (uint32_t j = 0; j < k; j++) {
			float cost = 0;
			for (uint32_t c = 0; c < ESKEL_SIGNATURE_NUMBERS; c++)
				cost += fabsf(rows[c * k + i] - columns[c * k + j]);
			costs[i * k + j] = cost;
		}
}

static void write_costs(const char *folder)
{
	static const uint32_t levels[] = {4, 10, 16, 32, 64};
	static float costs[MATRICES * ESKEL_LEVELS_MAX * ESKEL_LEVELS_MAX];
	static esk_query queries[MATRICES];
	esk_shape *shapes[MATRICES] = {NULL};
	uint64_t random = 1;
	for (uint32_t n = 0; n < MATRICES; n++) {
		eskel_signature *signature = synthetic_signature(n / 4, n, 0.3, ESKEL_LEVELS_MAX);
		require(!esk_shape_new(signature, &shapes[n]) && !esk_query_init(&queries[n], shapes[n], NULL),
			"no costs");
		eskel_signature_free(signature);
	}
	for (size_t l = 0; l < sizeof levels / sizeof *levels; l++) {
		const uint32_t k = levels[l];
		for (uint32_t n = 0; n < MATRICES; n++)
			class_costs(&queries[n], &queries[(n * 7 + 5) % MATRICES], k, costs + n * k * k);
		write_floats(folder, "classes", k, costs);
		for (size_t i = 0; i < (size_t)MATRICES * k * k; i++)
			costs[i] = (float)synthetic_uniform(&random);
		write_floats(folder, "uniform", k, costs);
	}
	for (uint32_t n = 0; n < MATRICES; n++) {
		esk_query_clear(&queries[n]);
		esk_shape_release(shapes[n]);
	}
}

int main(int argc, char **argv)
{
	require(argc == 3, "usage: bench_inputs shapes|costs|maps|posts FOLDER");
	const char *what = argv[1], *folder = argv[2];
	if (!strcmp(what, "shapes")) {
		write_shapes(folder);
	} else if (!strcmp(what, "costs")) {
		write_costs(folder);
	} else if (!strcmp(what, "maps")) {
		write_map(folder, "uint8", UINT8, 300, 100);
		write_map(folder, "uint16", UINT16, 1000, 400);
	} else if (!strcmp(what, "posts")) {
		write_posts(folder);
	} else {
		require(false, "expected shapes, costs, maps or posts");
	}
	return 0;
}
