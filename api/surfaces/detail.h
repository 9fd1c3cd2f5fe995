/* How fine a shape need be drawn: the level k and the step s as staircase functions of the distance between the eye and the
 * shape (section 4), so that there are only a few meshes of it. */
#ifndef ESK_DETAIL_H
#define ESK_DETAIL_H

#include "eskel_store.h"

#define ESK_DETAILS 4

typedef struct {
	double from; /* mm: of the distances that it is for, to those of the next */
	uint32_t level;
	double step; /* mm */
} esk_detail;

/* The finest step that a mesh of the shape is worth: a sixteenth of the shortest radius of its best ellipsoid, but no less than
 * half a voxel; in whole micrometres, at least one. */
double esk_detail_step(const eskel_skeleton *skeleton);

/* From near to far. Each doubles the step of the one before, and begins where that step is two pixels of a thousandth of a
 * radian, such as those of a view of 60 degrees on a thousand rows. Its level is the deepest whose classes are at least four
 * steps across, for finer ones would not be seen. */
void esk_detail_table(const eskel_skeleton *skeleton, esk_detail details[ESK_DETAILS]);
/* The row of the table for a distance, mm. */
esk_detail esk_detail_at(const eskel_skeleton *skeleton, double distance);

#endif
