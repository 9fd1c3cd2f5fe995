/* The coarse cloud of section 2.4.4: cells of 3x3x3 voxels, each a point at its centre with the weight of its voxels. */
#ifndef ESK_COARSE_H
#define ESK_COARSE_H

#include "moments.h"

/* Cells lie symmetrically in the box, so that a mirrored cloud has the mirrored cells. Coordinates are doubled and
 * centred in units of cells: 3 times them are those of voxels. free() the segments. */
eskel_status esk_coarse_segments(const eskel_cloud *cloud, esk_segment **segments, size_t *segment_count);

#endif
