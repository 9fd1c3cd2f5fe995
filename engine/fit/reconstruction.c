/* A level's surface fitted to the cloud, with what it gained. */
#include "elementary.h"
#include "error.h"
#include "least_squares_fit.h"
#include "memory.h"
#include "random.h"
#include "surface.h"
#include "surface_error.h"
#include "tabu_fit.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = 1200, POINTS_A_CLASS = 150, POINTS_LEAST = 8, POINTS_MOST = 1000000, HOPS = 10, HOPS_MOST = 1000 };
enum { NEIGHBOURS = 5, MEMORY = 10, STEPS = 200 };
static const double perturbation = 0.1;

typedef struct {
	const esk_fit_points *points;
	eskel_fit_options options;
	esk_joint_options joint;
	uint32_t count;
	const eskel_primitive *origin;
	uint32_t steps_before, steps; /* of hops so far, of all */
} work;

static eskel_fit_options complete(const eskel_fit_options *asked, uint32_t level, double spacing)
{
	eskel_fit_options o = asked ? *asked : (eskel_fit_options){0};
	o.boundary_points = o.boundary_points ? o.boundary_points : POINTS + POINTS_A_CLASS * level;
	o.hops = o.hops ? o.hops : HOPS;
	o.tabu_neighbours = o.tabu_neighbours ? o.tabu_neighbours : NEIGHBOURS;
	o.tabu_memory = o.tabu_memory ? o.tabu_memory : MEMORY;
	o.tabu_steps = o.tabu_steps ? o.tabu_steps : STEPS;
	o.tabu_threshold = o.tabu_threshold > 0 ? o.tabu_threshold : spacing / 4;
	return o;
}

static bool are_in_range(const eskel_fit_options *o)
{
	return (unsigned)o->method <= ESKEL_FIT_LEAST_SQUARES && (unsigned)o->freedom <= ESKEL_FIT_ELLIPSOID &&
	       o->boundary_points >= POINTS_LEAST && o->boundary_points <= POINTS_MOST && o->hops <= HOPS_MOST &&
	       o->tabu_neighbours <= 1000 && o->tabu_memory <= ESK_TABU_MEMORY_MOST && o->tabu_steps <= 1000000;
}

static bool report_hop(void *context, uint32_t step, uint32_t steps)
{
	const work *w = context;
	(void)steps;
	return !w->options.progress || w->options.progress(w->options.context, w->steps_before + step, w->steps);
}

static void perturb(const work *w, uint64_t *random, const eskel_primitive *from, eskel_primitive *to)
{
	bool is_free[ESK_PARAMETERS_ALL];
	const size_t count = esk_joint_free(w->options.freedom, is_free);
	for (uint32_t i = 0; i < w->count; i++) {
		double step[ESK_PARAMETERS_ALL];
		for (size_t p = 0; p < count; p++) {
			const double by = perturbation * esk_random_normal(random);
			step[p] = is_free[p] ? by * (p < ESK_ROTATION ? from[i].radii[2] : 1) : 0;
		}
		esk_joint_step(&w->origin[i], &from[i], step, count, &to[i]);
	}
}

/* Basin hopping (Wales and Doye 1997) at temperature 0. */
static eskel_status hop(work *w, eskel_primitive *primitives)
{
	eskel_primitive best[ESKEL_LEVELS_MAX], next[ESKEL_LEVELS_MAX];
	double least, cost;
	uint64_t random = w->options.seed;
	w->steps = esk_joint_steps(&w->joint);
	esk_joint_options again = w->joint;
	again.only_last = true;
	w->steps += w->options.hops * esk_joint_steps(&again);
	w->joint.progress = again.progress = report_hop;
	w->joint.context = again.context = w;
	memcpy(best, primitives, w->count * sizeof *best);
	eskel_status status = esk_joint_fit(w->points, &w->joint, w->count, w->origin, best, &least);
	w->steps_before = esk_joint_steps(&w->joint);
	for (uint32_t i = 0; i < w->options.hops && !status; i++) {
		perturb(w, &random, best, next);
		status = esk_joint_fit(w->points, &again, w->count, w->origin, next, &cost);
		w->steps_before += esk_joint_steps(&again);
		if (!status && cost < least) {
			least = cost;
			memcpy(best, next, w->count * sizeof *best);
		}
	}
	if (!status)
		memcpy(primitives, best, w->count * sizeof *best);
	return status;
}

static eskel_status run(work *w, eskel_primitive *primitives)
{
	const eskel_fit_options *o = &w->options;
	const esk_tabu_options tabu = {
		w->joint, o->tabu_neighbours, o->tabu_memory, o->tabu_steps, o->tabu_threshold, o->seed};
	switch (o->method) {
	case ESKEL_FIT_TABU:
		return esk_tabu_fit(w->points, &tabu, w->count, w->origin, primitives);
	case ESKEL_FIT_HOPPING:
		return hop(w, primitives);
	default:
		return esk_joint_fit(w->points, &w->joint, w->count, w->origin, primitives, NULL);
	}
}

