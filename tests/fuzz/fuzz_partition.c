/* Any bytes as a small cloud: in its skeleton every class must hold the voxels that are nearest to its centre, and its
 * encoding must be decoded. */
#include "eskel.h"
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double squared_distance(const eskel_affine *a, const uint16_t voxel[3], const double centre[3])
{
	double sum = 0;
	for (int r = 0; r < 3; r++) {
		double d =
			a->m[r][0] * voxel[0] + a->m[r][1] * voxel[1] + a->m[r][2] * voxel[2] + a->m[r][3] - centre[r];
		sum += d * d;
	}
	return sum;
}

/* Counts the voxels that only one class can hold, and those that each can: distances of equal length but for rounding
 * leave it open. */
static void expect_nearest(const eskel_cloud *cloud, const eskel_skeleton *s, uint32_t k)
{
	uint64_t certain[ESKEL_LEVELS_MAX] = {0}, possible[ESKEL_LEVELS_MAX] = {0};
	double size = 1e-9;
	for (int r = 0; r < 3; r++)
		size += 4 * s->nodes[0].covariance[r][r];
	for (size_t i = 0; i < cloud->run_count; i++)
		for (unsigned x = cloud->runs[i].x_first; x <= cloud->runs[i].x_last; x++) {
			const uint16_t voxel[3] = {(uint16_t)x, cloud->runs[i].y, cloud->runs[i].z};
			double squared[ESKEL_LEVELS_MAX], least = INFINITY;
			for (uint32_t c = 0; c < k; c++) {
				squared[c] =
					squared_distance(&cloud->affine, voxel, eskel_skeleton_node(s, k, c)->centre);
				least = fmin(least, squared[c]);
			}
			uint32_t near = 0, last = 0;
			for (uint32_t c = 0; c < k; c++)
				if (squared[c] <= least + 1e-4 * size) {
					possible[c]++;
					near++;
					last = c;
				}
			certain[last] += near == 1;
		}
	for (uint32_t c = 0; c < k; c++) {
		uint64_t voxels = eskel_skeleton_node(s, k, c)->voxels;
		if (voxels < 1 || voxels < certain[c] || voxels > possible[c])
			abort();
	}
}

static void make_skeleton(const eskel_cloud *cloud, const eskel_skeleton_options *options)
{
	eskel_skeleton *skeleton = NULL, *decoded = NULL;
	uint8_t *bytes = NULL;
	size_t size = 0;
	if (eskel_skeleton_new(cloud, options, &skeleton, NULL) != ESKEL_OK ||
		eskel_skeleton_encode(skeleton, &bytes, &size) != ESKEL_OK ||
		eskel_skeleton_decode(bytes, size, &decoded, NULL) != ESKEL_OK)
		abort();
	if (memcmp(decoded->nodes, skeleton->nodes, ESKEL_NODES(skeleton->level_count) * sizeof *skeleton->nodes) != 0)
		abort();
	for (uint32_t k = 1; k <= skeleton->level_count && options->metric == ESKEL_PARTITION_EUCLIDEAN; k++)
		expect_nearest(cloud, skeleton, k);
	free(bytes);
	eskel_skeleton_free(skeleton);
	eskel_skeleton_free(decoded);
}

/* A byte of options, 9 of affine in sixteenths, then 5 bytes a run. */
static void make_cloud(const uint8_t *data, size_t size)
{
	enum { affine_size = 9, run_size = 5, most_runs = 60 };
	eskel_run runs[most_runs];
	uint32_t weights[most_runs];
	eskel_affine affine = {{{0}}};
	size_t count = 0;
	if (size < 1 + affine_size)
		return;
	for (int i = 0; i < affine_size; i++)
		affine.m[i / 3][i % 3] = (int8_t)data[1 + i] / 16.0;
	for (size_t at = 1 + affine_size; at + run_size <= size && count < most_runs; at += run_size, count++) {
		const uint8_t *b = data + at;
		runs[count] = (eskel_run){b[0] % 32, (uint16_t)(b[0] % 32 + b[1] % 16), b[2] % 16, b[3] % 16};
		weights[count] = 1u + b[4];
	}
	eskel_cloud *cloud = NULL;
	if (eskel_cloud_new(runs, data[0] & 1 ? weights : NULL, count, &affine, &cloud, NULL) != ESKEL_OK)
		return;
	const eskel_skeleton_options options = {
		.levels = data[0] & 8 ? 64 : 7,
		.metric = data[0] & 2 ? ESKEL_PARTITION_MAHALANOBIS : ESKEL_PARTITION_EUCLIDEAN,
		.coarse_start = (data[0] & 4) != 0,
	};
	make_skeleton(cloud, &options);
	eskel_cloud_free(cloud);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	make_cloud(data, size);
	return 0;
}
