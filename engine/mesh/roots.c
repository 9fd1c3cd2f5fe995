/* A cubic through four values of the lattice tells where the surface is, so that the field is evaluated once on most
 * edges, with its gradient, which gives one step of Newton's method and the normal. Edges are moved to the front as others
 * settle. */
#include "roots.h"

#include "lanes.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { ROUNDS = 12 }; /* bisection alone comes to 2e-4 of an edge */

/* Of an edge. After a step of Newton's method that is no longer, what is left is its square, times about half of the edge
 * over the radius of curvature, and the normal turns on the way by about the step over that radius. */
static const double settled_change = 2e-3;

typedef struct {
	size_t count;
	double inside[3][ESK_ROOTS_MOST], along[3][ESK_ROOTS_MOST];
	/* In parts of the edge: a stretch that has the surface in it, where it is as far as is known, and after a step. */
	double lower[ESK_ROOTS_MOST], upper[ESK_ROOTS_MOST], part[ESK_ROOTS_MOST], next[ESK_ROOTS_MOST];
	double points[ESK_ROOTS_MOST][3], values[ESK_ROOTS_MOST], gradients[ESK_ROOTS_MOST][3];
	size_t edges[ESK_ROOTS_MOST];
} search;

/* Also where a part is not a number. */
ESK_IN_LANES double between(double lower, double upper, double part)
{
	return part > lower && part < upper ? part : (lower + upper) / 2;
}

/* The cubic through a, b, c, d at -1, 0, 1, 2 is, with second differences e = a - 2b + c and f = b - 2c + d (Everett),
 *	b + t (c - b) - t (1 - t) ((2 - t) e + (1 + t) f) / 6.
 * Two steps of Newton's method from the straight line through b and c. */
ESK_IN_LANES double guess(double a, double b, double c, double d)
{
	const double slope = c - b, e = (a - 2 * b + c) / 6, f = (b - 2 * c + d) / 6;
	double part = -b / slope;
	for (int step = 0; step < 2; step++) {
		const double t = part, bend = (2 - t) * e + (1 + t) * f;
		const double value = b + t * slope - t * (1 - t) * bend;
		const double derivative = slope - (1 - 2 * t) * bend - t * (1 - t) * (f - e);
		part = t - value / derivative;
	}
	return c == 0 ? 1 : between(0, 1, part);
}

ESK_EVERY_WIDTH static void start(const esk_roots *roots, search *s)
{
	const double(*v)[ESK_ROOTS_MOST] = roots->values;
	for (size_t i = 0; i < s->count; i++) {
		s->lower[i] = 0;
		s->upper[i] = 1;
		s->part[i] = guess(v[0][i], v[1][i], v[2][i], v[3][i]);
	}
}

ESK_EVERY_WIDTH static void place(search *s, const double *parts)
{
	for (int a = 0; a < 3; a++)
		for (size_t i = 0; i < s->count; i++)
			s->points[i][a] = s->inside[a][i] + parts[i] * s->along[a][i];
}

static void evaluate(const esk_field *field, search *s)
{
	if (field->gradients)
		field->gradients(field->context, s->count, (const double(*)[3])s->points, s->values, s->gradients);
	else
		for (size_t i = 0; i < s->count; i++)
			s->values[i] = field->gradient(field->context, s->points[i], s->gradients[i]);
}

/* A step of Newton's method, but to the middle of the stretch where it leads out of it. */
ESK_EVERY_WIDTH static void step(search *s)
{
	for (size_t i = 0; i < s->count; i++) {
		const double value = s->values[i], part = s->part[i], *gradient = s->gradients[i];
		const double slope =
			gradient[0] * s->along[0][i] + gradient[1] * s->along[1][i] + gradient[2] * s->along[2][i];
		s->lower[i] = value < 0 ? part : s->lower[i];
		s->upper[i] = value < 0 ? s->upper[i] : part;
		const double next = between(s->lower[i], s->upper[i], part - value / slope);
		s->next[i] = value == 0 ? part : next;
	}
}

static void move(search *s, size_t from, size_t to)
{
	for (int a = 0; a < 3; a++) {
		s->inside[a][to] = s->inside[a][from];
		s->along[a][to] = s->along[a][from];
	}
	s->lower[to] = s->lower[from];
	s->upper[to] = s->upper[from];
	s->part[to] = s->next[from];
	s->edges[to] = s->edges[from];
}

/* Writes what is known now, and keeps the edges whose last step was long. */
static void settle(search *s, double (*points)[3], double (*gradients)[3])
{
	size_t kept = 0;
	for (size_t i = 0; i < s->count; i++) {
		memcpy(points[s->edges[i]], s->points[i], sizeof *points);
		memcpy(gradients[s->edges[i]], s->gradients[i], sizeof *gradients);
		if (fabs(s->next[i] - s->part[i]) > settled_change)
			move(s, i, kept++);
	}
	s->count = kept;
}

void esk_roots_find(
	const esk_field *field, size_t count, const esk_roots *roots, double (*points)[3], double (*gradients)[3])
{
	search s;
	s.count = count;
	memcpy(s.inside, roots->inside, sizeof s.inside);
	memcpy(s.along, roots->along, sizeof s.along);
	for (size_t i = 0; i < count; i++)
		s.edges[i] = i;
	start(roots, &s);
	for (int round = 0; round < ROUNDS && s.count > 0; round++) {
		place(&s, s.part);
		evaluate(field, &s);
		step(&s);
		place(&s, s.next);
		settle(&s, points, gradients);
	}
}
