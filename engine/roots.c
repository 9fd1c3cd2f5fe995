#include "roots.h"

#include <math.h>
#include <stdbool.h>

enum { ROUNDS = 12 }; /* of regula falsi: each gains a digit at least, most surfaces need two or three */

/* Of an edge: the next error is small beside the last change. */
static const double settled_change = 1e-4;

/* A stretch of an edge, in parts of the way from inside to outside, with values at its ends. */
typedef struct {
	double lower, upper, lower_value, upper_value;
	double part; /* where the surface is, as far as is known */
	int kept;    /* -1 or 1: the lower or the upper end was kept last */
	bool settled;
} bracket;

static double interpolate(const bracket *b)
{
	const double part = b->lower + (b->upper - b->lower) * (b->lower_value / (b->lower_value - b->upper_value));
	/* Not where a value is not finite, or so near to 0 that an end would come out. */
	return part > b->lower && part < b->upper ? part : (b->lower + b->upper) / 2;
}

static void start_bracket(const esk_root *root, bracket *b)
{
	*b = (bracket){.upper = 1, .lower_value = root->inside_value, .upper_value = root->outside_value};
	/* An outer end may lie on the surface. */
	b->settled = b->upper_value == 0;
	b->part = b->settled ? 1 : interpolate(b);
}

/* One round of the Illinois variant of regula falsi (Dowell and Jarratt 1971): the value at an end kept twice is halved. */
static void narrow_bracket(bracket *b, double value)
{
	const double last = b->part;
	if (value < 0) {
		b->lower = b->part;
		b->lower_value = value;
		b->upper_value *= b->kept == 1 ? 0.5 : 1;
		b->kept = 1;
	} else {
		b->upper = b->part;
		b->upper_value = value;
		b->lower_value *= b->kept == -1 ? 0.5 : 1;
		b->kept = -1;
	}
	if (value != 0)
		b->part = interpolate(b);
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
