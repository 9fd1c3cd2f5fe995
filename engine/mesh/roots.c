#include "roots.h"

#include <math.h>
#include <stdbool.h>

enum { ROUNDS = 12 }; /* most surfaces need one, or two */

/* Of an edge. Over h, a length small beside the surface's radii of curvature, a guess by a line is off by the order of h^2, one
 * by a parabola by that of h^3 or less: after a small change no other value has to confirm it. Measured on ten blended
 * ellipsoids with edges of half a radius, 4e-6 on average and 6e-4 at most is left, of an eighth 1e-6 and 6e-5. */
static const double settled_change = 0.014;

/* A stretch of an edge, in parts of the way from inside to outside, with values at its ends. */
typedef struct {
	double lower, upper, lower_value, upper_value;
	double part; /* where the surface is, as far as is known */
	bool settled;
} bracket;

/* Also where a value is not finite, or so near to 0 that an end would come out. */
static double between(const bracket *b, double part)
{
	return part > b->lower && part < b->upper ? part : (b->lower + b->upper) / 2;
}

static void start_bracket(const esk_root *root, bracket *b)
{
	*b = (bracket){.upper = 1, .lower_value = root->inside_value, .upper_value = root->outside_value};
	/* An outer end may lie on the surface. */
	b->settled = b->upper_value == 0;
	b->part = b->settled ? 1 : between(b, b->lower_value / (b->lower_value - b->upper_value));
}

/* Where the parabola through the ends and the value at the part is 0; it is so once between the ends. */
static double cross_parabola(const bracket *b, double value)
{
	const double below = (value - b->lower_value) / (b->part - b->lower);
	const double above = (b->upper_value - value) / (b->upper - b->part);
	const double bend = (above - below) / (b->upper - b->lower);
	const double slope = below + bend * (b->part - b->lower);
	const double root = sqrt(slope * slope - 4 * bend * value);
	/* The nearer one of the two, where the slope is upwards; nowhere where it is not, or the root is not a number. */
	return slope > 0 ? b->part - 2 * value / (slope + root) : b->upper;
}

/* One round of Muller's method (1956), kept between ends of different signs. */
static void narrow_bracket(bracket *b, double value)
{
	const double last = b->part, next = cross_parabola(b, value);
	if (value < 0) {
		b->lower = last;
		b->lower_value = value;
	} else {
		b->upper = last;
		b->upper_value = value;
	}
	if (value != 0)
		b->part = between(b, next);
	b->settled = fabs(b->part - last) <= settled_change;
}

static void place_on(const esk_root *root, double part, double point[3])
{
	for (int a = 0; a < 3; a++)
		point[a] = root->inside[a] + part * (root->outside[a] - root->inside[a]);
}

void esk_roots_find(const esk_field *field, size_t count, const esk_root *roots, double (*points)[3])
{
	bracket brackets[ESK_ROOTS_MOST];
	double open_points[ESK_ROOTS_MOST][3], values[ESK_ROOTS_MOST];
	size_t open[ESK_ROOTS_MOST], left = count;
	for (size_t i = 0; i < count; i++)
		start_bracket(&roots[i], &brackets[i]);
	for (int round = 0; round < ROUNDS && left > 0; round++) {
		left = 0;
		for (size_t i = 0; i < count; i++)
			if (!brackets[i].settled) {
				place_on(&roots[i], brackets[i].part, open_points[left]);
				open[left++] = i;
			}
		field->values(field->context, left, (const double(*)[3])open_points, values);
		for (size_t i = 0; i < left; i++)
			narrow_bracket(&brackets[open[i]], values[i]);
	}
	for (size_t i = 0; i < count; i++)
		place_on(&roots[i], brackets[i].part, points[i]);
}
