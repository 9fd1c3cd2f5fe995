/* The paper's sign of handedness (section 5.5). */
#ifndef ESK_DETERMINANT_H
#define ESK_DETERMINANT_H

#include "shape.h"

enum { ESK_DETERMINANT_FIRST_LEVEL = 4, ESK_DETERMINANT_LAST_LEVEL = 10 };

/* What determinants need of a skeleton, of its levels FIRST to LAST. */
typedef struct {
	esk_shape *shape;                                           /* cut off at LAST */
	double centres[ESKEL_NODES(ESK_DETERMINANT_LAST_LEVEL)][3]; /* world mm */
	uint8_t largest[ESK_DETERMINANT_LAST_LEVEL][4];             /* four classes of level k at k - 1 */
} esk_tetrahedra;

/* ESKEL_NO_MEMORY. */
eskel_status esk_tetrahedra_init(esk_tetrahedra *tetrahedra, const eskel_skeleton *skeleton);
void esk_tetrahedra_clear(esk_tetrahedra *tetrahedra);

/* Of the classes of a at this level, the four whose centres span the largest tetrahedron, and the four that the
 * signatures match with them in b. Each determinant is that of the rows (1, x, y, z) in world mm, 6 times the signed
 * volume. Both have the level, which is one of FIRST to LAST. ESKEL_NO_MEMORY. */
eskel_status esk_determinant_pair(
	const esk_tetrahedra *a, const esk_tetrahedra *b, uint32_t level, double determinants[2]);

#endif
