/* A closed mesh as a volume with one label, see solid_volume.h.
 *
 * The volume of the voxels is compared with the mesh's own (solid.h): both count a place as often as its winding number says.
 */
#include "solid_volume.h"

#include "error.h"
#include "volume_format.h"
#include "voxelise.h"

#include <math.h>
#include <string.h>

static const double about_voxels = 100000;

/* A share of the mesh's volume. */
static const double worth_a_warning = 0.01;

static eskel_status find_crossings(const esk_solid *solid, const esk_voxelise_grid *grid,
	const esk_solid_volume_limits *limits, esk_crossings *crossings, eskel_error *error)
{
	eskel_status status = esk_volume_check_extent(grid->extent, limits->voxels, error);
	if (status != ESKEL_OK)
		return status;
	/* A run has two crossings, unless parts overlap. */
	return esk_crossings_find(solid, grid, 2 * limits->runs, crossings, error);
}

static void warn(
	const esk_winding_counts *counts, double size, double volume, esk_solid_space space, eskel_volume_info *info)
{
	const double voxels = size * (double)counts->sum, difference = voxels / volume - 1;
	eskel_volume_warn(info, ESKEL_WARNING_UNIT_ASSUMED, "a mesh does not say its unit: millimetres are assumed");
	if (space == ESK_SPACE_UNSAID)
		eskel_volume_warn(info, ESKEL_WARNING_NO_ORIENTATION,
			"the mesh does not say SPACE=RAS or SPACE=LPS: RAS is assumed");
	if (counts->multiple > 0 || counts->reversed > 0)
		eskel_volume_warn(info, ESKEL_WARNING_SELF_INTERSECTING,
			"of %.4g mm^3 within the mesh, %.3g are enclosed more than once and %.3g inside out: parts "
			"overlap or the surface crosses itself; all are inside",
			size * (double)counts->inside, size * (double)counts->multiple,
			size * (double)counts->reversed);
	if (fabs(difference) > worth_a_warning)
		eskel_volume_warn(info, ESKEL_WARNING_VOLUME_DIFFERS,
			"the voxels hold %.4g mm^3, the mesh %.4g, %+.1f %%: a finer spacing follows it closer",
			fabs(voxels), fabs(volume), 100 * difference);
}

eskel_status esk_solid_volume(const esk_solid *solid, esk_solid_space space, double spacing,
	const esk_solid_volume_limits *limits, esk_run_builder *builder, eskel_volume_info *info, eskel_error *error)
{
	const double volume = esk_solid_enclosed(solid);
	const bool chosen = spacing == 0;
	esk_voxelise_grid grid;
	esk_crossings crossings = {0};
	esk_winding_counts counts = {0};
	if (volume == 0)
		return esk_error_set(error, ESKEL_EMPTY, "the mesh encloses no volume");
	if (chosen)
		spacing = cbrt(fabs(volume) / about_voxels);
	eskel_status status = esk_voxelise_fit(solid, spacing, chosen, &grid, error);
	if (status == ESKEL_OK)
		status = find_crossings(solid, &grid, limits, &crossings, error);
	if (status != ESKEL_OK)
		return status;
	counts = esk_crossings_count(&crossings);
	status = counts.inside == 0 ? esk_error_set(error, ESKEL_EMPTY,
					      "no voxel of %g mm has its centre inside the mesh", spacing)
				    : esk_crossings_fill(&crossings, builder, error);
	esk_crossings_clear(&crossings);
	if (status != ESKEL_OK)
		return status;
	memcpy(info->extent, grid.extent, sizeof info->extent);
	info->affine = esk_voxelise_affine(&grid);
	warn(&counts, grid.spacing * grid.spacing * grid.spacing, volume, space, info);
	return ESKEL_OK;
}
