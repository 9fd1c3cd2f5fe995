#include "placement.h"

#include "memory.h"
#include "overlap.h"

#include <stdlib.h>

static size_t size_of(uint32_t level_count)
{
	return sizeof(eskel_placement) + ESKEL_NODES(level_count) * sizeof(esk_placed_class);
}

double esk_placement_overlap(const eskel_placement *placement, uint32_t level)
{
	static const esk_lanes identity[3][3] = {{{1}}, {{0}, {1}}, {{0}, {0}, {1}}}; /* in the first lane */
	const esk_placed_class *classes = &placement->classes[ESKEL_NODES(level - 1)];
	double overlaps[ESK_LANES];
	esk_overlap_find(classes, classes, level, identity, overlaps);
	return overlaps[0];
}

eskel_status eskel_placement_new(const eskel_skeleton *skeleton, eskel_placement **placement)
{
	uint32_t levels = skeleton->level_count;
	if (levels > ESK_PLACED_CLASSES_MAX)
		levels = ESK_PLACED_CLASSES_MAX;
	eskel_placement *made = esk_memory_zeroed_array(1, size_of(levels));
	if (!made)
		return ESKEL_NO_MEMORY;
	eskel_status status = esk_tetrahedra_init(&made->tetrahedra, skeleton);
	made->level_count = levels;
	for (uint32_t k = 1; !status && k <= levels; k++)
		status = esk_natural_frame_place_stretched(skeleton, k, &made->classes[ESKEL_NODES(k - 1)]);
	if (status != ESKEL_OK) {
		eskel_placement_free(made);
		return status;
	}
	made->overlap = esk_placement_overlap(made, levels);
	*placement = made;
	return ESKEL_OK;
}

void eskel_placement_free(eskel_placement *placement)
{
	if (!placement)
		return;
	esk_tetrahedra_clear(&placement->tetrahedra);
	free(placement);
}

size_t eskel_placement_size(const eskel_placement *placement)
{
	return size_of(placement->level_count) + esk_shape_size(placement->tetrahedra.shape->level_count);
}
