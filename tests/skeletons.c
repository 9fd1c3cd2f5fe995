#include "skeletons.h"

#include "eigen.h"
#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t count, size_t size)
{
	void *memory = calloc(count, size);
	if (!memory) {
		fprintf(stderr, "memory ran out\n");
		exit(1);
	}
	return memory;
}

static double between(uint64_t *random, double low, double high)
{
	return low + (high - low) * synthetic_uniform(random);
}

void skeletons_rotation(uint64_t *random, double rotation[3][3])
{
	double q[4], square = 2;
	while (square > 1 || square < 0.01) {
		square = 0;
		for (int i = 0; i < 4; i++) {
			q[i] = between(random, -1, 1);
			square += q[i] * q[i];
		}
	}
	for (int i = 0; i < 4; i++)
		q[i] /= sqrt(square);
	double w = q[0], x = q[1], y = q[2], z = q[3];
	const double out[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
		{2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
		{2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
	memcpy(rotation, out, sizeof out);
}

void skeletons_scatter(uint64_t seed, skeletons_blob *blobs, size_t count)
{
	const double half_box[3] = {30, 20, 12.5};
	for (size_t b = 0; b < count; b++) {
		double rotation[3][3], variance[3];
		skeletons_rotation(&seed, rotation);
		blobs[b].weight = between(&seed, 100, 300);
		for (int i = 0; i < 3; i++) {
			blobs[b].centre[i] = between(&seed, -half_box[i], half_box[i]);
			variance[i] = between(&seed, 1, 30);
		}
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				blobs[b].covariance[r][c] = rotation[r][0] * variance[0] * rotation[c][0] +
							    rotation[r][1] * variance[1] * rotation[c][1] +
							    rotation[r][2] * variance[2] * rotation[c][2];
	}
}

static void product(const double a[3][3], const double b[3][3], double out[3][3])
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			out[r][c] = a[r][0] * b[0][c] + a[r][1] * b[1][c] + a[r][2] * b[2][c];
}

void skeletons_move(const double linear[3][3], const double offset[3], skeletons_blob *blobs, size_t count)
{
	double transposed[3][3], half[3][3], centre[3];
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			transposed[r][c] = linear[c][r];
	for (size_t b = 0; b < count; b++) {
		for (int r = 0; r < 3; r++)
			centre[r] = linear[r][0] * blobs[b].centre[0] + linear[r][1] * blobs[b].centre[1] +
				    linear[r][2] * blobs[b].centre[2] + offset[r];
		memcpy(blobs[b].centre, centre, sizeof centre);
		product(linear, (const double(*)[3])blobs[b].covariance, half);
		product((const double(*)[3])half, (const double(*)[3])transposed, blobs[b].covariance);
	}
}

void skeletons_disturb(uint64_t seed, double noise, skeletons_blob *blobs, size_t count)
{
	for (size_t b = 0; b < count; b++)
		for (int i = 0; i < 3; i++)
			blobs[b].centre[i] += between(&seed, -noise, noise);
}

static void merge(const skeletons_blob *blobs, size_t count, size_t first, size_t step, eskel_node *node)
{
	for (size_t b = first; b < count; b += step) {
		node->weight += blobs[b].weight;
		for (int i = 0; i < 3; i++)
			node->centre[i] += blobs[b].weight * blobs[b].centre[i];
	}
	for (int i = 0; i < 3; i++)
		node->centre[i] /= node->weight;
	for (size_t b = first; b < count; b += step)
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				node->covariance[r][c] +=
					blobs[b].weight / node->weight *
					(blobs[b].covariance[r][c] + (blobs[b].centre[r] - node->centre[r]) *
									     (blobs[b].centre[c] - node->centre[c]));
	node->voxels = (uint64_t)node->weight;
}

static void complete(eskel_node *node, const eskel_node *whole)
{
	esk_eigen eigen;
	if (esk_eigen_symmetric((const double(*)[3])node->covariance, &eigen)) {
		fprintf(stderr, "a blob's covariance is not finite\n");
		exit(1);
	}
	memcpy(node->eigenvalues, eigen.values, sizeof eigen.values);
	memcpy(node->axes, eigen.axes, sizeof eigen.axes);
	double square = 0;
	for (int i = 0; i < 3; i++)
		square += (node->centre[i] - whole->centre[i]) * (node->centre[i] - whole->centre[i]);
	node->rho = sqrt(square);
}

eskel_skeleton *skeletons_new(const skeletons_blob *blobs, size_t count, uint32_t levels, double voxel_volume)
{
	eskel_skeleton *skeleton = allocate(1, sizeof *skeleton);
	skeleton->level_count = levels;
	skeleton->levels = allocate(levels, sizeof *skeleton->levels);
	skeleton->nodes = allocate(ESKEL_NODES(levels), sizeof *skeleton->nodes);
	eskel_node *node = skeleton->nodes;
	for (uint32_t k = 1; k <= levels; k++) {
		skeleton->levels[k - 1].level = k;
		for (uint32_t c = 0; c < k; c++, node++) {
			node->level = k;
			node->class_index = c;
			node->parent = k == 1 ? -1 : 0;
			merge(blobs, count, c, k, node);
			complete(node, skeleton->nodes);
		}
	}
	skeleton->voxels = skeleton->nodes->voxels;
	skeleton->weight = skeleton->nodes->weight;
	skeleton->volume = skeleton->weight * voxel_volume;
	return skeleton;
}

eskel_chirality skeletons_compare(const eskel_skeleton *a, const eskel_skeleton *b)
{
	eskel_placement *placed_a = NULL, *placed_b = NULL;
	eskel_chirality chirality;
	if (eskel_placement_new(a, &placed_a) || eskel_placement_new(b, &placed_b) ||
		eskel_chirality_compare(placed_a, placed_b, &chirality)) {
		fprintf(stderr, "memory ran out\n");
		exit(1);
	}
	eskel_placement_free(placed_a);
	eskel_placement_free(placed_b);
	return chirality;
}
