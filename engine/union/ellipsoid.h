/* An ellipsoid as a map of the unit sphere: p = centre + sum_a u_a axes[a], and f(p) = |u|^2 - 1. */
#ifndef ESK_ELLIPSOID_H
#define ESK_ELLIPSOID_H

#include "eskel.h"
#include "triple.h"

typedef struct {
	double centre[3];
	double axes[3][3];  /* mm; right-handed, the longest last */
	double duals[3][3]; /* 1/mm: u_a = duals[a] . (p - centre) */
	double radii[3];
	double reach[3]; /* mm: half the sides of its box */
} esk_ellipsoid;

void esk_ellipsoid_make(const eskel_primitive *primitive, esk_ellipsoid *ellipsoid);
/* Whether their boxes do. */
static inline bool esk_ellipsoids_meet(const esk_ellipsoid *a, const esk_ellipsoid *b)
{
	for (int i = 0; i < 3; i++)
		if (fabs(a->centre[i] - b->centre[i]) > a->reach[i] + b->reach[i])
			return false;
	return true;
}

static inline void esk_ellipsoid_unit(const esk_ellipsoid *e, const double point[3], double unit[3])
{
	const double from[3] = {point[0] - e->centre[0], point[1] - e->centre[1], point[2] - e->centre[2]};
	for (int a = 0; a < 3; a++)
		unit[a] = esk_triple_dot(e->duals[a], from);
}

static inline void esk_ellipsoid_point(const esk_ellipsoid *e, const double unit[3], double point[3])
{
	for (int i = 0; i < 3; i++)
		point[i] = e->centre[i] + unit[0] * e->axes[0][i] + unit[1] * e->axes[1][i] + unit[2] * e->axes[2][i];
}

static inline double esk_ellipsoid_value(const esk_ellipsoid *e, const double point[3])
{
	double unit[3];
	esk_ellipsoid_unit(e, point, unit);
	return esk_triple_dot(unit, unit) - 1;
}

/* Half the gradient of f, where the unit is that of a point. */
static inline void esk_ellipsoid_normal(const esk_ellipsoid *e, const double unit[3], double normal[3])
{
	for (int i = 0; i < 3; i++)
		normal[i] = unit[0] * e->duals[0][i] + unit[1] * e->duals[1][i] + unit[2] * e->duals[2][i];
}

/* f, and half its gradient. */
static inline double esk_ellipsoid_slope(const esk_ellipsoid *e, const double point[3], double slope[3])
{
	double unit[3];
	esk_ellipsoid_unit(e, point, unit);
	esk_ellipsoid_normal(e, unit, slope);
	return esk_triple_dot(unit, unit) - 1;
}

#endif
