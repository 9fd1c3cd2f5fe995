/* The segments that 3D Slicer describes in the header of a .seg.nrrd file. */
#ifndef ESK_NRRD_SEGMENTS_H
#define ESK_NRRD_SEGMENTS_H

#include "label_names.h"
#include "nrrd_lines.h"

/* The names that a header's SegmentN_... pairs give its labels, to clear by the caller; none where there are no such pairs.
 * ESKEL_TOO_LARGE for a segment's number from 4096 on, ESKEL_MALFORMED for a label value that is no label. */
eskel_status esk_nrrd_segments_read(esk_nrrd_span header, esk_label_names *names, eskel_error *error);

#endif
