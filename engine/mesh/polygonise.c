/* Marching tetrahedra on the body-centred cubic lattice.
 *
 * The surface is followed (continuation.h), nodes next to it are snapped to it (snapping.h), and each tetrahedron with nodes
 * inside and outside gives a triangle or a quadrangle, whose corners lie on its edges: a vertex is a cut of an edge, or a
 * snapped node. Vertices are found on their edges (roots.h); then quadrangles are divided along the shorter diagonal.
 *
 * In a row of tetrahedra that share a face, each has one edge of the mesh in it: the mesh is closed and a manifold whatever
 * the field is, and its triangles are oriented as the tetrahedra are. */
#include "polygonise.h"

#include "cells.h"
#include "continuation.h"
#include "error.h"
#include "mesh.h"
#include "roots.h"
#include "snapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double longest_box = 1 << 20; /* in steps; coordinates of the lattice are at most twice that */

/* Not the library's, of which the last bit is not the same everywhere. */
static const double cube_root_of_2 = 1.2599210498948732;

typedef struct {
	const esk_field *field;
	esk_trace trace;
	esk_cells cells;
} work;

static void clear(work *w)
{
	esk_lattice_clear(&w->trace.lattice);
	esk_cells_clear(&w->cells);
}

/* ---- where vertices lie */

enum { BATCH = ESK_ROOTS_MOST };

static void compute_gradients(const esk_field *field, size_t count, const double (*points)[3], double (*gradients)[3])
{
	if (field->gradients)
		field->gradients(field->context, count, points, gradients);
	else
		for (size_t i = 0; i < count; i++)
			field->gradient(field->context, points[i], gradients[i]);
}

static void write_normal(const double gradient[3], float normal[3])
{
	const double length = sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
	for (int a = 0; a < 3; a++)
		normal[a] = (float)(length > 0 && length < INFINITY ? gradient[a] / length : 0);
}

static void find_position(const esk_lattice *l, uint32_t node, double position[3])
{
	int32_t at[3];
	esk_lattice_at(l, node, at);
	esk_lattice_position(l, at, position);
}

/* The ends of the edges of a batch of vertices, and the field there. */
static void find_ends(const work *w, size_t first, size_t count, esk_root *roots)
{
	const esk_lattice *l = &w->trace.lattice;
	for (size_t i = 0; i < count; i++) {
		const esk_edge *e = &w->cells.edges[first + i];
		roots[i].inside_value = esk_lattice_value(l, e->inside);
		roots[i].outside_value = esk_lattice_value(l, e->outside);
		find_position(l, e->inside, roots[i].inside);
		find_position(l, e->outside, roots[i].outside);
	}
}

static void write_vertices(const work *w, eskel_mesh *mesh)
{
	esk_root roots[BATCH];
	double points[BATCH][3], gradients[BATCH][3];
	for (size_t first = 0; first < w->cells.edge_count; first += BATCH) {
		const size_t rest = w->cells.edge_count - first, count = rest < BATCH ? rest : BATCH;
		find_ends(w, first, count, roots);
		esk_roots_find(w->field, count, roots, points);
		compute_gradients(w->field, count, (const double(*)[3])points, gradients);
		for (size_t i = 0; i < count; i++) {
			for (int a = 0; a < 3; a++)
				mesh->vertices[first + i][a] = (float)points[i][a];
			write_normal(gradients[i], mesh->normals[first + i]);
		}
	}
}

static double distance(const eskel_mesh *mesh, uint32_t a, uint32_t b)
{
	double square = 0;
	for (int i = 0; i < 3; i++) {
		const double d = (double)mesh->vertices[a][i] - mesh->vertices[b][i];
		square += d * d;
	}
	return square;
}

static void write_triangles(const work *w, eskel_mesh *mesh)
{
	uint32_t(*triangle)[3] = mesh->triangles;
	for (size_t p = 0; p < w->cells.polygon_count; p++) {
		const uint32_t *c = w->cells.polygons[p].corners;
		const bool is_quadrangle = c[3] != ESK_NO_VERTEX;
		const int turn = is_quadrangle && distance(mesh, c[1], c[3]) < distance(mesh, c[0], c[2]);
		for (int t = 0; t <= is_quadrangle; t++, triangle++)
			for (int i = 0; i < 3; i++)
				(*triangle)[i] = c[(turn + (i ? i + t : 0)) % 4];
	}
}

/* ---- the whole */

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

static eskel_status no_memory(const work *w, eskel_error *error)
{
	return esk_error_set(
		error, ESKEL_NO_MEMORY, "memory ran out for a mesh of %zu triangles", w->cells.triangle_count);
}

static eskel_status make_polygons(work *w, eskel_error *error)
{
	esk_lattice *l = &w->trace.lattice;
	esk_star star;
	esk_star_make(&star);
	esk_lattice_link(l);
	esk_snap(l, &star);
	return esk_cells_make(l, &star, &w->cells) ? ESKEL_OK : no_memory(w, error);
}

static eskel_status make_mesh(const work *w, eskel_mesh **mesh, eskel_error *error)
{
	eskel_mesh *made = esk_mesh_new(w->cells.edge_count, w->cells.triangle_count);
	if (!made)
		return no_memory(w, error);
	write_vertices(w, made);
	write_triangles(w, made);
	if (esk_mesh_complete_normals(made) != ESKEL_OK) {
		eskel_mesh_free(made);
		return no_memory(w, error);
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
	work w = {.field = field};
	start_lattice(field, options, options->step, &w.trace.lattice);
	status = esk_trace_surface(&w.trace, options, most, &found);
	if (status == ESKEL_OK)
		status = make_polygons(&w, &found);
	if (status == ESKEL_OK && w.cells.triangle_count > most)
		status = ESKEL_TOO_LARGE;
	if (status == ESKEL_OK)
		status = make_mesh(&w, mesh, &found);
	clear(&w);
	if (status == ESKEL_TOO_LARGE && found.status == ESKEL_OK)
		return refuse_step(field, options, most, error);
	if (status != ESKEL_OK && error)
		*error = found;
	return status;
}
