/* Blocks of eight points, one a lane, a few blocks together. Terms of a blend below exp(-LEAST) of the greatest are left
 * out, which no double would show; a class with no other ones in these blocks costs its potential alone. */
#include "composition.h"

#include "elementary.h"

#include <math.h>
#include <string.h>

static const double least_exponent = 40; /* exp(-40) = 4e-18 */

void esk_composition_make(
	const eskel_primitive *primitives, uint32_t count, eskel_compose compose, esk_composition *composition)
{
	composition->compose = compose;
	composition->count = count;
	for (uint32_t i = 0; i < count; i++) {
		esk_form_make(&primitives[i], &composition->parts[i].form);
		composition->parts[i].alpha = primitives[i].alpha;
		composition->parts[i].algebraic = NULL;
	}
}

/* Blocks evaluated together, so that the steps of one fill the time in which others wait for theirs. */
enum { TOGETHER = 4, POINTS = TOGETHER * ESK_LANES };

/* Points of such blocks, the last one repeated in what is left of its block. How many blocks. */
static size_t load(size_t count, const double (*points)[3], esk_lanes loaded[TOGETHER][3])
{
	const size_t blocks = (count + ESK_LANES - 1) / ESK_LANES;
	for (size_t n = 0; n < blocks * ESK_LANES; n++)
		for (int i = 0; i < 3; i++)
			loaded[n / ESK_LANES][i][n % ESK_LANES] = points[n < count ? n : count - 1][i];
	return blocks;
}

static size_t left(size_t count, size_t first)
{
	return count - first < POINTS ? count - first : POINTS;
}

/* alpha, which a union has no use for. */
static double slope(const esk_composition *composition, uint32_t part)
{
	return composition->compose == ESKEL_COMPOSE_BLEND ? composition->parts[part].alpha : 1;
}

/* values *= alpha, least = min(least, values). */
ESK_EVERY_WIDTH static void scale(double alpha, size_t blocks, esk_lanes *values, esk_lanes *least)
{
	for (size_t b = 0; b < blocks; b++)
		ESK_EACH_LANE (l) {
			values[b][l] *= alpha;
			least[b][l] = values[b][l] < least[b][l] ? values[b][l] : least[b][l];
		}
}

/* Does the exponent of a class count anywhere? */
ESK_IN_LANES bool counts(size_t blocks, const esk_lanes *exponents, const esk_lanes *least)
{
	esk_lanes nearest;
	for (int l = 0; l < ESK_LANES; l++)
		nearest[l] = least_exponent;
	for (size_t b = 0; b < blocks; b++)
		ESK_EACH_LANE (l) {
			const double above = exponents[b][l] - least[b][l];
			nearest[l] = above < nearest[l] ? above : nearest[l];
		}
	bool any = false;
	for (int l = 0; l < ESK_LANES; l++)
		any |= nearest[l] < least_exponent;
	return any;
}

ESK_IN_LANES double term(double above_least)
{
	const double term = esk_elementary_exp_double(above_least < least_exponent ? -above_least : -least_exponent);
	return above_least < least_exponent ? term : 0;
}

/* Of exponents e_i = alpha_i d_i, those of a class side by side: d = least - ln sum exp(least - e_i). */
ESK_EVERY_WIDTH static void blend(
	uint32_t classes, size_t blocks, const esk_lanes *exponents, const esk_lanes *least, esk_lanes *values)
{
	esk_lanes sum[TOGETHER] = {{0}};
	for (uint32_t i = 0; i < classes; i++, exponents += blocks) {
		if (!counts(blocks, exponents, least))
			continue;
		for (size_t b = 0; b < blocks; b++)
			ESK_EACH_LANE (l)
				sum[b][l] += term(exponents[b][l] - least[b][l]);
	}
	for (size_t b = 0; b < blocks; b++)
		ESK_EACH_LANE (l)
			values[b][l] = least[b][l] - esk_elementary_log(sum[b][l]);
}

/* Leaves in the place of the exponents the weights exp(-e_i) / sum exp(-e_j). */
ESK_EVERY_WIDTH static void blend_and_weigh(
	uint32_t classes, size_t blocks, esk_lanes *exponents, const esk_lanes *least, esk_lanes *values)
{
	esk_lanes sum[TOGETHER] = {{0}};
	for (uint32_t i = 0; i < classes; i++)
		for (size_t b = 0; b < blocks; b++)
			ESK_EACH_LANE (l) {
				double *exponent = &exponents[i * blocks + b][l];
				*exponent = term(*exponent - least[b][l]);
				sum[b][l] += *exponent;
			}
	for (uint32_t i = 0; i < classes; i++)
		for (size_t b = 0; b < blocks; b++)
			ESK_EACH_LANE (l)
				exponents[i * blocks + b][l] /= sum[b][l];
	for (size_t b = 0; b < blocks; b++)
		ESK_EACH_LANE (l)
			values[b][l] = least[b][l] - esk_elementary_log(sum[b][l]);
}

/* Of a union: the first class of those that are least has the weight 1. */
static void weigh_first(uint32_t classes, size_t blocks, esk_lanes *exponents, const esk_lanes *least)
{
	for (size_t b = 0; b < blocks; b++)
		for (int l = 0; l < ESK_LANES; l++) {
			bool found = false;
			for (uint32_t i = 0; i < classes; i++) {
				double *exponent = &exponents[i * blocks + b][l];
				const bool is_first = !found && *exponent == least[b][l];
				*exponent = is_first ? 1 : 0;
				found = found || is_first;
			}
		}
}

