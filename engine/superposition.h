/* How well one skeleton can be laid on another, as it is and as its mirror image (section 5.5). */
#ifndef ESK_SUPERPOSITION_H
#define ESK_SUPERPOSITION_H

#include "natural_frame.h"

enum { ESK_SUPERPOSITION_FIRST_LEVEL = 4 };

/* Sums, over levels FIRST to last (at most ESK_PLACED_CLASSES_MAX), of the least mean distance of matched classes, for shapes
 * brought to volume 1, where b is turned (proper) or mirrored and turned (improper). Swapping a and b changes no more
 * than rounding does, and mirroring one exchanges the two sums. Class c of level k is at ESKEL_NODES(k - 1) + c. */
void esk_superposition_costs(
	const esk_placed_class *a, const esk_placed_class *b, uint32_t last, double *proper, double *improper);

/* The proper and the improper orthogonal matrix that turns b on a at the least cost, where one pose has to serve all levels
 * from 1 to last: partitions differ from level to level, and what is seen side by side is the shapes. */
void esk_superposition_poses(const esk_placed_class *a, const esk_placed_class *b, uint32_t last, double best[2][3][3]);

#endif
