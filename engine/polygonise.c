/* Marching tetrahedra on the body-centred cubic lattice.
 *
 * The surface is followed (continuation.h), nodes next to it are snapped to it (snapping.h), and each tetrahedron with nodes
 * inside and outside gives a triangle or a quadrangle, whose corners lie on its edges: a vertex is a cut of an edge, or a
 * snapped node. Vertices are found on their edges by regula falsi; then quadrangles are divided along the shorter diagonal.
 *
 * In a row of tetrahedra that share a face, each has one edge of the mesh in it: the mesh is closed and a manifold whatever
 * the field is, and its triangles are oriented as the tetrahedra are. */
#include "polygonise.h"

#include "error.h"
#include "memory.h"
#include "mesh.h"
#include "roots.h"
#include "snapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t default_triangles_max = (size_t)1 << 24;

static const double longest_box = 1 << 20; /* in steps; coordinates of the lattice are at most twice that */

typedef struct {
	uint32_t corners[4]; /* vertices; the last is ESK_NO_NODE in a triangle */
} polygon;

/* The nodes of the edge that a vertex lies on. */
typedef struct {
	uint32_t inside, outside;
} edge;

/* Of a tetrahedron, by which of its corners are inside. */
typedef struct {
	int count;           /* of corners of the polygon */
	uint8_t edges[4][2]; /* that they lie on */
} crossing;

typedef struct {
	const esk_field *field;
	esk_trace trace;
	esk_star star;
	crossing crossings[16];
	uint8_t *states, *cuts; /* as esk_snap */
	edge *edges;
	size_t edge_count, edge_capacity;
	polygon *polygons;
	size_t polygon_count, polygon_capacity;
	size_t triangle_count;
} work;

static void clear(work *w)
{
	esk_trace_clear(&w->trace);
	free(w->states);
	free(w->cuts);
	free(w->edges);
	free(w->polygons);
}

static bool add_vertex(work *w, edge e, uint32_t *vertex)
{
	void *edges = w->edges;
	if (!esk_memory_reserve(&edges, &w->edge_capacity, w->edge_count + 1, sizeof *w->edges))
		return false;
	w->edges = edges;
	w->edges[w->edge_count] = e;
	*vertex = (uint32_t)w->edge_count++;
	return true;
}

/* The vertex of a snapped node lies on the edge whose cut is nearest to it. */
static bool snapped_vertex(work *w, uint32_t node, uint32_t *vertex)
{
	esk_active *active = &w->trace.actives[w->trace.lattice.active[node]];
	uint32_t *known = &active->vertices[ESK_DIRECTIONS];
	if (*known == ESK_NO_NODE) {
		const uint32_t other = active->neighbours[w->cuts[active - w->trace.actives]];
		const bool inside = esk_trace_inside(&w->trace, node);
		if (!add_vertex(w, inside ? (edge){node, other} : (edge){other, node}, known))
			return false;
	}
	*vertex = *known;
	return true;
}

/* The vertex between two corners of a cell, of which the second is outside. */
static bool cut_vertex(work *w, const esk_star_cell *cell, const uint32_t nodes[4], int in, int out, uint32_t *vertex)
{
	if (w->states[nodes[out]] & ESK_SNAPPED)
		return snapped_vertex(w, nodes[out], vertex);
	const int lower = in < out ? in : out, upper = in < out ? out : in;
	const int direction = cell->masks[upper] & ~cell->masks[lower];
	const uint32_t active = w->trace.lattice.active[nodes[lower]];
	uint32_t *known = &w->trace.actives[active].vertices[direction - 1];
	if (*known == ESK_NO_NODE && !add_vertex(w, (edge){nodes[in], nodes[out]}, known))
		return false;
	*vertex = *known;
	return true;
}

/* Corners that are the same vertex, one after another, count once. */
static bool add_polygon(work *w, const uint32_t *corners, int count)
{
	polygon p = {{ESK_NO_NODE, ESK_NO_NODE, ESK_NO_NODE, ESK_NO_NODE}};
	int kept = 0;
	for (int c = 0; c < count; c++)
		if (corners[c] != corners[(c + 1) % count])
			p.corners[kept++] = corners[c];
	void *polygons = w->polygons;
	if (!esk_memory_reserve(&polygons, &w->polygon_capacity, w->polygon_count + 1, sizeof *w->polygons))
		return false;
	w->polygons = polygons;
	w->polygons[w->polygon_count++] = p;
	w->triangle_count += (size_t)kept - 2;
	return true;
}

/* Which edges of a tetrahedron with a set of corners inside its polygon has its own corners on: from a corner inside to one
 * outside, counterclockwise from outside.
 *
 * Of corners a, b, c, d of positive volume, (b - a) x (c - a) points to d. So with a alone inside, its cuts to b, c, d run
 * counterclockwise; with d alone outside, the cuts from a, b, c to it do; with a and b inside, ac, ad, bd, bc. */
static void make_crossing(unsigned inside_set, crossing *made)
{
	static const uint8_t edges[4][4][2] = {
		{{0}}, {{0, 1}, {0, 2}, {0, 3}}, {{0, 2}, {0, 3}, {1, 3}, {1, 2}}, {{0, 3}, {1, 3}, {2, 3}}};
	uint8_t order[4], others[4]; /* corners inside first */
	int inside = 0, outside = 0;
	bool odd = false;
	for (uint8_t c = 0; c < 4; c++)
		if (inside_set >> c & 1) {
			order[inside++] = c;
			odd ^= outside & 1; /* it passes those before it that are outside */
		} else {
			others[outside++] = c;
		}
	for (int c = 0; c < outside; c++)
		order[inside + c] = others[c];
	made->count = inside % 4 == 0 ? 0 : inside == 2 ? 4 : 3;
	for (int e = 0; e < made->count; e++) {
		const uint8_t *ends = edges[inside][odd ? made->count - 1 - e : e];
		made->edges[e][0] = order[ends[0]];
		made->edges[e][1] = order[ends[1]];
	}
}

