/* Where a surface cuts edges whose ends lie on both sides of it: many at once. */
#ifndef ESK_ROOTS_H
#define ESK_ROOTS_H

#include "field.h"

enum { ESK_ROOTS_MOST = 128 }; /* so that all that is known of them fits into the nearest cache */

/* Edges, and the values of the field at the ends and as far beyond them: before, inside, where it is below 0, outside,
 * where it is at least 0, and after. */
typedef struct {
	double inside[3][ESK_ROOTS_MOST],
		along[3][ESK_ROOTS_MOST]; /* by axis: an end, and the way from it to the other */
	double values[4][ESK_ROOTS_MOST];
} esk_roots;

/* Of the first count edges, a point on each where the field is 0, to about 1e-5 of its length where the field is smooth, and
 * the gradient, which is that of a point at most 2e-3 of its length away. */
void esk_roots_find(
	const esk_field *field, size_t count, const esk_roots *roots, double (*points)[3], double (*gradients)[3]);

#endif
