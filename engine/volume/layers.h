/* Overlapping segments: voxels of several values, one a layer, turned into runs per segment. */
#ifndef ESK_LAYERS_H
#define ESK_LAYERS_H

#include "run_builder.h"
#include "segments.h"

#define ESK_LAYERS_MOST 256

typedef struct esk_layers esk_layers;

/* Of the segments, those whose label whole wants; limits are those of whole, that of runs divided among the layers. Voxels
 * that no segment describes are left out. */
eskel_status esk_layers_new(const esk_run_builder *whole, const esk_segments *segments, size_t layer_count,
	const esk_voxel_format *format, const uint32_t extent[3], esk_layers **layers);
void esk_layers_free(esk_layers *layers);

/* The next count voxels, each of a value for every layer. What refuses is the first bad voxel, of the first layer. */
eskel_status esk_layers_add(esk_layers *layers, const uint8_t *voxels, size_t count, eskel_error *error);

/* The labels of the segments that have runs. Owned by the layers. */
eskel_status esk_layers_finish(esk_layers *layers, const esk_label_table **table);

#endif
