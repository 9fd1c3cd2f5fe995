/* With the weights w_i of a blend (composition.h), for a parameter t of class i
 *	dd/dt       = w_i alpha_i dd_i/dt,
 *	d grad d/dt = w_i alpha_i (d grad d_i/dt - dd_i/dt (alpha_i grad d_i - grad d)),
 * and for alpha_i the same with d_i / alpha_i and grad d_i / alpha_i in the place of the derivatives of d_i and grad d_i.
 *
 * A class that is far from a point adds nothing to the potential there (its weight is exp(-alpha d), and d grows with the
 * square of the distance), so it has no part in the point's row of the Jacobian, and J^T J is made of blocks of classes
 * that share points. A row is kept as the parts of its near classes; each block is then one task. Residuals that are 0
 * (hinges that hold, most of them) need no derivative at all. For 16 classes of 33 parameters at 10,800 points a step takes
 * 20 ms of one processor; MINPACK's, with a dense Jacobian, 2,300 ms without the derivatives.
 *
 * Points are taken by eight, in groups of neighbours, which share their near classes, and measured by strips of eight groups.
 * Whatever the number of threads, each number is computed by one task and every sum is in the order of groups or strips. */
#include "normal_equations.h"

#include "blend.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of a class's weight at a point, in a sum of 1: what is left out of the derivatives is smaller than what the other terms of
 * Gauss and Newton's approximation leave out. */
static const double least_weight = 1e-4;

/* Groups are dealt out in so many parts, each with room of its own for derivatives: far more parts than threads. */
enum { PARTS = 16 };

/* Eight groups; the last one repeated, without weight, where there are no more. */
typedef struct {
	/* Which way delta counts, from where on, and the least residual: 0 where being on the right side is enough. */
	esk_strip points[3], signs, margins, least, weights, root_weights;
	/* Of the blend that was measured last. */
	esk_strip values, gradients[3], roots /* the root in delta */, residuals;
} strip;

