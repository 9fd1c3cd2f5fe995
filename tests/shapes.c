#include "shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

const eskel_affine shapes_identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static const shapes_rod hamate_rods[] = {
	{{14, 15, 14}, {30, 20, 22}, 11, 13},
	{{30, 20, 22}, {24, 28, 40}, 12, 9},
	{{22, 24, 26}, {10, 40, 30}, 7, 4},
	{{10, 40, 30}, {8, 46, 40}, 4, 3.5},
};
const shapes_solid shapes_hamate = {hamate_rods, 4, 1.208, {48, 54, 54}};

static const shapes_rod femur_rods[] = {
	{{38, 32, 30}, {44, 30, 150}, 13, 10},
	{{44, 30, 150}, {46, 34, 264}, 10, 12},
	{{46, 34, 264}, {20, 30, 290}, 11, 10},
	{{20, 30, 290}, {17, 30, 292}, 15.5, 15.5},
	{{50, 36, 268}, {54, 38, 282}, 12, 7},
	{{24, 32, 20}, {24, 36, 18}, 15, 14},
	{{52, 32, 20}, {52, 36, 18}, 15, 14},
};
const shapes_solid shapes_femur = {femur_rods, 7, 0.987, {72, 56, 312}};

const shapes_solid shapes_large = {hamate_rods, 4, 4.487, {48, 54, 54}};

static bool is_in_rod(const shapes_rod *rod, double x, double y, double z)
{
	const double p[3] = {x, y, z};
	double along = 0, length = 0, distance = 0;
	for (int i = 0; i < 3; i++) {
		along += (p[i] - rod->from[i]) * (rod->to[i] - rod->from[i]);
		length += (rod->to[i] - rod->from[i]) * (rod->to[i] - rod->from[i]);
	}
	double t = length > 0 ? fmin(fmax(along / length, 0), 1) : 0;
	for (int i = 0; i < 3; i++) {
		double d = p[i] - (1 - t) * rod->from[i] - t * rod->to[i];
		distance += d * d;
	}
	double radius = (1 - t) * rod->from_radius + t * rod->to_radius;
	return distance <= radius * radius;
}

static bool is_inside(const shapes_solid *solid, unsigned x, unsigned y, unsigned z)
{
	for (size_t i = 0; i < solid->count; i++)
		if (is_in_rod(&solid->rods[i], x / solid->scale, y / solid->scale, z / solid->scale))
			return true;
	return false;
}

static eskel_cloud *finish(eskel_run *runs, size_t count, const eskel_affine *affine)
{
	eskel_cloud *cloud = NULL;
	eskel_error error = {0};
	if (eskel_cloud_new(runs, NULL, count, affine, &cloud, &error)) {
		fprintf(stderr, "no shape: %s\n", error.text);
		exit(1);
	}
	free(runs);
	return cloud;
}

static eskel_run *allocate(size_t count)
{
	eskel_run *runs = calloc(count, sizeof *runs);
	if (!runs) {
		fprintf(stderr, "memory ran out for a shape\n");
		exit(1);
	}
	return runs;
}

static unsigned scaled(const shapes_solid *solid, int axis)
{
	return (unsigned)ceil(solid->extent[axis] * solid->scale);
}

eskel_cloud *shapes_cloud(const shapes_solid *solid, const eskel_affine *affine)
{
	const unsigned nx = scaled(solid, 0), ny = scaled(solid, 1), nz = scaled(solid, 2);
	eskel_run *runs = allocate((size_t)(nx / 2 + 1) * ny * nz);
	size_t count = 0;
	for (unsigned z = 0; z < nz; z++)
		for (unsigned y = 0; y < ny; y++) {
			bool before = false;
			for (unsigned x = 0; x < nx; x++) {
				bool inside = is_inside(solid, x, y, z);
				if (inside && !before)
					runs[count++] = (eskel_run){(uint16_t)x, (uint16_t)x, (uint16_t)y, (uint16_t)z};
				else if (inside)
					runs[count - 1].x_last = (uint16_t)x;
				before = inside;
			}
		}
	return finish(runs, count, affine);
}

eskel_cloud *shapes_voxels(const uint16_t (*voxels)[3], size_t count, const eskel_affine *affine)
{
	eskel_run *runs = allocate(count);
	for (size_t i = 0; i < count; i++)
		runs[i] = (eskel_run){voxels[i][0], voxels[i][0], voxels[i][1], voxels[i][2]};
	return finish(runs, count, affine);
}