/* From the blend of best ellipsoids to the fitted one. */
static eskel_status fit_blend(const esk_boundary *boundary, const eskel_fit_options *options, esk_team *team,
	const eskel_surface *plain, eskel_surface **fitted)
{
	eskel_primitive primitives[ESKEL_LEVELS_MAX];
	esk_fit_points *points = NULL;
	eskel_status status = esk_fit_points_new(boundary, options->boundary_points, &points);
	if (status)
		return status;
	work w = {.points = points,
		.options = *options,
		.count = eskel_surface_count(plain),
		.origin = plain->primitives};
	w.joint = (esk_joint_options){.freedom = options->freedom,
		.spacing = boundary->spacing,
		.progress = options->progress,
		.context = options->context,
		.team = team};
	memcpy(primitives, plain->primitives, w.count * sizeof *primitives);
	status = run(&w, primitives);
	if (!status)
		status = eskel_surface_compose(primitives, w.count, ESKEL_COMPOSE_BLEND, fitted);
	esk_fit_points_free(points);
	return status;
}

static eskel_status fit_algebraic(const esk_boundary *boundary, const eskel_fit_options *options,
	const eskel_skeleton *skeleton, uint32_t level, eskel_surface **fitted)
{
	const eskel_surface_options best = {.compose = ESKEL_COMPOSE_UNION};
	const esk_least_squares_options least = {options->boundary_points, options->progress, options->context};
	eskel_surface *made = NULL;
	eskel_status status = eskel_surface_new(skeleton, level, &best, &made);
	if (!status)
		status = esk_least_squares_fit(boundary, &least, made);
	if (status)
		eskel_surface_free(made);
	else
		*fitted = made;
	return status;
}

static eskel_primitive_kind kind_of(eskel_fit_freedom freedom)
{
	return freedom == ESKEL_FIT_ELLIPSOID      ? ESKEL_PRIMITIVE_ELLIPSOID
	       : freedom == ESKEL_FIT_SUPERQUADRIC ? ESKEL_PRIMITIVE_SUPERQUADRIC
						   : ESKEL_PRIMITIVE_DEFORMED;
}

eskel_status eskel_surface_fit(const eskel_cloud *cloud, const eskel_skeleton *skeleton, uint32_t level,
	const eskel_fit_options *options, eskel_reconstruction **reconstruction, eskel_error *error)
{
	const double spacing = esk_elementary_cbrt(eskel_cloud_volume(cloud) / (double)cloud->voxels);
	const eskel_fit_options chosen = complete(options, level, spacing);
	if (level < 1 || level > skeleton->level_count || !are_in_range(&chosen))
		return esk_error_set(error, ESKEL_INVALID,
			"a fit of level %u of %u, or an option of it, is out of range", level, skeleton->level_count);
	esk_boundary *boundary = NULL;
	eskel_surface *plain = NULL;
	eskel_reconstruction *made = NULL;
	esk_team *team = NULL;
	eskel_status status = esk_boundary_new(cloud, &boundary, error);
	if (status)
		return status;
	team = esk_team_new(esk_team_threads(chosen.threads));
	made = esk_memory_zeroed_array(1, sizeof *made);
	status = made ? ESKEL_OK : ESKEL_NO_MEMORY;
	const eskel_surface_options best = {.primitive = kind_of(chosen.freedom)};
	if (!status)
		status = eskel_surface_new(skeleton, level, &best, &plain);
	if (!status)
		status = esk_surface_error_measure(plain, boundary, team, &made->before);
	if (!status)
		status = chosen.method == ESKEL_FIT_LEAST_SQUARES
				 ? fit_algebraic(boundary, &chosen, skeleton, level, &made->surface)
				 : fit_blend(boundary, &chosen, team, plain, &made->surface);
	if (!status)
		status = esk_surface_error_measure(made->surface, boundary, team, &made->after);
	if (status) {
		esk_error_set(error, status, "level %u was not fitted: %s", level,
			status == ESKEL_TOO_LARGE
				? "the surface ran far away from the voxels; another method, seed or level may not"
				: eskel_status_text(status));
		eskel_reconstruction_free(made);
	} else {
		made->level = level;
		*reconstruction = made;
	}
	eskel_surface_free(plain);
	esk_boundary_free(boundary);
	esk_team_free(team);
	return status;
}

void eskel_reconstruction_free(eskel_reconstruction *reconstruction)
{
	if (!reconstruction)
		return;
	eskel_surface_free(reconstruction->surface);
	free(reconstruction);
}
