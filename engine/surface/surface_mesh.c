/* The mesh of a composed surface (section 4): a union of ellipsoids from their own triangles; any other, and what these cannot
 * be trusted with, from its field, polygonised from the centres of its classes. */
#include "elementary.h"
#include "error.h"
#include "polygonise.h"
#include "surface.h"
#include "union_mesh.h"

#include <math.h>
#include <string.h>

/* A box that mostly holds the whole surface.
 *
 * On a blend of n classes some alpha_i d_i is at most ln n, for n exp(-min alpha_i d_i) is at least the sum that is 1. Where
 * d_i is that of an ellipsoid, r^2 - 1 with r in radii, this says how far. A superquadric's corners lie sqrt 3 times as far
 * out, an algebraic surface within a box of three radii. Modes as fits find them at most double a radius and bend by another.
 * What all the same leads out of the box is refused: modes at their limits, or an algebraic class in the corners of its own
 * box or in a blend. */
static void set_box(const eskel_surface *surface, esk_polygonise_options *options)
{
	const esk_composition *composition = &surface->composition;
	const double classes = composition->compose == ESKEL_COMPOSE_BLEND ? esk_elementary_log(composition->count) : 0;
	for (uint32_t i = 0; i < composition->count; i++) {
		const eskel_primitive *p = &surface->primitives[i];
		const double longest = fmax(fmax(p->radii[0], p->radii[1]), p->radii[2]);
		const double radii = p->kind == ESKEL_PRIMITIVE_DEFORMED ? 8 : 3;
		const double reach = radii * longest * sqrt(1 + classes / p->alpha);
		for (size_t axis = 0; axis < 3; axis++) {
			const double least = p->centre[axis] - reach, greatest = p->centre[axis] + reach;
			options->least[axis] = i ? fmin(options->least[axis], least) : least;
			options->greatest[axis] = i ? fmax(options->greatest[axis], greatest) : greatest;
		}
	}
}

static bool is_union_of_ellipsoids(const eskel_surface *surface)
{
	bool all = surface->composition.compose == ESKEL_COMPOSE_UNION;
	for (uint32_t i = 0; i < surface->composition.count; i++)
		all = all && surface->primitives[i].kind == ESKEL_PRIMITIVE_ELLIPSOID;
	return all;
}

static eskel_status polygonise(
	const eskel_surface *surface, double step, size_t triangles_max, eskel_mesh **mesh, eskel_error *error)
{
	double seeds[ESKEL_LEVELS_MAX][3];
	esk_polygonise_options options = {.step = step,
		.seeds = (const double(*)[3])seeds,
		.seed_count = surface->composition.count,
		.triangles_max = triangles_max};
	const esk_field field = esk_composition_field(&surface->composition);
	for (uint32_t i = 0; i < surface->composition.count; i++)
		memcpy(seeds[i], surface->primitives[i].centre, sizeof seeds[i]);
	set_box(surface, &options);
	return esk_polygonise(&field, &options, mesh, error);
}

eskel_status eskel_surface_mesh(
	const eskel_surface *surface, double step, size_t triangles_max, eskel_mesh **mesh, eskel_error *error)
{
	if (is_union_of_ellipsoids(surface) && step > 0 && step < INFINITY) {
		const eskel_status status = esk_union_mesh(surface->primitives, surface->composition.count, step,
			triangles_max ? triangles_max : ESK_TRIANGLES_MAX, mesh);
		if (status == ESKEL_NO_MEMORY)
			return esk_error_set(error, status, "memory ran out for a mesh");
		if (status == ESKEL_OK)
			return status;
	}
	return polygonise(surface, step, triangles_max, mesh, error);
}
