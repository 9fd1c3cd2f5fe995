/* The paper's sign of handedness (section 5.5). */
#ifndef ESK_DETERMINANT_H
#define ESK_DETERMINANT_H

#include "eskel.h"

enum { ESK_DETERMINANT_FIRST_LEVEL = 4, ESK_DETERMINANT_LAST_LEVEL = 10 };

/* Of the classes of a at this level, the four whose centres span the largest tetrahedron, and the four that the
 * signatures match with them in b. Each determinant is that of the rows (1, x, y, z) in world mm, 6 times the signed
 * volume. Both skeletons have the level, which is one of FIRST to LAST. ESKEL_NO_MEMORY. */
eskel_status esk_determinant_pair(
	const eskel_skeleton *a, const eskel_skeleton *b, uint32_t level, double determinants[2]);

#endif
