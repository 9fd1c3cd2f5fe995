/* Marching tetrahedra on the body-centred cubic lattice.
 *
 * The surface is followed (continuation.h), nodes next to it are snapped to it (snapping.h), and each tetrahedron with nodes
 * inside and outside gives a triangle or a quadrangle, whose corners lie on its edges: a vertex is a cut of an edge, or a
 * snapped node. Vertices are numbered and placed on their edges (vertices.h); then come the triangles (cells.h).
 *
 * In a row of tetrahedra that share a face, each has one edge of the mesh in it: the mesh is closed and a manifold whatever
 * the field is, and its triangles are oriented as the tetrahedra are. */
#include "polygonise.h"

#include "cells.h"
#include "continuation.h"
#include "error.h"
#include "mesh.h"
#include "snapping.h"
#include "vertices.h"

#include <math.h>
#include <stdlib.h>

static const double longest_box = 1 << 20; /* in steps; coordinates of the lattice are at most twice that */

/* Not the library's, of which the last bit is not the same everywhere. */
static const double cube_root_of_2 = 1.2599210498948732;

typedef struct {
	esk_trace trace;
	esk_cells cells;
} work;

static void clear(work *w)
{
	esk_lattice_clear(&w->trace.lattice);
	esk_cells_clear(&w->cells);
}

static eskel_status check_options(const esk_polygonise_options *o, eskel_error *error)
{
	if (!(o->step > 0 && o->step < INFINITY))
		return esk_error_set(error, ESKEL_INVALID, "the step is %g mm, expected a positive number", o->step);
	for (int a = 0; a < 3; a++) {
		const double length = o->greatest[a] - o->least[a];
		if (!(length > 0 && length < INFINITY))
			return esk_error_set(error, ESKEL_INVALID, "the box is from %g to %g mm along axis %d",
				o->least[a], o->greatest[a], a);
		if (length / o->step > longest_box)
			return esk_error_set(error, ESKEL_TOO_LARGE,
				"the box is %g mm long, expected at most %g steps of %g mm", length, longest_box,
				o->step);
	}
	return ESKEL_OK;
}

static void start_lattice(const esk_field *field, const esk_polygonise_options *o, double step, esk_lattice *lattice)
{
	double origin[3];
	for (int a = 0; a < 3; a++)
		origin[a] = (o->least[a] + o->greatest[a]) / 2;
	/* Two nodes in a cube of side 2 step_half. */
	esk_lattice_start(lattice, field, origin, step * cube_root_of_2 / 2);
}

/* The triangles are as many as the area over the square of the step, so a surface that is too large is followed again with
 * steps twice as long, until it has few enough nodes to tell how many it would have had. */
static eskel_status refuse_step(
	const esk_field *field, const esk_polygonise_options *options, size_t most, eskel_error *error)
{
	esk_trace trace = {0};
	eskel_status status = ESKEL_TOO_LARGE;
	double step = options->step;
	while (status == ESKEL_TOO_LARGE) {
		eskel_error again = {ESKEL_OK, ""};
		step *= 2;
		esk_lattice_clear(&trace.lattice);
		trace.count = 0;
		start_lattice(field, options, step, &trace.lattice);
		status = esk_trace_surface(&trace, options, most, &again);
		if (status != ESKEL_OK && again.status != ESKEL_OK) { /* for another reason than the limit */
			if (error)
				*error = again;
			break;
		}
	}
	if (status == ESKEL_OK) {
		const double fitting = 1.1 * step * sqrt((double)trace.count / (double)most);
		status = esk_error_set(error, ESKEL_TOO_LARGE,
			"a step of %g mm gives more than %zu triangles, expected a step of at least %.3g mm",
			options->step, most, fitting);
	}
	esk_lattice_clear(&trace.lattice);
	return status;
}

/* Places the vertices, and takes over the triangles. */
static bool fill_mesh(work *w, const esk_star *star, eskel_mesh *mesh)
{
	const esk_lattice *l = &w->trace.lattice;
	esk_vertices_place(l, mesh->vertices, mesh->normals);
	if (!esk_cells_make(l, star, mesh->vertex_count, (const float(*)[3])mesh->vertices, &w->cells))
		return false;
	free(mesh->triangles);
	mesh->triangles = w->cells.triangles;
	mesh->triangle_count = w->cells.count;
	w->cells = (esk_cells){0};
	return esk_mesh_complete_normals(mesh) == ESKEL_OK;
}

static eskel_status make_mesh(work *w, size_t most, eskel_mesh **mesh, eskel_error *error)
{
	esk_star star;
	esk_star_make(&star);
	esk_snap(&w->trace.lattice, &star);
	const size_t vertex_count = esk_vertices_number(&w->trace.lattice);
	eskel_mesh *made = esk_mesh_new(vertex_count, 0);
	if (!made || !fill_mesh(w, &star, made)) {
		eskel_mesh_free(made);
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for a mesh of %zu vertices", vertex_count);
	}
	if (made->triangle_count > most) {
		eskel_mesh_free(made);
		return ESKEL_TOO_LARGE;
	}
	*mesh = made;
	return ESKEL_OK;
}

eskel_status esk_polygonise(
	const esk_field *field, const esk_polygonise_options *options, eskel_mesh **mesh, eskel_error *error)
{
	eskel_status status = check_options(options, error);
	if (status != ESKEL_OK)
		return status;
	const size_t most = options->triangles_max ? options->triangles_max : ESK_TRIANGLES_MAX;
	eskel_error found = {ESKEL_OK, ""};
	work w = {0};
	start_lattice(field, options, options->step, &w.trace.lattice);
	status = esk_trace_surface(&w.trace, options, most, &found);
	if (status == ESKEL_OK)
		status = make_mesh(&w, most, mesh, &found);
	clear(&w);
	if (status == ESKEL_TOO_LARGE && found.status == ESKEL_OK)
		return refuse_step(field, options, most, error);
	if (status != ESKEL_OK && error)
		*error = found;
	return status;
}
