/* A class that is far from a point adds nothing to the potential there (its weight is exp(-alpha d), and d grows with the
 * square of the distance), so it has no part in the point's row of the Jacobian, and J^T J is made of blocks of classes
 * that share points. A row is kept as the parts of its near classes; each block is then one task. Residuals that are 0
 * (hinges that hold, most of them) need no derivative at all. For 16 classes of 33 parameters at 10,800 points a step takes
 * 20 ms of one processor; MINPACK's, with a dense Jacobian, 2,300 ms without the derivatives.
 *
 * Points are taken by eight, in groups of neighbours, which share their near classes. Whatever the number of threads, each
 * number is computed by one task and every sum is in the order of the groups. */
#include "normal_equations.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of a class's weight at a point, in a sum of 1: what is left out of the derivatives is smaller than what the other terms of
 * Gauss and Newton's approximation leave out. */
static const double least_weight = 1e-4;

/* Groups are dealt out in so many parts, each with room of its own for derivatives: far more parts than threads. */
enum { PARTS = 16 };

struct esk_normal_equations {
	const esk_fit_points *points;
	esk_team *team;
	uint32_t class_count;
	size_t most;              /* parameters of a class */
	esk_derivatives *scratch; /* [PARTS][class_count] */
	esk_lanes *residuals;     /* [group] */
	double *costs;            /* [group] */
	bool *is_near;            /* [group][class_count] */
	esk_lanes *rows; /* [group][class_count][most]: J times the square root of the weight; of near classes only */
	/* The call's. */
	const esk_composition *composition;
	double length;
	size_t count;
	double *matrix, *vector;
};

static void *aligned_array(size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes) || bytes > PTRDIFF_MAX)
		return NULL;
	return aligned_alloc(_Alignof(esk_lanes), bytes);
}

eskel_status esk_normal_equations_new(const esk_fit_points *points, uint32_t class_count, size_t most_parameters,
	esk_team *team, esk_normal_equations **equations)
{
	esk_normal_equations *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	const size_t groups = points->group_count;
	*made = (esk_normal_equations){.points = points,
		.team = team,
		.class_count = class_count,
		.most = most_parameters,
		.scratch = aligned_array(PARTS * (size_t)class_count, sizeof *made->scratch),
		.residuals = aligned_array(groups, sizeof *made->residuals),
		.costs = esk_memory_array(groups, sizeof *made->costs),
		.is_near = esk_memory_array(groups * class_count, sizeof *made->is_near),
		.rows = aligned_array(groups * class_count * most_parameters, sizeof *made->rows)};
	if (!made->scratch || !made->residuals || !made->costs || !made->is_near || !made->rows) {
		esk_normal_equations_free(made);
		return ESKEL_NO_MEMORY;
	}
	*equations = made;
	return ESKEL_OK;
}

void esk_normal_equations_free(esk_normal_equations *equations)
{
	if (!equations)
		return;
	free(equations->scratch);
	free(equations->residuals);
	free(equations->costs);
	free(equations->is_near);
	free(equations->rows);
	free(equations);
}

/* The groups of a part. */
static size_t first_group(const esk_normal_equations *e, size_t part)
{
	return e->points->group_count * part / PARTS;
}

/* delta at eight points, and the square root in it. */
ESK_IN_LANES void saturate(const double *values, esk_lanes *gradients, double length, double *deltas, double *roots)
{
	ESK_EACH_LANE (l) {
		const double x = gradients[0][l], y = gradients[1][l], z = gradients[2][l], far = values[l] / length;
		roots[l] = sqrt(x * x + y * y + z * z + far * far + 1e-300);
		deltas[l] = values[l] / roots[l];
	}
}

/* Which way delta counts, and from where on. */
static double sign_of(esk_fit_kind kind)
{
	return kind == ESK_FIT_OUTSIDE ? -1 : 1;
}

static void measure_group(esk_normal_equations *e, size_t g)
{
	const esk_fit_group *group = &e->points->groups[g];
	double points[ESK_LANES][3], along[ESK_LANES][3];
	esk_lanes values, gradients[3], deltas, roots;
	for (int l = 0; l < ESK_LANES; l++)
		for (int r = 0; r < 3; r++)
			points[l][r] = group->points[r][l];
	esk_composition_gradients(e->composition, ESK_LANES, (const double(*)[3])points, values, along);
	for (int l = 0; l < ESK_LANES; l++)
		for (int r = 0; r < 3; r++)
			gradients[r][l] = along[l][r];
	saturate(values, gradients, e->length, deltas, roots);
	e->costs[g] = 0;
	for (int l = 0; l < ESK_LANES; l++) {
		double residual = sign_of(group->kind) * deltas[l] + group->margins[l];
		if (group->kind != ESK_FIT_BOUNDARY && residual < 0)
			residual = 0;
		e->residuals[g][l] = residual;
		e->costs[g] += group->weights[l] * residual * residual;
	}
}

static void measure_part(void *context, size_t part)
{
	esk_normal_equations *e = context;
	for (size_t g = first_group(e, part); g < first_group(e, part + 1); g++)
		measure_group(e, g);
}

