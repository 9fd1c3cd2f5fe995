#include "seam_crossings.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

enum { HALVINGS = 24, NEWTON_MOST = 12 };

typedef struct {
	const esk_ellipsoid *a, *b, *other;
	const esk_curve *curve;
	uint32_t by;
	double step;
	esk_crossings *crossings;
	bool lacks_memory;
} work;

static bool find_between(const work *w, double at, double point[3])
{
	const esk_curve *c = w->curve;
	const size_t i = (size_t)at % c->count, j = (i + 1) % c->count;
	const double share = at - floor(at);
	for (int k = 0; k < 3; k++)
		point[k] = c->points[i][k] + share * (c->points[j][k] - c->points[i][k]);
	return esk_seam_settle(w->a, w->b, point);
}

/* Onto three surfaces, from near by. */
static bool settle_corner(const work *w, double point[3])
{
	const esk_ellipsoid *three[3] = {w->a, w->b, w->other};
	for (int i = 0; i < NEWTON_MOST; i++) {
		double slopes[3][3], values[3], crosses[3][3], square = 0;
		for (int k = 0; k < 3; k++)
			values[k] = esk_ellipsoid_slope(three[k], point, slopes[k]) / 2;
		for (int k = 0; k < 3; k++)
			esk_triple_cross(slopes[(k + 1) % 3], slopes[(k + 2) % 3], crosses[k]);
		const double determinant = esk_triple_dot(slopes[0], crosses[0]);
		if (!(fabs(determinant) > 1e-7 * esk_triple_length(slopes[0]) * esk_triple_length(slopes[1]) *
						  esk_triple_length(slopes[2])))
			return false;
		for (int k = 0; k < 3; k++) {
			const double d =
				-(values[0] * crosses[0][k] + values[1] * crosses[1][k] + values[2] * crosses[2][k]) /
				determinant;
			point[k] += d;
			square += d * d;
		}
		if (square < 1e-16 * w->step * w->step)
			return true;
	}
	return false;
}

/* Between two places of which one is hidden. */
static bool add_crossing(work *w, double low, double high, bool hides)
{
	esk_crossings *all = w->crossings;
	void *array = all->items;
	if (!esk_memory_reserve(&array, &all->capacity, all->count + 1, sizeof *all->items)) {
		w->lacks_memory = true;
		return false;
	}
	all->items = array;
	esk_crossing *made = &all->items[all->count++];
	for (int i = 0; i < HALVINGS; i++) {
		const double middle = (low + high) / 2;
		if (!find_between(w, middle, made->point))
			return false;
		if ((esk_ellipsoid_value(w->other, made->point) < 0) == hides)
			high = middle;
		else
			low = middle;
	}
	made->at = (low + high) / 2;
	made->by = w->by;
	made->hides = hides;
	double square = 0, near[3];
	memcpy(near, made->point, sizeof near);
	if (!settle_corner(w, made->point))
		return false;
	for (int i = 0; i < 3; i++)
		square += (near[i] - made->point[i]) * (near[i] - made->point[i]);
	return square < ESK_SAME_CORNER * ESK_SAME_CORNER * w->step * w->step;
}

typedef struct {
	double value, slope; /* of the potential, along the curve */
} sample;

static sample sample_at(const esk_ellipsoid *e, const double point[3], const double way[3])
{
	double slope[3];
	sample s;
	s.value = esk_ellipsoid_slope(e, point, slope);
	s.slope = esk_triple_dot(slope, way);
	return s;
}

/* Between two points where the potential has the same sign and an extremum of the other one may lie between them. */
static bool cross_twice(work *w, size_t i, bool inside)
{
	const double *from = w->curve->points[i], *to = w->curve->points[(i + 1) % w->curve->count];
	const double chord[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
	double low = (double)i, high = (double)i + 1, point[3], way[3], length = 2 * esk_triple_length(chord);
	for (int k = 0; k < HALVINGS; k++, length /= 2) {
		const double middle = (low + high) / 2;
		if (!find_between(w, middle, point) || !esk_seam_way(w->a, w->b, point, way))
			return false;
		const sample s = sample_at(w->other, point, way);
		if ((s.value < 0) != inside)
			return add_crossing(w, (double)i, middle, !inside) &&
			       add_crossing(w, middle, (double)i + 1, inside);
		/* The potential falls less and less fast, so that it cannot come to 0 any more. */
		if (fabs(s.value) > 2 * fabs(s.slope) * length)
			return true;
		if ((s.slope < 0) != inside)
			low = middle;
		else
			high = middle;
	}
	return true;
}

static bool find_crossings(work *w)
{
	const esk_curve *c = w->curve;
	const esk_ellipsoid *e = w->other;
	sample here = sample_at(e, c->points[0], c->ways[0]);
	for (size_t i = 0; i < c->count; i++) {
		const size_t j = (i + 1) % c->count;
		const sample next = sample_at(e, c->points[j], c->ways[j]);
		const bool inside = here.value < 0;
		if (inside != (next.value < 0)) {
			if (!add_crossing(w, (double)i, (double)i + 1, !inside))
				return false;
		} else if ((here.slope < 0) != inside && (next.slope < 0) == inside) {
			if (!cross_twice(w, i, inside))
				return false;
		}
		here = next;
	}
	return true;
}

eskel_status esk_crossings_add(const esk_ellipsoid *a, const esk_ellipsoid *b, const esk_curve *curve,
	const esk_ellipsoid *other, uint32_t by, double step, esk_crossings *crossings)
{
	work w = {.a = a, .b = b, .other = other, .curve = curve, .by = by, .step = step, .crossings = crossings};
	if (find_crossings(&w))
		return ESKEL_OK;
	return w.lacks_memory ? ESKEL_NO_MEMORY : ESKEL_NUMERIC;
}

static int compare_crossings(const void *a, const void *b)
{
	const esk_crossing *x = a, *y = b;
	if (x->at != y->at)
		return x->at < y->at ? -1 : 1;
	return (x->by > y->by) - (x->by < y->by);
}

void esk_crossings_sort(esk_crossings *crossings)
{
	qsort(crossings->items, crossings->count, sizeof *crossings->items, compare_crossings);
}
