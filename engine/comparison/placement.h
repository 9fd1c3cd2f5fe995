/* A skeleton as comparing handedness needs it, made once and compared often. */
#ifndef ESK_PLACEMENT_H
#define ESK_PLACEMENT_H

#include "determinant.h"
#include "natural_frame.h"

struct eskel_placement {
	uint32_t level_count; /* of the skeleton, at most ESK_PLACED_CLASSES_MAX */
	esk_tetrahedra tetrahedra;
	double overlap;             /* of level level_count with itself */
	esk_placed_class classes[]; /* stretched; class c of level k at ESKEL_NODES(k - 1) + c */
};

/* Of a level with itself, as overlap.h. */
double esk_placement_overlap(const eskel_placement *placement, uint32_t level);

#endif
