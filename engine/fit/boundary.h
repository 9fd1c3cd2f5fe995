/* The boundary of a cloud: the faces between its voxels and those that are not its own (section 3.6). */
#ifndef ESK_BOUNDARY_H
#define ESK_BOUNDARY_H

#include "nearest.h"

enum { ESK_BOUNDARY_MOST = 1 << 26 }; /* faces; some 60 bytes each */

/* A face is a parallelogram across an index axis. Its outward side is direction 2 axis + 1 towards higher indices and
 * 2 axis towards lower ones. */
typedef struct {
	const eskel_cloud *cloud; /* not owned */
	double spacing;           /* mm, the cube root of a voxel's volume */
	size_t count;
	double (*points)[3]; /* mm, the centres of the faces: ends of all runs, then one side of them after another */
	uint8_t *directions;
	double normals[6][3];  /* unit, outward, by direction */
	double areas[3];       /* mm^2, by axis */
	double edges[3][2][3]; /* mm, half of the two edges of a face, by axis */
	double reach;          /* mm, from a face's centre to its farthest corner, of any axis */
	double area;           /* mm^2, of all */
	esk_nearest *tree;     /* of points */
} esk_boundary;

/* Of voxels of any weight. ESKEL_TOO_LARGE for more than ESK_BOUNDARY_MOST faces. Near-linear in runs and faces. The cloud
 * stays. */
eskel_status esk_boundary_new(const eskel_cloud *cloud, esk_boundary **boundary, eskel_error *error);
void esk_boundary_free(esk_boundary *boundary);

/* The exact distance, mm, from a point to the nearest face, and which one it is (may be NULL). */
double esk_boundary_distance(const esk_boundary *boundary, const double point[3], uint32_t *face);

/* The index coordinates of a point: the affine, inverted. */
void esk_boundary_index(const esk_boundary *boundary, const double point[3], double index[3]);
/* Is the point in a voxel of the cloud? Voxels hold their lower faces. O(log runs). */
bool esk_boundary_holds(const esk_boundary *boundary, const double point[3]);

/* Faces, most of them at once: every face when there are no more, else so many that each stands for the same area, spread
 * over the whole. */
size_t esk_boundary_sample(const esk_boundary *boundary, size_t most, uint32_t *faces);

#endif
