/* Surfaces: primitives, and their composition made ready for evaluation. */
#include "surface.h"

#include "elementary.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An ellipsoid's own cloud has the variance radius^2 / 5 along an axis (section 3.3). */
static const double gamma_of_union = 2.23606797749978969, gamma_of_blend = 2;

eskel_status esk_surface_allocate(uint32_t count, eskel_compose compose, eskel_surface **surface)
{
	eskel_surface *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	made->composition.count = count;
	made->composition.compose = compose;
	*surface = made;
	return ESKEL_OK;
}

void esk_surface_refresh(eskel_surface *surface)
{
	esk_composition *c = &surface->composition;
	esk_composition_make(surface->primitives, c->count, c->compose, c);
	for (uint32_t i = 0; i < c->count; i++)
		c->parts[i].algebraic = surface->algebraic[i];
}

void eskel_surface_free(eskel_surface *surface)
{
	if (!surface)
		return;
	for (uint32_t i = 0; i < ESKEL_LEVELS_MAX; i++)
		free(surface->algebraic[i]);
	free(surface);
}

static bool are_in_range(const eskel_surface_options *options)
{
	return options->primitive <= ESKEL_PRIMITIVE_ALGEBRAIC && options->compose <= ESKEL_COMPOSE_UNION &&
	       options->gamma >= 0.1 && options->gamma <= 10 && options->alpha >= ESKEL_ALPHA_MIN &&
	       options->alpha <= ESKEL_ALPHA_MAX;
}

static eskel_surface_options complete(const eskel_surface_options *asked, uint32_t level)
{
	eskel_surface_options options = asked ? *asked : (eskel_surface_options){0};
	if (options.gamma == 0)
		options.gamma = options.compose == ESKEL_COMPOSE_BLEND && level > 1 ? gamma_of_blend : gamma_of_union;
	if (options.alpha == 0)
		options.alpha = 1;
	return options;
}

/* h^2 / 12 (eskel_surface.h). */
static double least_variance(const eskel_skeleton *skeleton)
{
	const double side = esk_elementary_cbrt(skeleton->volume / (double)skeleton->voxels);
	return side * side / 12;
}

eskel_status eskel_surface_new(
	const eskel_skeleton *skeleton, uint32_t level, const eskel_surface_options *options, eskel_surface **surface)
{
	const eskel_surface_options all = complete(options, level);
	eskel_surface *made = NULL;
	if (level < 1 || level > skeleton->level_count || !are_in_range(&all))
		return ESKEL_INVALID;
	eskel_status status = esk_surface_allocate(level, all.compose, &made);
	if (status)
		return status;
	for (uint32_t i = 0; i < level && !status; i++) {
		eskel_primitive *primitive = &made->primitives[i];
		esk_primitive_from_node(
			eskel_skeleton_node(skeleton, level, i), all.gamma, least_variance(skeleton), primitive);
		primitive->kind =
			all.primitive == ESKEL_PRIMITIVE_ALGEBRAIC ? ESKEL_PRIMITIVE_ELLIPSOID : all.primitive;
		primitive->alpha = all.alpha;
		if (!esk_primitive_is_valid(primitive))
			status = ESKEL_INVALID;
	}
	if (status) {
		eskel_surface_free(made);
		return status;
	}
	esk_surface_refresh(made);
	*surface = made;
	return ESKEL_OK;
}

eskel_status eskel_surface_compose(
	const eskel_primitive *primitives, uint32_t count, eskel_compose compose, eskel_surface **surface)
{
	eskel_surface *made = NULL;
	if (count < 1 || count > ESKEL_LEVELS_MAX || compose > ESKEL_COMPOSE_UNION)
		return ESKEL_INVALID;
	for (uint32_t i = 0; i < count; i++)
		if (primitives[i].kind == ESKEL_PRIMITIVE_ALGEBRAIC || !esk_primitive_is_valid(&primitives[i]))
			return ESKEL_INVALID;
	eskel_status status = esk_surface_allocate(count, compose, &made);
	if (status)
		return status;
	memcpy(made->primitives, primitives, count * sizeof *primitives);
	esk_surface_refresh(made);
	*surface = made;
	return ESKEL_OK;
}

