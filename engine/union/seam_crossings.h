/* Where an ellipsoid begins and ends to hide a curve that two others have in common. */
#ifndef ESK_SEAM_CROSSINGS_H
#define ESK_SEAM_CROSSINGS_H

#include "seam.h"

/* Corners that are closer, in steps, cannot be told from one another. */
#define ESK_SAME_CORNER 1e-3

typedef struct {
	double at; /* a place on the curve: the number of a point, and the share of the way to the next one */
	double point[3];
	uint32_t by; /* the number of the ellipsoid that hides the curve from there on, or up to there */
	bool hides;
} esk_crossing;

typedef struct {
	size_t count, capacity;
	esk_crossing *items;
} esk_crossings;

/* Adds those of another ellipsoid, numbered by. ESKEL_NUMERIC where the three surfaces touch. */
eskel_status esk_crossings_add(const esk_ellipsoid *a, const esk_ellipsoid *b, const esk_curve *curve,
	const esk_ellipsoid *other, uint32_t by, double step, esk_crossings *crossings);
/* In the order of the curve. */
void esk_crossings_sort(esk_crossings *crossings);

#endif
