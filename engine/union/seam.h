/* The curves that the surfaces of two ellipsoids have in common, as points one after the other. */
#ifndef ESK_SEAM_H
#define ESK_SEAM_H

#include "seam_start.h"

#include <stddef.h>

/* A closed curve. On the surface of a, b is to its left; on that of b, a is to its right. */
typedef struct {
	size_t count, capacity;
	double (*points)[3], (*ways)[3]; /* and the direction in which it goes there, of length 1 */
} esk_curve;

/* Moves a point onto both surfaces. False if it does not get there, or where they touch. */
bool esk_seam_settle(const esk_ellipsoid *a, const esk_ellipsoid *b, double point[3]);
/* The direction in which the curve goes on at a point of it. */
bool esk_seam_way(const esk_ellipsoid *a, const esk_ellipsoid *b, const double point[3], double way[3]);

/* The closed curve through a start, in steps of at most step (mm), in which it turns by a third of a right angle at most.
 * ESKEL_NUMERIC where it does not come back. */
eskel_status esk_seam_trace(
	const esk_ellipsoid *a, const esk_ellipsoid *b, const double start[3], double step, esk_curve *curve);
/* Whether a point of the surfaces' common curves lies on this one. */
bool esk_seam_passes(const esk_curve *curve, const double point[3], const double way[3]);
void esk_curve_clear(esk_curve *curve);

#endif
