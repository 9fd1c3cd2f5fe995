/* A closed mesh as a volume with one label. */
#ifndef ESK_SOLID_VOLUME_H
#define ESK_SOLID_VOLUME_H

#include "run_builder.h"
#include "solid_reader.h"

typedef struct {
	uint64_t voxels; /* of the grid */
	size_t runs;
} esk_solid_volume_limits;

/* spacing: of voxels along the axes, mm; 0: about 100,000 voxels on a turned grid (voxelise.h). Writes the grid into info and
 * adds its warnings. ESKEL_EMPTY for a mesh without volume, or that no voxel's centre lies in. */
eskel_status esk_solid_volume(const esk_solid *solid, esk_solid_space space, double spacing,
	const esk_solid_volume_limits *limits, esk_run_builder *builder, eskel_volume_info *info, eskel_error *error);

#endif
