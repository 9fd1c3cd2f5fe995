/* Blocks of eight points, one a lane. Terms of a blend below exp(-LEAST) of the greatest are left out, which no double would
 * show; a class with no other ones in a block costs its potential alone. */
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

/* Points from first on; those after the last repeat it. */
static void load(size_t count, const double (*points)[3], size_t first, esk_lanes point[3])
{
	for (size_t l = 0; l < ESK_LANES; l++) {
		const double *from = points[first + l < count ? first + l : count - 1];
		for (int i = 0; i < 3; i++)
			point[i][l] = from[i];
	}
}

static size_t left(size_t count, size_t first)
{
	return count - first < ESK_LANES ? count - first : ESK_LANES;
}

/* alpha, which a union has no use for. */
static double slope(const esk_composition *composition, uint32_t part)
{
	return composition->compose == ESKEL_COMPOSE_BLEND ? composition->parts[part].alpha : 1;
}

/* values *= alpha, least = min(least, values). */
ESK_EVERY_WIDTH static void scale(double alpha, esk_lanes values, esk_lanes least)
{
	ESK_EACH_LANE (l) {
		values[l] *= alpha;
		least[l] = values[l] < least[l] ? values[l] : least[l];
	}
}

/* Does the exponent count in any lane? */
ESK_IN_LANES bool counts(const esk_lanes exponent, const esk_lanes least)
{
	double nearest = exponent[0] - least[0];
	for (int l = 1; l < ESK_LANES; l++)
		nearest = exponent[l] - least[l] < nearest ? exponent[l] - least[l] : nearest;
	return nearest < least_exponent;
}

ESK_IN_LANES double term(double above_least)
{
	const double term = esk_elementary_exp_double(above_least < least_exponent ? -above_least : -least_exponent);
	return above_least < least_exponent ? term : 0;
}

/* Of exponents e_i = alpha_i d_i: d = least - ln sum exp(least - e_i). */
ESK_EVERY_WIDTH static void blend(const esk_lanes *exponents, uint32_t count, const esk_lanes least, esk_lanes values)
{
	esk_lanes sum = {0};
	for (uint32_t i = 0; i < count; i++) {
		if (!counts(exponents[i], least))
			continue;
		ESK_EACH_LANE (l)
			sum[l] += term(exponents[i][l] - least[l]);
	}
	ESK_EACH_LANE (l)
		values[l] = least[l] - esk_elementary_log(sum[l]);
}

/* Leaves in the place of the exponents the weights exp(-e_i) / sum exp(-e_j). */
ESK_EVERY_WIDTH static void blend_and_weigh(
	esk_lanes *exponents, uint32_t count, const esk_lanes least, esk_lanes values)
{
	esk_lanes sum = {0};
	for (uint32_t i = 0; i < count; i++)
		ESK_EACH_LANE (l) {
			exponents[i][l] = term(exponents[i][l] - least[l]);
			sum[l] += exponents[i][l];
		}
	for (uint32_t i = 0; i < count; i++)
		ESK_EACH_LANE (l)
			exponents[i][l] /= sum[l];
	ESK_EACH_LANE (l)
		values[l] = least[l] - esk_elementary_log(sum[l]);
}

/* Of a union: the first class of those that are least has the weight 1. */
static void weigh_first(esk_lanes *exponents, uint32_t count, const esk_lanes least)
{
	for (int l = 0; l < ESK_LANES; l++) {
		bool found = false;
		for (uint32_t i = 0; i < count; i++) {
			const bool is_first = !found && exponents[i][l] == least[l];
			exponents[i][l] = is_first ? 1 : 0;
			found = found || is_first;
		}
	}
}

/* From exponents to weights. */
static void weigh(const esk_composition *composition, esk_lanes *exponents, const esk_lanes least, esk_lanes values)
{
	if (composition->compose == ESKEL_COMPOSE_BLEND) {
		blend_and_weigh(exponents, composition->count, least, values);
		return;
	}
	memcpy(values, least, sizeof(esk_lanes));
	weigh_first(exponents, composition->count, least);
}

static void start(esk_lanes least)
{
	for (int l = 0; l < ESK_LANES; l++)
		least[l] = INFINITY;
}

static void block_values(const esk_composition *composition, const esk_lanes point[3], esk_lanes values)
{
	esk_lanes exponents[ESKEL_LEVELS_MAX], least;
	start(least);
	for (uint32_t i = 0; i < composition->count; i++) {
		const esk_part *part = &composition->parts[i];
		if (part->algebraic)
			esk_algebraic_values(part->algebraic, point, exponents[i]);
		else
			esk_form_values(&part->form, point, exponents[i]);
		scale(slope(composition, i), exponents[i], least);
	}
	if (composition->compose == ESKEL_COMPOSE_BLEND)
		blend((const esk_lanes *)exponents, composition->count, least, values);
	else
		memcpy(values, least, sizeof(esk_lanes));
}

ESK_EVERY_WIDTH static void add_gradient(
	double alpha, const esk_lanes weights, const esk_lanes part[3], esk_lanes gradients[3])
{
	for (int i = 0; i < 3; i++)
		ESK_EACH_LANE (l)
			gradients[i][l] += weights[l] * alpha * part[i][l];
}

static void block_gradients(
	const esk_composition *composition, const esk_lanes point[3], esk_lanes values, esk_lanes gradients[3])
{
	esk_lanes weights[ESKEL_LEVELS_MAX], least, parts[ESKEL_LEVELS_MAX][3];
	start(least);
	memset(gradients, 0, 3 * sizeof(esk_lanes));
	for (uint32_t i = 0; i < composition->count; i++) {
		const esk_part *part = &composition->parts[i];
		if (part->algebraic)
			esk_algebraic_gradients(part->algebraic, point, weights[i], parts[i]);
		else
			esk_form_gradients(&part->form, point, weights[i], parts[i]);
		scale(slope(composition, i), weights[i], least);
	}
	weigh(composition, weights, least, values);
	for (uint32_t i = 0; i < composition->count; i++)
		add_gradient(slope(composition, i), weights[i], (const esk_lanes *)parts[i], gradients);
}

void esk_composition_values(const esk_composition *composition, size_t count, const double (*points)[3], double *values)
{
	esk_lanes point[3], block;
	for (size_t first = 0; first < count; first += ESK_LANES) {
		load(count, points, first, point);
		block_values(composition, (const esk_lanes *)point, block);
		memcpy(values + first, block, left(count, first) * sizeof *values);
	}
}

void esk_composition_gradients(const esk_composition *composition, size_t count, const double (*points)[3],
	double *values, double (*gradients)[3])
{
	esk_lanes point[3], block, block_gradient[3];
	for (size_t first = 0; first < count; first += ESK_LANES) {
		const size_t here = left(count, first);
		load(count, points, first, point);
		block_gradients(composition, (const esk_lanes *)point, block, block_gradient);
		if (values)
			memcpy(values + first, block, here * sizeof *values);
		for (size_t l = 0; l < here; l++)
			for (int i = 0; i < 3; i++)
				gradients[first + l][i] = block_gradient[i][l];
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

static void field_gradients(const void *context, size_t count, const double (*points)[3], double (*gradients)[3])
{
	esk_composition_gradients(context, count, points, NULL, gradients);
}

esk_field esk_composition_field(const esk_composition *composition)
{
	return (esk_field){.context = composition,
		.values = field_values,
		.gradient = field_gradient,
		.gradients = field_gradients};
}