static bool add_cell(work *w, const esk_star_cell *cell, const uint32_t nodes[4])
{
	unsigned inside = 0;
	for (int c = 0; c < 4; c++)
		inside |= (w->states[nodes[c]] & (unsigned)ESK_INSIDE) << c;
	const crossing *x = &w->crossings[inside];
	uint32_t corners[4];
	for (int e = 0; e < x->count; e++)
		if (!cut_vertex(w, cell, nodes, x->edges[e][0], x->edges[e][1],
			    &corners[cell->reversed ? x->count - 1 - e : e]))
			return false;
	return add_polygon(w, corners, x->count);
}

/* Not where the corners outside are all snapped and more than one is inside: they shrink the polygon to an edge or a vertex.
 * Sets are of at most four corners. */
static bool has_area(unsigned inside, unsigned outside, unsigned snapped)
{
	const bool is_one_inside = !(inside & (inside - 1));
	return is_one_inside || outside != snapped;
}

/* The cells around an active node that are no earlier one's. */
static bool add_star(work *w, const esk_active *active)
{
	/* The node itself is in the slot after those of its neighbours. */
	unsigned inside = 0, snapped = 0, earlier = 0;
	for (int s = 0; s <= ESK_NEIGHBOURS; s++) {
		const uint32_t node = s < ESK_NEIGHBOURS ? active->neighbours[s] : active->node;
		const unsigned state = w->states[node];
		inside |= (state & ESK_INSIDE) << s;
		snapped |= (state / ESK_SNAPPED & 1) << s;
		earlier |= (state / ESK_ACTIVE & (node < active->node)) << s;
	}
	const unsigned own = 1u << ESK_NEIGHBOURS;
	uint32_t cells = esk_star_cells(&w->star, inside & own ? ~inside : inside) & ~esk_star_cells(&w->star, earlier);
	for (; cells; cells &= cells - 1) {
		const esk_star_cell *cell = &w->star.cells[__builtin_ctz(cells)];
		const unsigned all = cell->others | own;
		if (!has_area(inside & all, ~inside & all, snapped & all))
			continue;
		uint32_t nodes[4];
		for (int c = 0; c < 4; c++)
			nodes[c] = cell->slots[c] == ESK_NEIGHBOURS ? active->node : active->neighbours[cell->slots[c]];
		if (!add_cell(w, cell, nodes))
			return false;
	}
	return true;
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

/* The ends of the edges of a batch of vertices, and the field there. */
static void find_ends(const work *w, size_t first, size_t count, esk_root *roots)
{
	const esk_lattice *l = &w->trace.lattice;
	for (size_t i = 0; i < count; i++) {
		const edge *e = &w->edges[first + i];
		roots[i].inside_value = l->values[e->inside];
		roots[i].outside_value = l->values[e->outside];
		esk_lattice_position(l, l->nodes[e->inside].at, roots[i].inside);
		esk_lattice_position(l, l->nodes[e->outside].at, roots[i].outside);
	}
}

static void write_vertices(const work *w, eskel_mesh *mesh)
{
	esk_root roots[BATCH];
	double points[BATCH][3], gradients[BATCH][3];
	for (size_t first = 0; first < w->edge_count; first += BATCH) {
		const size_t rest = w->edge_count - first, count = rest < BATCH ? rest : BATCH;
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
	for (size_t p = 0; p < w->polygon_count; p++) {
		const uint32_t *c = w->polygons[p].corners;
		const bool is_quadrangle = c[3] != ESK_NO_NODE;
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
	/* Two nodes in a cube of side 2 step_half. */
	*lattice = (esk_lattice){.step_half = step * cbrt(2) / 2, .field = field};
	for (int a = 0; a < 3; a++)
		lattice->origin[a] = (o->least[a] + o->greatest[a]) / 2;
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
		esk_trace_clear(&trace);
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
	esk_trace_clear(&trace);
	return status;
}

static eskel_status no_memory(const work *w, eskel_error *error)
{
	return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for a mesh of %zu triangles", w->triangle_count);
}

static eskel_status make_polygons(work *w, eskel_error *error)
{
	const esk_trace *trace = &w->trace;
	esk_star_make(&w->star);
	for (unsigned inside = 0; inside < 16; inside++)
		make_crossing(inside, &w->crossings[inside]);
	w->states = esk_memory_array(trace->lattice.node_count, sizeof *w->states);
	w->cuts = esk_memory_array(trace->count, sizeof *w->cuts);
	if (!w->states || !w->cuts)
		return no_memory(w, error);
	esk_snap(trace, &w->star, w->states, w->cuts);
	for (size_t n = 0; n < trace->count; n++)
		if (!add_star(w, &trace->actives[n]))
			return no_memory(w, error);
	return ESKEL_OK;
}

static eskel_status make_mesh(const work *w, eskel_mesh **mesh, eskel_error *error)
{
	eskel_mesh *made = esk_mesh_new(w->edge_count, w->triangle_count);
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
	const size_t most = options->triangles_max ? options->triangles_max : default_triangles_max;
	eskel_error found = {ESKEL_OK, ""};
	work w = {.field = field};
	start_lattice(field, options, options->step, &w.trace.lattice);
	status = esk_trace_surface(&w.trace, options, most, &found);
	if (status == ESKEL_OK)
		status = make_polygons(&w, &found);
	if (status == ESKEL_OK && w.triangle_count > most)
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
