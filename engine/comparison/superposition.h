/* How well one skeleton can be laid on another, as it is and as its mirror image (section 5.5). */
#ifndef ESK_SUPERPOSITION_H
#define ESK_SUPERPOSITION_H

#include "natural_frame.h"

enum { ESK_SUPERPOSITION_FIRST_LEVEL = 4 };

/* For shapes brought to volume 1, the poses that turn b (proper) or mirror and turn it (improper) so that matched classes
 * lie at the least mean distance: lane l for level FIRST + l, or for the last one (at most ESK_PLACED_CLASSES_MAX) if
 * there are fewer. Swapping a and b inverts them, and mirroring one exchanges the hands, but for rounding. Class c of
 * level k is at ESKEL_NODES(k - 1) + c. */
typedef struct {
	esk_lanes proper[3][3], improper[3][3];
} esk_candidate_poses;

void esk_superposition_candidates(
	const esk_placed_class *a, const esk_placed_class *b, uint32_t last, esk_candidate_poses *candidates);

/* The proper and the improper orthogonal matrix that turns b on a at the least cost, where one pose has to serve all levels
 * from 1 to last: partitions differ from level to level, and what is seen side by side is the shapes. */
void esk_superposition_poses(const esk_placed_class *a, const esk_placed_class *b, uint32_t last, double best[2][3][3]);

#endif
