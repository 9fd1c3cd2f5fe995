/* The paper fits each primitive to the boundary of its own class, then the alphas. But the blend of primitives that fit is
 * thicker than any of them, and where two classes meet neither has a boundary, so primitives fall apart there: on eight bones
 * Dice fell by 0.2. Here every parameter of every class is fitted to the blend itself, from the plain ellipsoids, first
 * without exponents, which are smooth, then with these, then with further modes.
 *
 * Steps are Levenberg and Marquardt's, damped as in Nielsen (1999), from the full derivative of the residual, that of |grad d|
 * included: frozen, descent stalls at twice the cost. Parameters stay between bounds: one that a step would take beyond
 * stops there, and is left out of steps as long as descent leads outward. A weak pull towards the start (1e-3 h^2 / k on
 * the square of each, without unit) settles what points leave open.
 *
 * The equations are solved by our own Cholesky factors: LAPACK's differ in last bits from library to library, and the fit
 * with them. */
#include "joint_fit.h"

#include "elementary.h"
#include "memory.h"
#include "normal_equations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pull = 1e-3;
/* Radii from the start's: e^-1.5 to e^1.2. */
static const double log_radius_range[2] = {-1.5, 1.2};
static const double exponent_range[2] = {0.2, 1.8};
/* Free alphas drift to 0.05, and primitives no longer describe their class; this costs a tenth of the error. */
static const double alpha_range[2] = {0.5, 10};
static const double taper_most = 1.2, bend_most = 1, twist_most = 1.5, further_most = 0.8;

/* How much farther residuals reach at first, the second time: beyond the whole, and less and less (graduated non-convexity,
 * Blake and Zisserman 1987). From 10 at once a femur at k = 6 ended at three times the least cost for some samples of points;
 * so it did from 3, 30 or 100, with fewer steps at each, or with the modes held at first. */
static const double far_reaches[] = {30, 10, 3};

enum { STAGES = 3, FAR_RUNS = sizeof far_reaches / sizeof *far_reaches };
static const uint32_t stage_steps[STAGES] = {80, 60, 60};

/* A stage ends when PATIENCE steps together gain less than this share. */
static const double least_gain = 1e-3;
enum { PATIENCE = 5 };

typedef struct {
	size_t count; /* parameters of a class */
	bool is_free[ESK_PARAMETERS_ALL];
	uint32_t steps;
	double reach; /* the length at which residuals saturate, in those of the points */
} stage;

typedef struct {
	const esk_joint_options *options;
	uint32_t count;
	const eskel_primitive *origin;
	double length;
	esk_normal_equations *equations;
	size_t parameters; /* of all classes, in the present stage */
	double *matrix, *factor, *vector, *step;
	bool *is_held;
	eskel_primitive now[ESKEL_LEVELS_MAX], next[ESKEL_LEVELS_MAX];
	esk_composition composition;
	double cost;
	uint32_t steps_done, steps_all;
} work;

static int mode_of(size_t p)
{
	return p < ESK_ALPHA ? (int)p - ESK_FIRST_MODES : (int)p - ESK_FURTHER_MODES + ESK_FIRST_MODE_COUNT;
}

/* A parameter as the prior and the bounds see it. Translations are in units of the radii; rotations are not seen. */
static double value_of(const eskel_primitive *origin, const eskel_primitive *now, size_t p)
{
	if (p < ESK_ROTATION) {
		double sum = 0;
		for (int r = 0; r < 3; r++)
			sum += now->axes[p][r] * (now->centre[r] - origin->centre[r]);
		return sum / origin->radii[2];
	}
	if (p < ESK_LOG_RADII)
		return 0;
	if (p < ESK_FIRST_MODES)
		return esk_elementary_log(now->radii[p - ESK_LOG_RADII] / origin->radii[p - ESK_LOG_RADII]);
	if (p == ESK_ALPHA)
		return now->alpha;
	if (p >= ESK_EXPONENTS && p < ESK_FURTHER_MODES)
		return now->exponents[p - ESK_EXPONENTS];
	return now->modes[mode_of(p)];
}

/* Where the pull leads, and how a step of 1 changes the value. */
static double target_of(size_t p)
{
	return p == ESK_ALPHA || (p >= ESK_EXPONENTS && p < ESK_FURTHER_MODES) ? 1 : 0;
}

