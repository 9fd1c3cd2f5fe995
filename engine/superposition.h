/* How well one skeleton can be laid on another, as it is and as its mirror image (section 5.5). */
#ifndef ESK_SUPERPOSITION_H
#define ESK_SUPERPOSITION_H

#include "eskel.h"

enum { ESK_SUPERPOSITION_FIRST_LEVEL = 4, ESK_SUPERPOSITION_LAST_LEVEL = 16 };

/* Sums, over levels FIRST to last (at most LAST; 0 for fewer), of the least mean distance of matched classes, for shapes
 * brought to volume 1, where b is turned (proper) or mirrored and turned (improper). Swapping a and b changes no more
 * than rounding does, and mirroring one exchanges the two sums. */
void esk_superposition_costs(
	const eskel_skeleton *a, const eskel_skeleton *b, uint32_t last, double *proper, double *improper);

#endif
