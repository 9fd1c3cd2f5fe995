/* Fields whose surfaces are known: what the polygonising of surfaces is tested and measured with. */
#ifndef FIELDS_H
#define FIELDS_H

#include "field.h"

/* |p - c|^2 / r^2 - 1. */
typedef struct {
	double centre[3], radii[3];
} ellipsoid;

enum { FIELDS_MOST = 16 };

typedef struct {
	int count;
	ellipsoid items[FIELDS_MOST];
} ellipsoids;

/* -log sum exp(-d_i) (Blinn). */
esk_field fields_blend(const ellipsoids *e);
/* The least of d_i. */
esk_field fields_union(const ellipsoids *e);

/* The squared distance from a circle about the z axis, less the square of the tube's radius. */
typedef struct {
	double circle, tube;
} torus;

esk_field fields_torus(const torus *t);

/* Ten ellipsoids along a bent line, 128 long: seeds are their centres. */
void fields_ten(ellipsoids *e);

#endif