static double scale_of(const eskel_primitive *origin, size_t p)
{
	return p < ESK_ROTATION ? 1 / origin->radii[2] : p < ESK_LOG_RADII ? 0 : 1;
}

void esk_joint_bounds(size_t p, double bounds[2])
{
	double most = further_most;
	const double *range = NULL;
	if (p < ESK_LOG_RADII)
		most = INFINITY;
	else if (p < ESK_FIRST_MODES)
		range = log_radius_range;
	else if (p == ESK_ALPHA)
		range = alpha_range;
	else if (p >= ESK_EXPONENTS && p < ESK_FURTHER_MODES)
		range = exponent_range;
	else if (mode_of(p) <= ESKEL_MODE_TAPER_Y)
		most = taper_most;
	else if (mode_of(p) <= ESKEL_MODE_BEND_Y)
		most = bend_most;
	else if (mode_of(p) == ESKEL_MODE_TWIST)
		most = twist_most;
	bounds[0] = range ? range[0] : -most;
	bounds[1] = range ? range[1] : most;
}

static double pull_weight(const work *w)
{
	return pull * w->options->spacing * w->options->spacing / w->count;
}

static double pull_cost(const work *w, const eskel_primitive *primitives, size_t count)
{
	double sum = 0;
	for (uint32_t i = 0; i < w->count; i++)
		for (size_t p = 0; p < count; p++) {
			const double off = value_of(&w->origin[i], &primitives[i], p) - target_of(p);
			if (p < ESK_ROTATION || p >= ESK_LOG_RADII)
				sum += off * off;
		}
	return pull_weight(w) * sum;
}

static double measure(work *w, const eskel_primitive *primitives, const stage *s)
{
	esk_composition_make(primitives, w->count, ESKEL_COMPOSE_BLEND, &w->composition);
	return esk_normal_equations_measure(w->equations, &w->composition, s->reach * w->length) +
	       pull_cost(w, primitives, s->count);
}

/* The equations for a step from now, with the pull; what is held has none. */
static void set_up(work *w, const stage *s)
{
	esk_normal_equations_derive(w->equations, s->count, w->matrix, w->vector);
	const size_t n = w->parameters;
	for (uint32_t i = 0; i < w->count; i++)
		for (size_t p = 0; p < s->count; p++) {
			const size_t at = i * s->count + p;
			const double value = value_of(&w->origin[i], &w->now[i], p), scale = scale_of(&w->origin[i], p);
			double bounds[2];
			w->matrix[at * n + at] += pull_weight(w) * scale * scale;
			w->vector[at] += pull_weight(w) * scale * (value - target_of(p));
			esk_joint_bounds(p, bounds);
			w->is_held[at] = !s->is_free[p] || (value <= bounds[0] && w->vector[at] > 0) ||
					 (value >= bounds[1] && w->vector[at] < 0);
		}
}

/* R^T R = the matrix in the upper triangle of a, in its place. False when it is not positive. Zeros above the first other
 * number of a column stay. */
ESK_EVERY_WIDTH static bool factorise(double *a, size_t n)
{
	for (size_t j = 0; j < n; j++) {
		double *row = a + j * n;
		if (!(row[j] > 0))
			return false;
		const double root = sqrt(row[j]);
		for (size_t c = j; c < n; c++)
			row[c] /= root;
		for (size_t i = j + 1; i < n; i++) {
			const double factor = row[i];
			double *below = a + i * n;
			if (factor != 0)
				for (size_t c = i; c < n; c++)
					below[c] -= factor * row[c];
		}
	}
	return true;
}

/* R^T R x = b, x in the place of b. */
static void substitute(const double *a, size_t n, double *x)
{
	for (size_t j = 0; j < n; j++) {
		x[j] /= a[j * n + j];
		for (size_t c = j + 1; c < n; c++)
			x[c] -= a[j * n + c] * x[j];
	}
	for (size_t j = n; j-- > 0;) {
		for (size_t c = j + 1; c < n; c++)
			x[j] -= a[j * n + c] * x[c];
		x[j] /= a[j * n + j];
	}
}