struct esk_normal_equations {
	const esk_fit_points *points;
	esk_team *team;
	uint32_t class_count;
	size_t most; /* parameters of a class */
	size_t strip_count;
	strip *strips;
	esk_strip *weights;       /* [strip][class_count], of classes */
	double *costs;            /* [strip] */
	esk_derivatives *scratch; /* [PARTS] */
	bool *is_near;            /* [group][class_count] */
	esk_lanes *weighted;      /* [group]: residuals times the square root of the weight */
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

static void load(const esk_fit_group *group, bool is_there, strip *to, int first)
{
	for (int l = 0; l < ESK_LANES; l++) {
		for (int r = 0; r < 3; r++)
			to->points[r][first + l] = group->points[r][l];
		to->signs[first + l] = group->kind == ESK_FIT_OUTSIDE ? -1 : 1;
		to->margins[first + l] = group->margins[l];
		to->least[first + l] = group->kind == ESK_FIT_BOUNDARY ? -INFINITY : 0;
		to->weights[first + l] = is_there ? group->weights[l] : 0;
		to->root_weights[first + l] = sqrt(to->weights[first + l]);
	}
}

static void load_all(esk_normal_equations *e)
{
	const size_t last = e->points->group_count - 1;
	for (size_t g = 0; g < e->strip_count * ESK_STRIP_BLOCKS; g++)
		load(&e->points->groups[g < last ? g : last], g <= last, &e->strips[g / ESK_STRIP_BLOCKS],
			(int)(g % ESK_STRIP_BLOCKS) * ESK_LANES);
}

eskel_status esk_normal_equations_new(const esk_fit_points *points, uint32_t class_count, size_t most_parameters,
	esk_team *team, esk_normal_equations **equations)
{
	esk_normal_equations *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	const size_t groups = points->group_count, strips = (groups + ESK_STRIP_BLOCKS - 1) / ESK_STRIP_BLOCKS;
	*made = (esk_normal_equations){.points = points,
		.team = team,
		.class_count = class_count,
		.most = most_parameters,
		.strip_count = strips,
		.strips = aligned_array(strips, sizeof *made->strips),
		.weights = aligned_array(strips * class_count, sizeof *made->weights),
		.costs = esk_memory_array(strips, sizeof *made->costs),
		.scratch = aligned_array(PARTS, sizeof *made->scratch),
		.is_near = esk_memory_array(groups * class_count, sizeof *made->is_near),
		.weighted = aligned_array(groups, sizeof *made->weighted),
		.rows = aligned_array(groups * class_count * most_parameters, sizeof *made->rows)};
	if (!made->strips || !made->weights || !made->costs || !made->scratch || !made->is_near || !made->weighted ||
		!made->rows) {
		esk_normal_equations_free(made);
		return ESKEL_NO_MEMORY;
	}
	load_all(made);
	*equations = made;
	return ESKEL_OK;
}

void esk_normal_equations_free(esk_normal_equations *equations)
{
	if (!equations)
		return;
	free(equations->strips);
	free(equations->weights);
	free(equations->costs);
	free(equations->scratch);
	free(equations->is_near);
	free(equations->weighted);
	free(equations->rows);
	free(equations);
}

/* The strips of a part, and its groups. */
static size_t first_strip(const esk_normal_equations *e, size_t part)
{
	return e->strip_count * part / PARTS;
}

static size_t first_group(const esk_normal_equations *e, size_t part)
{
	const size_t first = first_strip(e, part) * ESK_STRIP_BLOCKS;
	return first < e->points->group_count ? first : e->points->group_count;
}

static double sum_lanes(const double *lanes)
{
	return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/* From values and gradients to residuals; the squares, a sum in each lane. */
ESK_EVERY_WIDTH static void take_residuals(strip *s, double length, esk_lanes squares)
{
	ESK_EACH_OF_STRIP (l) {
		const double x = s->gradients[0][l], y = s->gradients[1][l], z = s->gradients[2][l];
		const double far = s->values[l] / length;
		s->roots[l] = sqrt(x * x + y * y + z * z + far * far + 1e-300);
		const double residual = s->signs[l] * (s->values[l] / s->roots[l]) + s->margins[l];
		s->residuals[l] = residual > s->least[l] ? residual : s->least[l];
	}
	for (int b = 0; b < ESK_STRIP; b += ESK_LANES)
		ESK_EACH_LANE (l)
			squares[l] += s->weights[b + l] * s->residuals[b + l] * s->residuals[b + l];
}

/* The squares of a strip's residuals. */
static double measure_strip(const esk_composition *blend, double length, strip *s, esk_strip *weights)
{
	esk_lanes squares = {0};
	esk_blend_evaluate(blend, (const esk_strip *)s->points, s->values, s->gradients, weights);
	take_residuals(s, length, squares);
	return sum_lanes(squares);
}

static void measure_part(void *context, size_t part)
{
	esk_normal_equations *e = context;
	for (size_t n = first_strip(e, part); n < first_strip(e, part + 1); n++)
		e->costs[n] = measure_strip(e->composition, e->length, &e->strips[n], &e->weights[n * e->class_count]);
}

double esk_normal_equations_measure(esk_normal_equations *equations, const esk_composition *composition, double length)
{
	equations->length = length;
	equations->composition = composition;
	esk_team_run(equations->team, PARTS, measure_part, equations);
	double sum = 0;
	for (size_t n = 0; n < equations->strip_count; n++)
		sum += equations->costs[n];
	return sum;
}

double esk_normal_equations_measure_below(
	esk_normal_equations *equations, const esk_composition *composition, double length, double most)
{
	double sum = 0;
	for (size_t n = 0; n < equations->strip_count && sum < most; n++)
		sum += measure_strip(
			composition, length, &equations->strips[n], &equations->weights[n * equations->class_count]);
	return sum;
}

const double *esk_normal_equations_residuals(const esk_normal_equations *equations, size_t group)
{
	return &equations->strips[group / ESK_STRIP_BLOCKS].residuals[group % ESK_STRIP_BLOCKS * ESK_LANES];
}

static bool is_any_at_least(const double *weights, double least)
{
	bool any = false;
	for (int l = 0; l < ESK_LANES; l++)
		any |= weights[l] >= least;
	return any;
}

/* With d' and grad d' the derivatives by a parameter, that of delta is d' / root - d (grad d . grad d' + d d' / L^2) / root^3.
 * Put in from above, it is own d_i' + along (grad d . grad d_i'). At the eight points of a strip from first on. */
ESK_EVERY_WIDTH static void derive_residuals(const strip *s, int first, double length, double alpha,
	const double *weights, size_t count, esk_derivatives *by, esk_lanes *rows)
{
	esk_lanes x, y, z, own, along;
	ESK_EACH_LANE (l) {
		const int n = first + l;
		x[l] = s->gradients[0][n];
		y[l] = s->gradients[1][n];
		z[l] = s->gradients[2][n];
		const double factor = s->residuals[n] != 0 ? s->signs[n] * s->root_weights[n] : 0;
		const double straight = weights[n] * alpha * factor / s->roots[n];
		const double turning = straight * s->values[n] / (s->roots[n] * s->roots[n]);
		const double part = x[l] * by->gradient[0][l] + y[l] * by->gradient[1][l] + z[l] * by->gradient[2][l];
		const double whole = x[l] * x[l] + y[l] * y[l] + z[l] * z[l];
		own[l] = straight - turning * (s->values[n] / (length * length) + whole - alpha * part);
		along[l] = -turning;
		by->value_by[ESK_ALPHA][l] = by->value[l] / alpha;
		for (int r = 0; r < 3; r++)
			by->gradient_by[ESK_ALPHA][r][l] = by->gradient[r][l] / alpha;
	}
	for (size_t p = 0; p < count; p++)
		ESK_EACH_LANE (l) {
			const double slope = x[l] * by->gradient_by[p][0][l] + y[l] * by->gradient_by[p][1][l] +
					     z[l] * by->gradient_by[p][2][l];
			rows[p][l] = own[l] * by->value_by[p][l] + along[l] * slope;
		}
}

/* False where all residuals are 0. */
static bool weigh_residuals(const strip *s, int first, double *weighted)
{
	bool any = false;
	for (int l = 0; l < ESK_LANES; l++) {
		any |= s->residuals[first + l] != 0;
		weighted[l] = s->root_weights[first + l] * s->residuals[first + l];
	}
	return any;
}

static void derive_group(esk_normal_equations *e, size_t g, esk_derivatives *scratch)
{
	const size_t n = g / ESK_STRIP_BLOCKS;
	const int first = (int)(g % ESK_STRIP_BLOCKS) * ESK_LANES;
	const bool is_needed = weigh_residuals(&e->strips[n], first, e->weighted[g]);
	for (uint32_t i = 0; i < e->class_count; i++) {
		const double *weights = e->weights[n * e->class_count + i];
		bool *near = &e->is_near[g * e->class_count + i];
		const esk_part *part = &e->composition->parts[i];
		*near = is_needed && is_any_at_least(weights + first, least_weight);
		if (!*near)
			continue;
		esk_form_derive(&part->form, (const esk_lanes *)e->points->groups[g].points, e->count, scratch);
		derive_residuals(&e->strips[n], first, e->length, part->alpha, weights, e->count, scratch,
			&e->rows[(g * e->class_count + i) * e->most]);
	}
}

static void derive_part(void *context, size_t part)
{
	esk_normal_equations *e = context;
	for (size_t g = first_group(e, part); g < first_group(e, part + 1); g++)
		derive_group(e, g, &e->scratch[part]);
}

/* The rows of two classes at some groups at once, which share the loads and stores of sums. */
enum { AT_ONCE = 4 };

typedef struct {
	size_t count, first_count, second_count;
	const esk_lanes *first[AT_ONCE], *second[AT_ONCE];
	esk_lanes *sums; /* [first_count][second_count] */
	bool is_square;  /* the same class twice: the upper triangle is enough */
} products;

ESK_EVERY_WIDTH static void add_products(const products *s)
{
	for (size_t p = 0; p < s->first_count; p++)
		for (size_t q = s->is_square ? p : 0; q < s->second_count; q++)
			ESK_EACH_LANE (l) {
				double sum = s->sums[p * s->second_count + q][l];
				sum += s->first[0][p][l] * s->second[0][q][l];
				sum += s->first[1][p][l] * s->second[1][q][l];
				sum += s->first[2][p][l] * s->second[2][q][l];
				sum += s->first[3][p][l] * s->second[3][q][l];
				s->sums[p * s->second_count + q][l] = sum;
			}
}

static const esk_lanes no_rows[ESK_PARAMETERS_ALL];

/* NULL: the last ones. */
static void add(products *s, const esk_lanes *first, const esk_lanes *second)
{
	for (; s->count < AT_ONCE; first = NULL) {
		s->first[s->count] = first ? first : no_rows;
		s->second[s->count++] = first ? second : no_rows;
		if (first && s->count < AT_ONCE)
			return;
	}
	add_products(s);
	s->count = 0;
}

static const esk_lanes *rows_of(const esk_normal_equations *e, size_t g, uint32_t i)
{
	return (const esk_lanes *)&e->rows[(g * e->class_count + i) * e->most];
}

static bool is_near(const esk_normal_equations *e, size_t g, uint32_t i)
{
	return e->is_near[g * e->class_count + i];
}

/* The block of classes i and j >= i. */
static void add_block(esk_normal_equations *e, uint32_t i, uint32_t j)
{
	esk_lanes sums[ESK_PARAMETERS_ALL * ESK_PARAMETERS_ALL];
	products s = {.first_count = e->count, .second_count = e->count, .sums = sums, .is_square = i == j};
	const size_t n = e->class_count * e->count;
	memset(sums, 0, e->count * e->count * sizeof *sums);
	for (size_t g = 0; g < e->points->group_count; g++)
		if (is_near(e, g, i) && is_near(e, g, j))
			add(&s, rows_of(e, g, i), rows_of(e, g, j));
	add(&s, NULL, NULL);
	for (size_t p = 0; p < e->count; p++)
		for (size_t q = s.is_square ? p : 0; q < e->count; q++)
			e->matrix[(i * e->count + p) * n + j * e->count + q] = sum_lanes(sums[p * e->count + q]);
}

static void add_vector(esk_normal_equations *e, uint32_t i)
{
	esk_lanes sums[ESK_PARAMETERS_ALL] = {{0}};
	products s = {.first_count = e->count, .second_count = 1, .sums = sums};
	for (size_t g = 0; g < e->points->group_count; g++)
		if (is_near(e, g, i))
			add(&s, rows_of(e, g, i), (const esk_lanes *)&e->weighted[g]);
	add(&s, NULL, NULL);
	for (size_t p = 0; p < e->count; p++)
		e->vector[i * e->count + p] = sum_lanes(sums[p]);
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
