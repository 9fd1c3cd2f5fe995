/* Closed meshes to runs of voxels. */
#ifndef ESK_VOXELISE_H
#define ESK_VOXELISE_H

#include "run_builder.h"
#include "solid.h"

/* Cubic voxels about the middle of the mesh's box along the axes of the grid. Their centres reach as far as the box, their
 * edges no farther off it than a quarter of a voxel; half of one where the box is thinner than that. */
typedef struct {
	double axes[3][3]; /* unit vectors */
	double spacing;    /* mm */
	double corner[3];  /* mm along the axes */
	uint32_t extent[3];
} esk_voxelise_grid;

/* Along the axes of the mesh; or turned to these, so that flat faces along them, as in what was built or segmented, meet
 * voxels at all heights: the volume of the voxels is then that of the mesh, whatever the spacing. ESKEL_TOO_LARGE for more
 * than 65535 voxels along an axis, ESKEL_BAD_GEOMETRY for a spacing that no affine may have. */
eskel_status esk_voxelise_fit(
	const esk_solid *solid, double spacing, bool turned, esk_voxelise_grid *grid, eskel_error *error);
eskel_affine esk_voxelise_affine(const esk_voxelise_grid *grid);

/* Where the rows of the grid cross the surface. All zero: nowhere. */
typedef struct {
	uint64_t *items;
	size_t count, capacity;
	uint64_t slices; /* that triangles reach into */
} esk_crossings;

void esk_crossings_clear(esk_crossings *crossings);
/* ESKEL_TOO_LARGE when there are more than most. */
eskel_status esk_crossings_find(const esk_solid *solid, const esk_voxelise_grid *grid, size_t most,
	esk_crossings *crossings, eskel_error *error);

/* Numbers of voxels by their winding number w. */
typedef struct {
	int64_t sum;                         /* of w: what the mesh's volume counts */
	uint64_t inside, multiple, reversed; /* w other than 0, |w| > 1, and of the other sign than the sum */
} esk_winding_counts;

esk_winding_counts esk_crossings_count(const esk_crossings *crossings);

/* Gives the builder, as label 1, the runs of voxels whose centre has a winding number other than 0. */
eskel_status esk_crossings_fill(const esk_crossings *crossings, esk_run_builder *builder, eskel_error *error);

#endif
