/* The coarse cloud of section 2.4.4: cells of 3x3x3 voxels, each a point at its centre with the weight of its voxels.
 *
 * What it brings, sixteen levels: nine tenths of the time from 200,000 voxels on, less than nothing below, because the
 * unequal weights of border cells cut the rows of cells into short segments (half as many as the cloud has, not a ninth),
 * and passes over long ones are as fast. The partitions are fixed points of the full cloud, not always the same ones:
 * variance within classes 0.88 to 1.03 of plain. The paper's untried recursion is left out: it would start from still
 * coarser levels, at the same price. */
#ifndef ESK_COARSE_H
#define ESK_COARSE_H

#include "moments.h"

/* Cells lie symmetrically in the box, so that a mirrored cloud has the mirrored cells. Coordinates are doubled and
 * centred in units of cells: 3 times them are those of voxels. free() the segments. */
eskel_status esk_coarse_segments(const eskel_cloud *cloud, esk_segment **segments, size_t *segment_count);

#endif