uint32_t eskel_surface_count(const eskel_surface *surface)
{
	return surface->composition.count;
}

eskel_compose eskel_surface_composition(const eskel_surface *surface)
{
	return surface->composition.compose;
}

const eskel_primitive *eskel_surface_primitive(const eskel_surface *surface, uint32_t class_index)
{
	return class_index < surface->composition.count ? &surface->primitives[class_index] : NULL;
}

eskel_status esk_surface_set_algebraic(
	eskel_surface *surface, uint32_t class_index, unsigned degree, const esk_algebraic_points *points)
{
	if (class_index >= surface->composition.count)
		return ESKEL_INVALID;
	eskel_primitive *primitive = &surface->primitives[class_index];
	esk_algebraic *made = esk_memory_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	eskel_status status = esk_algebraic_fit(primitive, degree, points, made);
	if (status) {
		free(made);
		return status;
	}
	free(surface->algebraic[class_index]);
	surface->algebraic[class_index] = made;
	primitive->kind = ESKEL_PRIMITIVE_ALGEBRAIC;
	memset(primitive->modes, 0, sizeof primitive->modes);
	primitive->exponents[0] = primitive->exponents[1] = 1;
	esk_surface_refresh(surface);
	return ESKEL_OK;
}

eskel_status eskel_surface_set_algebraic(
	eskel_surface *surface, uint32_t class_index, unsigned degree, const double (*points)[3], size_t count)
{
	return esk_surface_set_algebraic(
		surface, class_index, degree, &(esk_algebraic_points){.count = count, .points = points});
}

const double *eskel_surface_polynomial(const eskel_surface *surface, uint32_t class_index, unsigned *degree)
{
	if (class_index >= surface->composition.count || !surface->algebraic[class_index])
		return NULL;
	*degree = surface->algebraic[class_index]->degree;
	return surface->algebraic[class_index]->coefficients;
}

double eskel_surface_value(const eskel_surface *surface, const double point[3])
{
	double value;
	esk_composition_values(&surface->composition, 1, (const double(*)[3])point, &value);
	return value;
}

void eskel_surface_values(const eskel_surface *surface, size_t count, const double (*points)[3], double *values)
{
	esk_composition_values(&surface->composition, count, points, values);
}

double eskel_surface_gradient(const eskel_surface *surface, const double point[3], double gradient[3])
{
	return esk_composition_gradient(&surface->composition, point, gradient);
}

/* No surface is farther off, nor deeper down, but for odd ones. */
static double farthest(const eskel_surface *surface, const double point[3])
{
	double greatest_radius = 0, nearest_centre = INFINITY;
	for (uint32_t i = 0; i < surface->composition.count; i++) {
		const eskel_primitive *p = &surface->primitives[i];
		const double x = point[0] - p->centre[0], y = point[1] - p->centre[1], z = point[2] - p->centre[2];
		nearest_centre = fmin(nearest_centre, sqrt(x * x + y * y + z * z));
		for (int r = 0; r < 3; r++)
			greatest_radius = fmax(greatest_radius, p->radii[r]);
	}
	return fmax(greatest_radius, nearest_centre);
}

double eskel_surface_distance(const eskel_surface *surface, const double point[3], double normal[3])
{
	double g[3];
	const double value = esk_composition_gradient(&surface->composition, point, g);
	const double length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]), most = farthest(surface, point);
	for (int i = 0; normal && i < 3; i++)
		normal[i] = length > 0 ? g[i] / length : 0;
	/* Not a quotient: where the gradient vanishes that is infinite. */
	const double distance = fabs(value) < most * length ? fabs(value) / length : most;
	return value == 0 ? 0 : copysign(distance, value);
}

bool eskel_surface_contains(const eskel_surface *surface, const double point[3])
{
	return eskel_surface_value(surface, point) < 0;
}
