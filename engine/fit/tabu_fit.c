/* Tabu search (Glover; section 3.6) walks over the vertices of a lattice in the space of parameters: of t_n random
 * neighbours that are not among the last t_v vertices visited it goes to the best, be it worse than where it is. The
 * neighbourhood shrinks to single steps of the lattice. The best vertex of all is polished by Levenberg and Marquardt, and so
 * is the start: here descents stall less often than the paper's did, and the walk may lead to a worse valley than its own.
 *
 * The boundary of a class is here the part of the cloud's own boundary that is nearest to the class's centre, with the points
 * inside and outside that are. Faces between classes do not count: no primitive has to end there. */
#include "tabu_fit.h"

#include "memory.h"
#include "normal_equations.h"
#include "random.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The lattice: an eighth of a neighbour's greatest reach in the first step. */
static const double unit = 1.0 / 64;
enum { WIDEST = 8, CHANGED = 4 }; /* steps of the lattice; parameters that a neighbour changes */

typedef struct {
	const esk_tabu_options *options;
	const eskel_primitive *origin;
	esk_normal_equations *equations;
	bool is_free[ESK_PARAMETERS_ALL];
	size_t count;
	double length;
	uint64_t random;
} search;

typedef struct {
	int at[ESK_PARAMETERS_ALL]; /* in units of the lattice, from the origin */
} vertex;

static void place(const search *s, const vertex *v, eskel_primitive *primitive)
{
	double step[ESK_PARAMETERS_ALL];
	for (size_t p = 0; p < s->count; p++)
		step[p] = v->at[p] * unit * (p < ESK_ROTATION ? s->origin->radii[2] : 1);
	esk_primitive_step(s->origin, step, s->count, primitive);
}

/* Or something that is not below most. */
static double cost_of(const search *s, const vertex *v, double most)
{
	esk_composition composition;
	eskel_primitive primitive;
	place(s, v, &primitive);
	esk_composition_make(&primitive, 1, ESKEL_COMPOSE_BLEND, &composition);
	return esk_normal_equations_measure_below(s->equations, &composition, s->length, most);
}

/* Alpha of a single primitive changes nothing. */
static vertex make_neighbour(search *s, const vertex *v, int reach)
{
	vertex made = *v;
	for (int change = 0; change < CHANGED; change++) {
		const size_t p = (size_t)(esk_random(&s->random) % s->count);
		const int move = (int)(esk_random(&s->random) % (uint64_t)(2 * reach + 1)) - reach;
		double bounds[2];
		esk_joint_bounds(p, bounds);
		const double start = p >= ESK_EXPONENTS && p < ESK_FURTHER_MODES ? 1 : 0;
		const double value = start + (made.at[p] + move) * unit;
		if (s->is_free[p] && p != ESK_ALPHA && value >= bounds[0] && value <= bounds[1])
			made.at[p] += move;
	}
	return made;
}

static bool is_tabu(const vertex *visited, uint32_t count, const vertex *v)
{
	for (uint32_t i = 0; i < count; i++)
		if (memcmp(&visited[i], v, sizeof *v) == 0)
			return true;
	return false;
}

/* The best vertex of a walk from the origin. */
static vertex walk(search *s)
{
	const esk_tabu_options *o = s->options;
	vertex now = {{0}}, best = now, visited[ESK_TABU_MEMORY_MOST];
	double least = cost_of(s, &now, INFINITY);
	visited[0] = now;
	for (uint32_t step = 0; step < o->steps && least > o->threshold * o->threshold; step++) {
		const int reach = 1 + (int)((WIDEST - 1) * (uint64_t)(o->steps - step) / o->steps);
		double least_near = INFINITY;
		vertex next = now;
		for (uint32_t n = 0; n < o->neighbours; n++) {
			const vertex near = make_neighbour(s, &now, reach);
			if (is_tabu(visited, step + 1 < o->memory ? step + 1 : o->memory, &near))
				continue;
			const double cost = cost_of(s, &near, least_near);
			if (cost < least_near) {
				least_near = cost;
				next = near;
			}
		}
		now = next;
		visited[(step + 1) % o->memory] = now;
		if (least_near < least) {
			least = least_near;
			best = now;
		}
	}
	return best;
}

static eskel_status fit_class(const esk_fit_points *points, const esk_tabu_options *options, uint32_t index,
	const eskel_primitive *origin, eskel_primitive *primitive)
{
	search s = {.options = options, .origin = origin, .length = points->length, .random = options->seed + index};
	esk_joint_options polish = options->joint;
	polish.progress = NULL;
	s.count = esk_joint_free(polish.freedom, s.is_free);
	eskel_status status = esk_normal_equations_new(points, 1, s.count, polish.team, &s.equations);
	if (status)
		return status;
	const vertex best = walk(&s);
	esk_normal_equations_free(s.equations);
	eskel_primitive walked, straight = *origin;
	double costs[2];
	place(&s, &best, &walked);
	polish.only_last = true;
	status = esk_joint_fit(points, &polish, 1, origin, &walked, &costs[0]);
	if (!status)
		status = esk_joint_fit(points, &polish, 1, origin, &straight, &costs[1]);
	if (!status)
		*primitive = costs[0] <= costs[1] ? walked : straight;
	return status;
}

eskel_status esk_tabu_fit(const esk_fit_points *points, const esk_tabu_options *options, uint32_t count,
	const eskel_primitive *origin, eskel_primitive *primitives)
{
	const esk_joint_options *joint = &options->joint;
	eskel_primitive fitted[ESKEL_LEVELS_MAX];
	uint32_t *classes = esk_memory_array(points->group_count * ESK_LANES, sizeof *classes);
	eskel_status status = classes ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (size_t i = 0; i < points->group_count * ESK_LANES && !status; i++) {
		const esk_fit_group *g = &points->groups[i / ESK_LANES];
		const size_t l = i % ESK_LANES;
		const double point[3] = {g->points[0][l], g->points[1][l], g->points[2][l]};
		classes[i] = esk_primitive_nearest(origin, count, point);
	}
	for (uint32_t i = 0; i < count && !status; i++) {
		esk_fit_points *own = NULL;
		status = esk_fit_points_select(points, classes, i, &own);
		if (!status)
			status = fit_class(own, options, i, &origin[i], &fitted[i]);
		esk_fit_points_free(own);
		if (!status && joint->progress && !joint->progress(joint->context, i + 1, count + 1))
			status = ESKEL_CANCELLED;
	}
	esk_joint_options alphas = *joint;
	alphas.only_alphas = true;
	alphas.progress = NULL;
	if (!status)
		status = esk_joint_fit(points, &alphas, count, origin, fitted, NULL);
	if (!status)
		memcpy(primitives, fitted, count * sizeof *primitives);
	free(classes);
	return status;
}
