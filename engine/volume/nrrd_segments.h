/* The segments that 3D Slicer describes in the header of a .seg.nrrd file. */
#ifndef ESK_NRRD_SEGMENTS_H
#define ESK_NRRD_SEGMENTS_H

#include "nrrd_lines.h"
#include "segments.h"

/* The segments that a header's SegmentN_... pairs describe, to clear by the caller; none where there are no such pairs.
 * ESKEL_TOO_LARGE for a segment's number from 4096 on, ESKEL_MALFORMED for a label value that is no label or a layer that
 * the file has not. */
eskel_status esk_nrrd_segments_read(
	esk_nrrd_span header, uint32_t layer_count, esk_segments *segments, eskel_error *error);

#endif