/* The damped step. False when the equations have no solution. */
static bool solve(work *w, double damping)
{
	const size_t n = w->parameters;
	for (size_t i = 0; i < n; i++) {
		memcpy(&w->factor[i * n + i], &w->matrix[i * n + i], (n - i) * sizeof(double));
		for (size_t j = i + 1; j < n; j++)
			if (w->is_held[i] || w->is_held[j])
				w->factor[i * n + j] = 0;
		w->factor[i * n + i] += damping * w->matrix[i * n + i] + 1e-12;
		w->step[i] = w->is_held[i] ? 0 : -w->vector[i];
	}
	if (!factorise(w->factor, n))
		return false;
	substitute(w->factor, n, w->step);
	return true;
}

void esk_joint_step(
	const eskel_primitive *origin, const eskel_primitive *from, double *step, size_t count, eskel_primitive *to)
{
	for (size_t p = ESK_LOG_RADII; p < count; p++) {
		const double value = value_of(origin, from, p);
		double bounds[2];
		esk_joint_bounds(p, bounds);
		step[p] = fmin(fmax(step[p], bounds[0] - value), bounds[1] - value);
	}
	/* Linearised, a rotation of more than half a radian or a translation of more than half the radius is fiction. */
	for (size_t p = 0; p < ESK_LOG_RADII; p++) {
		const double most = p < ESK_ROTATION ? 0.5 * origin->radii[2] : 0.5;
		step[p] = fmin(fmax(step[p], -most), most);
	}
	esk_primitive_step(from, step, count, to);
}

static void take_step(work *w, const stage *s)
{
	for (uint32_t i = 0; i < w->count; i++)
		esk_joint_step(&w->origin[i], &w->now[i], &w->step[i * s->count], s->count, &w->next[i]);
}

/* What the linear model says a step gains. */
static double expected_gain(const work *w)
{
	const size_t n = w->parameters;
	double linear = 0, square = 0;
	for (size_t i = 0; i < n; i++) {
		double row = w->matrix[i * n + i] * w->step[i];
		for (size_t j = i + 1; j < n; j++)
			row += 2 * w->matrix[i * n + j] * w->step[j];
		linear += w->vector[i] * w->step[i];
		square += w->step[i] * row;
	}
	return -2 * linear - square;
}

static bool report(work *w)
{
	const esk_joint_options *o = w->options;
	w->steps_done++;
	return !o->progress || o->progress(o->context, w->steps_done, w->steps_all);
}

static eskel_status run_stage(work *w, const stage *s)
{
	double damping = 1e-2, growth = 2, costs[PATIENCE] = {0};
	uint32_t accepted = 0;
	const uint32_t end = w->steps_done + s->steps;
	w->parameters = w->count * s->count;
	w->cost = measure(w, w->now, s);
	bool is_new = true;
	while (w->steps_done < end) {
		if (is_new)
			set_up(w, s);
		is_new = false;
		double cost = INFINITY;
		if (solve(w, damping)) {
			take_step(w, s);
			cost = measure(w, w->next, s);
		}
		if (cost < w->cost) {
			const double ratio = (w->cost - cost) / expected_gain(w), lean = 2 * ratio - 1;
			damping = fmax(damping * fmax(1.0 / 3, 1 - lean * lean * lean), 1e-9);
			growth = 2;
			memcpy(w->now, w->next, sizeof w->now);
			const double before = costs[accepted % PATIENCE];
			costs[accepted % PATIENCE] = w->cost;
			w->cost = cost;
			is_new = true;
			if (accepted++ >= PATIENCE && before - cost < least_gain * cost)
				break;
		} else {
			damping *= growth;
			growth *= 2;
			if (damping > 1e12)
				break;
		}
		if (!report(w))
			return ESKEL_CANCELLED;
	}
	w->steps_done = end;
	return ESKEL_OK;
}

size_t esk_joint_free(eskel_fit_freedom freedom, bool is_free[ESK_PARAMETERS_ALL])
{
	for (size_t p = 0; p < ESK_PARAMETERS_ALL; p++) {
		const bool is_exponent = p >= ESK_EXPONENTS && p < ESK_FURTHER_MODES;
		is_free[p] = p < ESK_FIRST_MODES || p == ESK_ALPHA || (is_exponent && freedom != ESKEL_FIT_ELLIPSOID) ||
			     (p < ESK_FURTHER_MODES && !is_exponent && freedom <= ESKEL_FIT_DEFORMED_SIMPLY) ||
			     (p >= ESK_FURTHER_MODES && freedom == ESKEL_FIT_DEFORMED);
	}
	return freedom == ESKEL_FIT_DEFORMED    ? ESK_PARAMETERS_ALL
	       : freedom == ESKEL_FIT_ELLIPSOID ? ESK_PARAMETERS_SMOOTH
						: ESK_PARAMETERS_USUAL;
}