/* From exponents to weights. */
static void weigh(const esk_composition *composition, size_t blocks, esk_lanes *exponents, const esk_lanes *least,
	esk_lanes *values)
{
	if (composition->compose == ESKEL_COMPOSE_BLEND) {
		blend_and_weigh(composition->count, blocks, exponents, least, values);
		return;
	}
	memcpy(values, least, blocks * sizeof *values);
	weigh_first(composition->count, blocks, exponents, least);
}

static void start(size_t blocks, esk_lanes *least)
{
	for (size_t b = 0; b < blocks; b++)
		for (int l = 0; l < ESK_LANES; l++)
			least[b][l] = INFINITY;
}

static void part_values(const esk_part *part, size_t blocks, const esk_lanes (*points)[3], esk_lanes *values)
{
	if (!part->algebraic)
		esk_form_values(&part->form, blocks, points, values);
	else
		for (size_t b = 0; b < blocks; b++)
			esk_algebraic_values(part->algebraic, points[b], values[b]);
}

static void part_gradients(
	const esk_part *part, size_t blocks, const esk_lanes (*points)[3], esk_lanes *values, esk_lanes (*gradients)[3])
{
	if (!part->algebraic)
		esk_form_gradients(&part->form, blocks, points, values, gradients);
	else
		for (size_t b = 0; b < blocks; b++)
			esk_algebraic_gradients(part->algebraic, points[b], values[b], gradients[b]);
}

static void find_values(
	const esk_composition *composition, size_t blocks, const esk_lanes (*points)[3], esk_lanes *values)
{
	esk_lanes exponents[ESKEL_LEVELS_MAX * TOGETHER], least[TOGETHER];
	start(blocks, least);
	for (uint32_t i = 0; i < composition->count; i++) {
		part_values(&composition->parts[i], blocks, points, exponents + i * blocks);
		scale(slope(composition, i), blocks, exponents + i * blocks, least);
	}
	if (composition->compose == ESKEL_COMPOSE_BLEND)
		blend(composition->count, blocks, (const esk_lanes *)exponents, (const esk_lanes *)least, values);
	else
		memcpy(values, least, blocks * sizeof *values);
}

ESK_EVERY_WIDTH static void add_gradients(
	double alpha, size_t blocks, const esk_lanes *weights, const esk_lanes (*parts)[3], esk_lanes (*gradients)[3])
{
	for (size_t b = 0; b < blocks; b++)
		for (int i = 0; i < 3; i++)
			ESK_EACH_LANE (l)
				gradients[b][i][l] += weights[b][l] * alpha * parts[b][i][l];
}

static void find_gradients(const esk_composition *composition, size_t blocks, const esk_lanes (*points)[3],
	esk_lanes *values, esk_lanes (*gradients)[3])
{
	esk_lanes weights[ESKEL_LEVELS_MAX * TOGETHER], least[TOGETHER], parts[ESKEL_LEVELS_MAX * TOGETHER][3];
	start(blocks, least);
	memset(gradients, 0, blocks * sizeof *gradients);
	for (uint32_t i = 0; i < composition->count; i++) {
		const size_t first = i * blocks;
		part_gradients(&composition->parts[i], blocks, points, weights + first, parts + first);
		scale(slope(composition, i), blocks, weights + first, least);
	}
	weigh(composition, blocks, weights, (const esk_lanes *)least, values);
	for (uint32_t i = 0; i < composition->count; i++)
		add_gradients(slope(composition, i), blocks, (const esk_lanes *)weights + i * blocks,
			(const esk_lanes(*)[3])(parts + i * blocks), gradients);
}

void esk_composition_values(const esk_composition *composition, size_t count, const double (*points)[3], double *values)
{
	esk_lanes loaded[TOGETHER][3], found[TOGETHER];
	for (size_t first = 0; first < count; first += POINTS) {
		const size_t here = left(count, first), blocks = load(here, points + first, loaded);
		find_values(composition, blocks, (const esk_lanes(*)[3])loaded, found);
		memcpy(values + first, found, here * sizeof *values);
	}
}

void esk_composition_gradients(const esk_composition *composition, size_t count, const double (*points)[3],
	double *values, double (*gradients)[3])
{
	esk_lanes loaded[TOGETHER][3], found[TOGETHER], found_gradients[TOGETHER][3];
	for (size_t first = 0; first < count; first += POINTS) {
		const size_t here = left(count, first), blocks = load(here, points + first, loaded);
		find_gradients(composition, blocks, (const esk_lanes(*)[3])loaded, found, found_gradients);
		if (values)
			memcpy(values + first, found, here * sizeof *values);
		for (size_t n = 0; n < here; n++)
			for (int i = 0; i < 3; i++)
				gradients[first + n][i] = found_gradients[n / ESK_LANES][i][n % ESK_LANES];
	}
}

double esk_composition_gradient(const esk_composition *composition, const double point[3], double gradient[3])
{
	double value;
	esk_composition_gradients(composition, 1, (const double(*)[3])point, &value, (double(*)[3])gradient);
	return value;
}

static void field_values(const void *context, size_t count, const double (*points)[3], double *values)
{
	esk_composition_values(context, count, points, values);
}

static double field_gradient(const void *context, const double point[3], double gradient[3])
{
	return esk_composition_gradient(context, point, gradient);
}

static void field_gradients(
	const void *context, size_t count, const double (*points)[3], double *values, double (*gradients)[3])
{
	esk_composition_gradients(context, count, points, values, gradients);
}

esk_field esk_composition_field(const esk_composition *composition)
{
	return (esk_field){.context = composition,
		.values = field_values,
		.gradient = field_gradient,
		.gradients = field_gradients};
}
