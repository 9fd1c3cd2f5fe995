/* How much of the matter of two shapes lies in the same place. */
#ifndef ESK_OVERLAP_H
#define ESK_OVERLAP_H

#include "natural_frame.h"

/* Takes the classes of a level, count of them, for a density f each, a mixture of normal densities (overlap.c), and finds
 * the integrals of f_a f_b, b turned by an orthogonal matrix a lane. */
void esk_overlap_find(const esk_placed_class *a, const esk_placed_class *b, uint32_t count,
	const esk_lanes orthogonal[3][3], double overlaps[ESK_LANES]);

#endif
