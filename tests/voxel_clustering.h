/* Progressive dynamic clustering as the paper writes it, voxel by voxel: the oracle and the yardstick of the engine's
 * clustering over runs. It shares the definition of labels (engine/scores.h: integer scores, ties to the lower index)
 * and no code. */
#ifndef VOXEL_CLUSTERING_H
#define VOXEL_CLUSTERING_H

#include "eskel.h"

typedef struct {
	size_t count;
	int32_t (*u)[3]; /* doubled, centred, in the order of the runs */
	int64_t *weight;
	int64_t form[3][3];    /* the metric */
	int shift;             /* of scores */
	double map[3][3];      /* u to the metric's space */
	double root_map[3][3]; /* u to the space of the first split's axis */
	uint64_t passes;       /* over all voxels of a class or of the cloud, so far */
} voxel_set;

typedef struct {
	int64_t weight, first[3];
} voxel_centre;

/* Every function exits when memory runs out. */
void voxel_set_init(voxel_set *set, const eskel_cloud *cloud, const int64_t form[3][3], int shift,
	const double map[3][3], const double root_map[3][3]);
void voxel_set_clear(voxel_set *set);

/* The score of a class, 64 times less than the engine's and without the class index: c, then the three slopes. */
void voxel_score(const voxel_set *set, const voxel_centre *centre, int64_t score[4]);

/* Lloyd's iteration from these centres to the fixed point, which replaces them. False when a class came out empty. */
bool voxel_lloyd(voxel_set *set, voxel_centre *centres, unsigned count, uint8_t *labels);

/* labels[(k - 1) * set->count + v] is the class of voxel v at level k. Returns the levels reached; 0 when a class came
 * out empty on the way, which this program does not handle. */
unsigned voxel_clustering(voxel_set *set, unsigned levels, uint8_t *labels);

#endif
