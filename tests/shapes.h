/* Solid shapes by formula, as clouds: for tests and benchmarks. */
#ifndef SHAPES_H
#define SHAPES_H

#include "eskel.h"

/* A ball swept from one point to another while its radius goes from one value to the other; voxels. */
typedef struct {
	double from[3], to[3], from_radius, to_radius;
} shapes_rod;

typedef struct {
	const shapes_rod *rods;
	size_t count;
	double scale;       /* voxels per unit of the rods */
	unsigned extent[3]; /* of the grid, which holds the union, before scaling */
} shapes_solid;

extern const shapes_solid shapes_hamate; /* like a hamate at 0.5 mm: a wedge and a hook, about 39,000 voxels */
extern const shapes_solid shapes_femur;  /* like a femur at 1.5 mm: long and thin, about 150,000 voxels */
extern const shapes_solid shapes_large;  /* the hamate's formula at 2,000,000 voxels */

/* Voxel (i, j, k) is inside when its centre is. Exits when memory ran out or nothing is inside. */
eskel_cloud *shapes_cloud(const shapes_solid *solid, const eskel_affine *affine);

/* One voxel a set of indices, each of weight 1. */
eskel_cloud *shapes_voxels(const uint16_t (*voxels)[3], size_t count, const eskel_affine *affine);

extern const eskel_affine shapes_identity;

#endif
