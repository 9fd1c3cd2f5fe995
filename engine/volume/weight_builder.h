/* Voxels that say how much of an object they hold, in file order, turned into runs of equal weight (section 2.1). */
#ifndef ESK_WEIGHT_BUILDER_H
#define ESK_WEIGHT_BUILDER_H

#include "run_builder.h"

typedef struct esk_weight_builder esk_weight_builder;

eskel_status esk_weight_builder_new(size_t most_runs, esk_weight_builder **builder);
void esk_weight_builder_free(esk_weight_builder *builder);

/* Before the first voxel. */
void esk_weight_builder_set_grid(esk_weight_builder *builder, const esk_voxel_format *format, const uint32_t extent[3]);

/* The next count voxels; never more in all than the grid has. ESKEL_BAD_VALUE for what is negative or not finite. */
eskel_status esk_weight_builder_add(
	esk_weight_builder *builder, const uint8_t *voxels, size_t count, eskel_error *error);

/* The runs of the one label, 1, in a table without labels when no voxel has a weight. Owned by the builder.
 * ESKEL_NO_MEMORY. */
eskel_status esk_weight_builder_finish(esk_weight_builder *builder, const esk_label_table **table);
/* One a run, once finished: the largest brought to 4080, then all divided by what divides all. */
const uint32_t *esk_weight_builder_weights(const esk_weight_builder *builder);

/* Whether voxels of these weights would give them back as they are. */
bool esk_weight_builder_keeps(const uint32_t *weights, size_t count);

#endif