double esk_normal_equations_measure(esk_normal_equations *equations, const esk_composition *composition, double length)
{
	equations->length = length;
	equations->composition = composition;
	esk_team_run(equations->team, PARTS, measure_part, equations);
	double sum = 0;
	for (size_t g = 0; g < equations->points->group_count; g++)
		sum += equations->costs[g];
	return sum;
}

static bool is_at_rest(const esk_normal_equations *e, size_t g)
{
	for (int l = 0; l < ESK_LANES; l++)
		if (e->residuals[g][l] != 0)
			return false;
	return true;
}

/* The derivative of delta by a parameter: with d', grad d' those of d and its gradient,
 * d' / root - d (grad d . grad d' + d d' / L^2) / root^3. */
ESK_EVERY_WIDTH static void derive_residuals(const esk_derivatives *by, size_t count, const double *values,
	esk_lanes *gradients, const double *roots, const double *factors, double length, esk_lanes *rows)
{
	for (size_t p = 0; p < count; p++)
		ESK_EACH_LANE (l) {
			const double turning = gradients[0][l] * by->gradient_by[p][0][l] +
					       gradients[1][l] * by->gradient_by[p][1][l] +
					       gradients[2][l] * by->gradient_by[p][2][l] +
					       values[l] * by->value_by[p][l] / (length * length);
			rows[p][l] = factors[l] * (by->value_by[p][l] - values[l] * turning / (roots[l] * roots[l])) /
				     roots[l];
		}
}

static void derive_group(esk_normal_equations *e, size_t g, esk_derivatives *scratch)
{
	const esk_fit_group *group = &e->points->groups[g];
	bool *is_near = &e->is_near[g * e->class_count];
	memset(is_near, 0, e->class_count * sizeof *is_near);
	if (is_at_rest(e, g))
		return;
	esk_lanes values, gradients[3], deltas, roots, factors;
	esk_composition_derive(
		e->composition, group->points, e->count, least_weight, values, gradients, is_near, scratch);
	saturate(values, gradients, e->length, deltas, roots);
	for (int l = 0; l < ESK_LANES; l++)
		factors[l] = e->residuals[g][l] != 0 ? sign_of(group->kind) * sqrt(group->weights[l]) : 0;
	for (uint32_t i = 0; i < e->class_count; i++)
		if (is_near[i])
			derive_residuals(&scratch[i], e->count, values, gradients, roots, factors, e->length,
				&e->rows[(g * e->class_count + i) * e->most]);
}

static void derive_part(void *context, size_t part)
{
	esk_normal_equations *e = context;
	for (size_t g = first_group(e, part); g < first_group(e, part + 1); g++)
		derive_group(e, g, &e->scratch[part * e->class_count]);
}

ESK_EVERY_WIDTH static void add_products(esk_lanes *a, esk_lanes *b, size_t count, esk_lanes *sums)
{
	for (size_t p = 0; p < count; p++)
		for (size_t q = 0; q < count; q++)
			ESK_EACH_LANE (l)
				sums[p * count + q][l] += a[p][l] * b[q][l];
}

static double sum_lanes(const double *lanes)
{
	return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/* The block of classes i and j >= i. */
static void add_block(esk_normal_equations *e, uint32_t i, uint32_t j)
{
	esk_lanes sums[ESK_PARAMETERS_ALL * ESK_PARAMETERS_ALL];
	const size_t n = e->class_count * e->count;
	memset(sums, 0, e->count * e->count * sizeof *sums);
	for (size_t g = 0; g < e->points->group_count; g++)
		if (e->is_near[g * e->class_count + i] && e->is_near[g * e->class_count + j])
			add_products(&e->rows[(g * e->class_count + i) * e->most],
				&e->rows[(g * e->class_count + j) * e->most], e->count, sums);
	for (size_t p = 0; p < e->count; p++)
		for (size_t q = 0; q < e->count; q++)
			e->matrix[(i * e->count + p) * n + j * e->count + q] = sum_lanes(sums[p * e->count + q]);
}

static void add_vector(esk_normal_equations *e, uint32_t i)
{
	for (size_t p = 0; p < e->count; p++) {
		double sum = 0;
		for (size_t g = 0; g < e->points->group_count; g++)
			if (e->is_near[g * e->class_count + i])
				for (int l = 0; l < ESK_LANES; l++)
					sum += e->rows[(g * e->class_count + i) * e->most + p][l] *
					       sqrt(e->points->groups[g].weights[l]) * e->residuals[g][l];
		e->vector[i * e->count + p] = sum;
	}
}

/* Pairs i <= j in the order of j. */
static void add_pair(void *context, size_t pair)
{
	esk_normal_equations *e = context;
	uint32_t j = 0;
	for (; pair > j; j++)
		pair -= j + 1;
	add_block(e, (uint32_t)pair, j);
	if (pair == j)
		add_vector(e, j);
}

void esk_normal_equations_derive(esk_normal_equations *equations, size_t count, double *matrix, double *vector)
{
	const size_t classes = equations->class_count;
	equations->count = count;
	equations->matrix = matrix;
	equations->vector = vector;
	esk_team_run(equations->team, PARTS, derive_part, equations);
	esk_team_run(equations->team, classes * (classes + 1) / 2, add_pair, equations);
}

const double *esk_normal_equations_residuals(const esk_normal_equations *equations, size_t group)
{
	return equations->residuals[group];
}
