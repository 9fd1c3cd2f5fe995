/* Skeletons without voxels: groups of ellipsoidal blobs, for tests that need exact control over a shape. */
#ifndef SKELETONS_H
#define SKELETONS_H

#include "eskel.h"

typedef struct {
	double weight, centre[3], covariance[3][3];
} skeletons_blob;

/* count random ellipsoids in a box of 60 by 40 by 25 mm: a shape without any symmetry. */
void skeletons_scatter(uint64_t seed, skeletons_blob *blobs, size_t count);

/* x becomes linear x + offset. */
void skeletons_move(const double linear[3][3], const double offset[3], skeletons_blob *blobs, size_t count);

/* Shifts every centre by up to noise mm along each axis. */
void skeletons_disturb(uint64_t seed, double noise, skeletons_blob *blobs, size_t count);

/* A random proper rotation. */
void skeletons_rotation(uint64_t *random, double rotation[3][3]);

/* Class c of level k is the union of the blobs c, c + k, c + 2k and so on; levels <= count. Exits when memory ran out. */
eskel_skeleton *skeletons_new(const skeletons_blob *blobs, size_t count, uint32_t levels, double voxel_volume);

/* Exits when memory ran out. */
eskel_chirality skeletons_compare(const eskel_skeleton *a, const eskel_skeleton *b);

#endif