static stage make_stage(const esk_joint_options *options, int number)
{
	static const size_t counts[STAGES] = {ESK_PARAMETERS_SMOOTH, ESK_PARAMETERS_USUAL, ESK_PARAMETERS_ALL};
	stage s = {.count = counts[number], .steps = stage_steps[number], .reach = 1};
	esk_joint_free(options->freedom, s.is_free);
	for (size_t p = 0; p < ESK_PARAMETERS_ALL; p++)
		s.is_free[p] = s.is_free[p] && (p == ESK_ALPHA || !options->only_alphas);
	return s;
}

static int last_stage(const esk_joint_options *options)
{
	return options->freedom == ESKEL_FIT_DEFORMED ? 2 : options->freedom == ESKEL_FIT_ELLIPSOID ? 0 : 1;
}

static int first_stage(const esk_joint_options *options)
{
	return options->only_last || options->only_alphas ? last_stage(options) : 0;
}

uint32_t esk_joint_steps(const esk_joint_options *options)
{
	uint32_t steps = 0;
	for (int number = first_stage(options); number <= last_stage(options); number++)
		steps += stage_steps[number] * (number == 0 ? FAR_RUNS + 2 : 1);
	return steps;
}

static eskel_status prepare(work *w, const esk_fit_points *points)
{
	const size_t most = make_stage(w->options, last_stage(w->options)).count, n = w->count * most;
	w->matrix = esk_memory_array(n, n * sizeof *w->matrix);
	w->factor = esk_memory_array(n, n * sizeof *w->factor);
	w->vector = esk_memory_array(n, sizeof *w->vector);
	w->step = esk_memory_array(n, sizeof *w->step);
	w->is_held = esk_memory_array(n, sizeof *w->is_held);
	if (!w->matrix || !w->factor || !w->vector || !w->step || !w->is_held)
		return ESKEL_NO_MEMORY;
	return esk_normal_equations_new(points, w->count, most, w->options->team, &w->equations);
}

/* Twice: as it is, and after steps in which residuals reach farther. These find parts that are off by more than residuals
 * saturate at, but may be led astray. Keeps what costs less. */
static eskel_status run_first_stage(work *w)
{
	eskel_primitive start[ESKEL_LEVELS_MAX], kept[ESKEL_LEVELS_MAX];
	const stage near = make_stage(w->options, 0);
	stage far = near;
	memcpy(start, w->now, sizeof start);
	eskel_status status = run_stage(w, &near);
	const double cost = w->cost;
	memcpy(kept, w->now, sizeof kept);
	memcpy(w->now, start, sizeof start);
	for (int n = 0; n < FAR_RUNS && !status; n++) {
		far.reach = far_reaches[n];
		status = run_stage(w, &far);
	}
	if (!status)
		status = run_stage(w, &near);
	if (!status && cost <= w->cost) {
		memcpy(w->now, kept, sizeof kept);
		w->cost = cost;
	}
	return status;
}

eskel_status esk_joint_fit(const esk_fit_points *points, const esk_joint_options *options, uint32_t count,
	const eskel_primitive *origin, eskel_primitive *primitives, double *cost)
{
	eskel_status status = ESKEL_NO_MEMORY;
	work *w = esk_memory_zeroed_array(1, sizeof *w);
	if (!w)
		goto end;
	w->options = options;
	w->count = count;
	w->origin = origin;
	w->length = points->length;
	w->steps_all = esk_joint_steps(options);
	memcpy(w->now, primitives, count * sizeof *primitives);
	status = prepare(w, points);
	if (!status && first_stage(options) == 0)
		status = run_first_stage(w);
	for (int number = first_stage(options) > 0 ? first_stage(options) : 1; number <= last_stage(options) && !status;
		number++) {
		const stage s = make_stage(options, number);
		status = run_stage(w, &s);
	}
	if (!status) {
		memcpy(primitives, w->now, count * sizeof *primitives);
		if (cost)
			*cost = w->cost;
	}
end:
	if (w) {
		free(w->matrix);
		free(w->factor);
		free(w->vector);
		free(w->step);
		free(w->is_held);
		esk_normal_equations_free(w->equations);
	}
	free(w);
	return status;
}
