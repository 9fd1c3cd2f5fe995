/* What a segment is called. */
#ifndef ESK_SEGMENT_NAME_H
#define ESK_SEGMENT_NAME_H

#include "segmentation.h"

enum { ESK_SEGMENT_NAME = ESK_SEGMENT_TEXT + sizeof " right" };

/* As segments of 3D Slicer (nrrd_segments.c): what its person calls it; for one that nobody named the meaning of its
 * region or, without one, of its type; with the side that their modifiers say, unless the name says it. "" when
 * nothing is said. */
void esk_segment_name(const esk_dicom_segment *segment, char name[ESK_SEGMENT_NAME]);

#endif
