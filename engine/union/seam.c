#include "seam.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS_MOST = 1 << 16, NEWTON_MOST = 12 };

/* Gradients with a smaller sine of the angle between them are those of surfaces that touch. */
static const double least_sine = 1e-5;

bool esk_seam_settle(const esk_ellipsoid *a, const esk_ellipsoid *b, double point[3])
{
	/* It converges quadratically: the step after such a one is one of rounding. */
	const double small = 1e-8 * (a->radii[2] + b->radii[2]);
	for (int i = 0; i < NEWTON_MOST; i++) {
		/* The least move d with 2 slope . d = -f for both: a combination of the slopes. */
		double u[3], v[3], square = 0;
		const double f = esk_ellipsoid_slope(a, point, u) / 2, g = esk_ellipsoid_slope(b, point, v) / 2;
		const double uu = esk_triple_dot(u, u), vv = esk_triple_dot(v, v), uv = esk_triple_dot(u, v);
		const double determinant = uu * vv - uv * uv;
		if (!(determinant > least_sine * least_sine * uu * vv))
			return false;
		const double x = (uv * g - vv * f) / determinant, y = (uv * f - uu * g) / determinant;
		for (int k = 0; k < 3; k++) {
			const double d = x * u[k] + y * v[k];
			point[k] += d;
			square += d * d;
		}
		if (square < small * small)
			return true;
	}
	return false;
}

bool esk_seam_way(const esk_ellipsoid *a, const esk_ellipsoid *b, const double point[3], double way[3])
{
	double u[3], v[3];
	esk_ellipsoid_slope(a, point, u);
	esk_ellipsoid_slope(b, point, v);
	esk_triple_cross(u, v, way);
	const double length = esk_triple_length(way);
	for (int i = 0; i < 3; i++)
		way[i] /= length;
	return length > least_sine * esk_triple_length(u) * esk_triple_length(v);
}

static bool add_point(esk_curve *curve, const double point[3], const double way[3])
{
	if (curve->count == curve->capacity) {
		size_t ways = curve->capacity;
		void *array = curve->points;
		if (!esk_memory_reserve(&array, &curve->capacity, curve->count + 64, sizeof *curve->points))
			return false;
		curve->points = array;
		array = curve->ways;
		if (!esk_memory_reserve(&array, &ways, curve->capacity, sizeof *curve->ways))
			return false;
		curve->ways = array;
	}
	memcpy(curve->points[curve->count], point, sizeof *curve->points);
	memcpy(curve->ways[curve->count++], way, sizeof *curve->ways);
	return true;
}

/* Whether a point lies on the way from p to q: between them, beside the chord by less than a fifth of it, and going the same
 * way. Where two curves are close to one another they go opposite ways. */
static bool lies_between(const double p[3], const double q[3], const double point[3], const double way[3])
{
	const double chord[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
		     to[3] = {point[0] - p[0], point[1] - p[1], point[2] - p[2]};
	const double square = esk_triple_dot(chord, chord), along = esk_triple_dot(chord, to);
	return along >= -1e-9 * square && along <= square &&
	       esk_triple_dot(to, to) - along * along / square < 0.04 * square && esk_triple_dot(chord, way) > 0;
}

bool esk_seam_passes(const esk_curve *curve, const double point[3], const double way[3])
{
	for (size_t i = 0; i < curve->count; i++)
		if (lies_between(curve->points[i], curve->points[(i + 1) % curve->count], point, way))
			return true;
	return false;
}

/* One step on, as long as the curve goes on much as it did. */
static bool advance(const esk_ellipsoid *a, const esk_ellipsoid *b, double *step, double point[3], double way[3])
{
	const double shortest = *step * 1e-6;
	for (; *step > shortest; *step /= 2) {
		double next[3], beside[3], onward[3];
		for (int i = 0; i < 3; i++)
			next[i] = point[i] + *step * way[i];
		if (!esk_seam_settle(a, b, next) || !esk_seam_way(a, b, next, onward))
			continue;
		for (int i = 0; i < 3; i++)
			beside[i] = next[i] - point[i] - *step * way[i];
		if (esk_triple_length(beside) < 0.15 * *step && esk_triple_dot(way, onward) > 0.88) {
			memcpy(point, next, sizeof next);
			memcpy(way, onward, sizeof onward);
			return true;
		}
	}
	return false;
}

eskel_status esk_seam_trace(
	const esk_ellipsoid *a, const esk_ellipsoid *b, const double start[3], double longest, esk_curve *curve)
{
	double point[3], way[3], first[3], first_way[3], step = longest;
	memcpy(point, start, sizeof point);
	if (!esk_seam_settle(a, b, point) || !esk_seam_way(a, b, point, way))
		return ESKEL_NUMERIC;
	memcpy(first, point, sizeof first);
	memcpy(first_way, way, sizeof first_way);
	for (;;) {
		double before[3];
		memcpy(before, point, sizeof before);
		if (!add_point(curve, point, way))
			return ESKEL_NO_MEMORY;
		if (curve->count == POINTS_MOST || !advance(a, b, &step, point, way))
			return ESKEL_NUMERIC;
		if (curve->count > 2 && lies_between(before, point, first, first_way))
			return ESKEL_OK;
		step = step * 1.5 < longest ? step * 1.5 : longest;
	}
}

void esk_curve_clear(esk_curve *curve)
{
	free(curve->points);
	free(curve->ways);
	*curve = (esk_curve){0};
}
