/* Most classes are too far from a strip to count there. What their potential is at least (strip.h) shows it, once the nearest
 * class is known, for a fraction of the cost of the potential. */
#include "blend.h"

#include "elementary.h"

#include <math.h>
#include <string.h>

/* Terms below exp(-40) of the greatest are left out, as in composition.c. One more leaves room for the rounding of floors. */
static const double least_exponent = 40, least_floor = 41;

static uint32_t nearest_class(const esk_composition *blend, const esk_strip points[3])
{
	uint32_t nearest = 0;
	double least = INFINITY;
	for (uint32_t i = 0; i < blend->count; i++) {
		const double *centre = blend->parts[i].form.centre;
		const double x = points[0][0] - centre[0], y = points[1][0] - centre[1], z = points[2][0] - centre[2];
		const double square = x * x + y * y + z * z;
		if (square < least) {
			least = square;
			nearest = i;
		}
	}
	return nearest;
}

ESK_EVERY_WIDTH static bool counts(double alpha, const esk_strip floor, const esk_strip least)
{
	esk_lanes nearest;
	for (int l = 0; l < ESK_LANES; l++)
		nearest[l] = INFINITY;
	for (int b = 0; b < ESK_STRIP; b += ESK_LANES)
		ESK_EACH_LANE (l) {
			const double above = alpha * floor[b + l] - least[b + l];
			nearest[l] = above < nearest[l] ? above : nearest[l];
		}
	bool any = false;
	for (int l = 0; l < ESK_LANES; l++)
		any |= nearest[l] < least_floor;
	return any;
}

/* From potentials to exponents. */
ESK_EVERY_WIDTH static void scale(double alpha, esk_strip exponents, esk_strip least)
{
	ESK_EACH_OF_STRIP (l) {
		exponents[l] *= alpha;
		least[l] = exponents[l] < least[l] ? exponents[l] : least[l];
	}
}

/* From exponents to terms of the sum. */
ESK_EVERY_WIDTH static void add_terms(esk_strip exponents, const esk_strip least, esk_strip sum)
{
	ESK_EACH_OF_STRIP (l) {
		const double above = exponents[l] - least[l];
		const double term = esk_elementary_exp_double(above < least_exponent ? -above : -least_exponent);
		exponents[l] = above < least_exponent ? term : 0;
		sum[l] += exponents[l];
	}
}

/* From terms to weights. */
ESK_EVERY_WIDTH static void weigh(
	double alpha, const esk_strip sum, const esk_strip part[3], esk_strip weights, esk_strip gradients[3])
{
	ESK_EACH_OF_STRIP (l) {
		weights[l] /= sum[l];
		for (int r = 0; r < 3; r++)
			gradients[r][l] += weights[l] * alpha * part[r][l];
	}
}

ESK_EVERY_WIDTH static void take_logarithms(const esk_strip least, const esk_strip sum, esk_strip values)
{
	ESK_EACH_OF_STRIP (l)
		values[l] = least[l] - esk_elementary_log(sum[l]);
}

/* Of the only class that counts: as above, where exp(0) is 1 and its logarithm 0. */
ESK_EVERY_WIDTH static void take_one(
	double alpha, const esk_strip part[3], esk_strip weights, esk_strip values, esk_strip gradients[3])
{
	ESK_EACH_OF_STRIP (l) {
		values[l] = weights[l];
		weights[l] = 1;
		for (int r = 0; r < 3; r++)
			gradients[r][l] = alpha * part[r][l];
	}
}

/* The classes that count, their exponents in the place of weights and their gradients; the least exponents. How many. */
static uint32_t find_classes(const esk_composition *blend, const esk_strip points[3], uint32_t *classes,
	esk_strip *weights, esk_strip (*parts)[3], esk_strip least)
{
	const uint32_t nearest = nearest_class(blend, points);
	uint32_t found = 0;
	esk_strip_place place;
	for (int l = 0; l < ESK_STRIP; l++)
		least[l] = INFINITY;
	for (uint32_t n = 0; n < blend->count; n++) {
		const uint32_t i = n == 0 ? nearest : n <= nearest ? n - 1 : n;
		const esk_part *part = &blend->parts[i];
		esk_strip_locate(&part->form, points, &place);
		if (!counts(part->alpha, place.floor, least)) {
			memset(weights[i], 0, sizeof weights[i]);
			continue;
		}
		esk_strip_gradients(&part->form, &place, weights[i], parts[found]);
		scale(part->alpha, weights[i], least);
		classes[found++] = i;
	}
	return found;
}

void esk_blend_evaluate(const esk_composition *blend, const esk_strip points[3], esk_strip values,
	esk_strip gradients[3], esk_strip *weights)
{
	esk_strip parts[ESKEL_LEVELS_MAX][3], least, sum = {0};
	uint32_t classes[ESKEL_LEVELS_MAX];
	const uint32_t found = find_classes(blend, points, classes, weights, parts, least);
	if (found == 1) {
		const uint32_t i = classes[0];
		take_one(blend->parts[i].alpha, (const esk_strip *)parts[0], weights[i], values, gradients);
		return;
	}
	memset(gradients, 0, 3 * sizeof *gradients);
	for (uint32_t n = 0; n < found; n++)
		add_terms(weights[classes[n]], least, sum);
	for (uint32_t n = 0; n < found; n++)
		weigh(blend->parts[classes[n]].alpha, sum, (const esk_strip *)parts[n], weights[classes[n]], gradients);
	take_logarithms(least, sum, values);
}
