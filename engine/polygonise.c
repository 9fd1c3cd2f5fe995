/* Marching tetrahedra on the body-centred cubic lattice.
 *
 * The surface is followed (continuation.h), nodes next to it are snapped to it (snapping.h), and each tetrahedron with nodes
 * inside and outside gives a triangle or a quadrangle, whose corners lie on its edges: a vertex is a cut of an edge, or a
 * snapped node. Vertices are found on their edges (roots.h); then quadrangles are divided along the shorter diagonal.
 *
 * Vertices are numbered by block, direction of the edge, and place: a number is that of the first one of its kind in the
 * block and the count of bits below it.
 *
 * In a row of tetrahedra that share a face, each has one edge of the mesh in it: the mesh is closed and a manifold whatever
 * the field is, and its triangles are oriented as the tetrahedra are. */
#include "polygonise.h"

#include "error.h"
#include "memory.h"
#include "lanes.h"
#include "mesh.h"
#include "roots.h"
#include "snapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t default_triangles_max = (size_t)1 << 24;

#define NO_VERTEX UINT32_MAX

static const double longest_box = 1 << 20; /* in steps; coordinates of the lattice are at most twice that */

typedef struct {
	uint32_t corners[4]; /* vertices; the last is NO_VERTEX in a triangle */
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
	crossing crossings[2][16]; /* of tetrahedra, and of reversed ones */
	edge *edges;
	size_t edge_count;
	polygon *polygons;
	size_t polygon_count, polygon_capacity;
	size_t triangle_count;
} work;

static void clear(work *w)
{
	esk_lattice_clear(&w->trace.lattice);
	free(w->edges);
	free(w->polygons);
}

/* ---- vertices */

enum { SNAPPED = ESK_DIRECTIONS }; /* the kind of vertex after those on edges by direction */

static uint64_t vertices_of(const esk_block *block, int kind)
{
	return kind == SNAPPED ? block->words[ESK_SNAPPED] : block->cuts[kind];
}

/* Edges from active nodes on, from inside to outside, of which neither end is snapped. */
static void find_cuts(const esk_lattice *l, uint32_t b)
{
	esk_block *block = &l->blocks[b];
	uint64_t filled[ESK_AROUND], snapped[ESK_AROUND];
	memset(block->cuts, 0, sizeof block->cuts);
	if (!block->words[ESK_ACTIVE])
		return;
	esk_lattice_gather(l, b, ESK_FILLED, false, filled);
	esk_lattice_gather(l, b, ESK_SNAPPED, false, snapped);
	for (int d = 0; d < ESK_DIRECTIONS; d++)
		block->cuts[d] =
			block->words[ESK_ACTIVE] & (filled[ESK_OWN] ^ filled[d]) & ~(snapped[ESK_OWN] | snapped[d]);
}

static void add_edge(work *w, uint32_t node, uint32_t other)
{
	const bool inside = esk_lattice_has(&w->trace.lattice, node, ESK_INSIDE);
	w->edges[w->edge_count++] = inside ? (edge){node, other} : (edge){other, node};
}

static void add_cut_edges(work *w, uint32_t block, int direction)
{
	const esk_lattice *l = &w->trace.lattice;
	for (uint64_t rest = l->blocks[block].cuts[direction]; rest; rest &= rest - 1) {
		const uint32_t node = block << ESK_PLACE_BITS | (uint32_t)__builtin_ctzll(rest);
		add_edge(w, node, esk_lattice_next(l, node, direction));
	}
}

static void add_snapped_edges(work *w, uint32_t block)
{
	const esk_lattice *l = &w->trace.lattice;
	const uint64_t *words = l->blocks[block].words;
	uint64_t cut[ESK_AROUND];
	if (!words[ESK_SNAPPED])
		return;
	esk_lattice_gather(l, block, ESK_INSIDE, false, cut);
	esk_lattice_gather(l, block, ESK_INSIDE, true, cut);
	for (int s = 0; s < ESK_NEIGHBOURS; s++)
		cut[s] ^= words[ESK_INSIDE];
	for (uint64_t rest = words[ESK_SNAPPED]; rest; rest &= rest - 1) {
		const int place = __builtin_ctzll(rest);
		const uint32_t node = block << ESK_PLACE_BITS | (uint32_t)place;
		add_edge(w, node, esk_snap_other(l, node, esk_words_bits(cut, place)));
	}
}

static bool make_vertices(work *w)
{
	const esk_lattice *l = &w->trace.lattice;
	size_t count = 0;
	for (size_t b = 0; b < l->block_count; b++) {
		find_cuts(l, (uint32_t)b);
		for (int kind = 0; kind <= SNAPPED; kind++) {
			l->blocks[b].first[kind] = (uint32_t)count;
			count += (size_t)__builtin_popcountll(vertices_of(&l->blocks[b], kind));
		}
	}
	w->edges = esk_memory_array(count, sizeof *w->edges);
	for (size_t b = 0; b < l->block_count && w->edges; b++) {
		for (int d = 0; d < ESK_DIRECTIONS; d++)
			add_cut_edges(w, (uint32_t)b, d);
		add_snapped_edges(w, (uint32_t)b);
	}
	return w->edges;
}

/* ---- polygons */

/* A cube of eight nodes, by their masks. */
typedef struct {
	uint32_t first;
	unsigned inside, snapped, active; /* a bit each */
} cube;

ESK_IN_LANES uint32_t vertex_at(const esk_lattice *l, uint32_t node, int kind)
{
	const esk_block *block = esk_lattice_block(l, node);
	const uint64_t before = vertices_of(block, kind) & (esk_lattice_bit(node) - 1);
	return block->first[kind] + (uint32_t)__builtin_popcountll(before);
}

/* The vertex between two corners, of which the second is outside. */
ESK_IN_LANES uint32_t vertex_between(const esk_lattice *l, const cube *c, unsigned in, unsigned out)
{
	if (c->snapped >> out & 1)
		return vertex_at(l, esk_lattice_next(l, c->first, esk_slot_of((int)out, false)), SNAPPED);
	const unsigned lower = in < out ? in : out, upper = in < out ? out : in;
	const uint32_t node = esk_lattice_next(l, c->first, esk_slot_of((int)lower, false));
	return vertex_at(l, node, (int)(upper & ~lower) - 1);
}

/* Corners that are the same vertex, one after another, count once. There is room. */
ESK_IN_LANES void add_polygon(work *w, const uint32_t *corners, int count)
{
	polygon p = {{NO_VERTEX, NO_VERTEX, NO_VERTEX, NO_VERTEX}};
	int kept = 0;
	for (int c = 0; c < count; c++)
		if (corners[c] != corners[c + 1 < count ? c + 1 : 0])
			p.corners[kept++] = corners[c];
	w->polygons[w->polygon_count++] = p;
	w->triangle_count += (size_t)kept - 2;
}

/* Which edges of a tetrahedron with a set of corners inside its polygon has its own corners on: from a corner inside to one
 * outside, counterclockwise from outside.
 *
 * Of corners a, b, c, d of positive volume, (b - a) x (c - a) points to d. So with a alone inside, its cuts to b, c, d run
 * counterclockwise; with d alone outside, the cuts from a, b, c to it do; with a and b inside, ac, ad, bd, bc. */
static void make_crossing(unsigned inside_set, bool reversed, crossing *made)
{
	static const uint8_t edges[4][4][2] = {
		{{0}}, {{0, 1}, {0, 2}, {0, 3}}, {{0, 2}, {0, 3}, {1, 3}, {1, 2}}, {{0, 3}, {1, 3}, {2, 3}}};
	uint8_t order[4], others[4]; /* corners inside first */
	int inside = 0, outside = 0;
	bool odd = reversed;
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

/* Not where the corners outside are all snapped and more than one is inside: they shrink the polygon to an edge or a vertex.
 * Sets are of at most four corners. */
ESK_IN_LANES bool has_area(unsigned inside, unsigned outside, unsigned snapped)
{
	const bool is_one_inside = !(inside & (inside - 1));
	return is_one_inside || outside != snapped;
}

ESK_IN_LANES void add_tetrahedron(work *w, const cube *c, const esk_tetrahedron *t)
{
	unsigned inside = 0;
	for (int i = 0; i < 4; i++)
		inside |= (c->inside >> t->corners[i] & 1) << i;
	const crossing *x = &w->crossings[t->reversed][inside];
	uint32_t corners[4];
	for (int e = 0; e < x->count; e++)
		corners[e] =
			vertex_between(&w->trace.lattice, c, t->corners[x->edges[e][0]], t->corners[x->edges[e][1]]);
	add_polygon(w, corners, x->count);
}

ESK_IN_LANES unsigned corner_bits(const uint64_t near[ESK_AROUND], int place)
{
	unsigned bits = 0;
	for (int m = 0; m < 8; m++)
		bits |= (unsigned)(near[esk_slot_of(m, false)] >> place & 1) << m;
	return bits;
}

/* All corners of a tetrahedron with an active one are known. */
ESK_IN_LANES void add_cube(work *w, const cube *c)
{
	for (int t = 0; t < ESK_TETRAHEDRA; t++) {
		const unsigned all = w->star.tetrahedra[t].set, inside = c->inside & all, outside = all & ~inside;
		if (c->active & all && inside && outside && has_area(inside, outside, c->snapped & all))
			add_tetrahedron(w, c, &w->star.tetrahedra[t]);
	}
}

/* The cubes from nodes of a block on that the surface may cross. */
ESK_IN_LANES uint64_t find_cubes(const uint64_t inside[ESK_AROUND], const uint64_t active[ESK_AROUND])
{
	uint64_t any_active = 0, any_inside = 0, all_inside = UINT64_MAX;
	for (int m = 0; m < 8; m++) {
		const int slot = esk_slot_of(m, false);
		any_active |= active[slot];
		any_inside |= inside[slot];
		all_inside &= inside[slot];
	}
	return any_active & any_inside & ~all_inside;
}

ESK_EVERY_WIDTH static bool add_cubes(work *w, uint32_t b)
{
	const esk_lattice *l = &w->trace.lattice;
	uint64_t inside[ESK_AROUND], snapped[ESK_AROUND], active[ESK_AROUND];
	const size_t most = w->polygon_count + ESK_TETRAHEDRA * ESK_PLACES;
	void *polygons = w->polygons;
	if (!esk_memory_reserve(&polygons, &w->polygon_capacity, most, sizeof *w->polygons))
		return false;
	w->polygons = polygons;
	esk_lattice_gather(l, b, ESK_ACTIVE, false, active);
	esk_lattice_gather(l, b, ESK_FILLED, false, inside);
	uint64_t cubes = find_cubes(inside, active);
	if (!cubes)
		return true;
	esk_lattice_gather(l, b, ESK_SNAPPED, false, snapped);
	for (; cubes; cubes &= cubes - 1) {
		const int place = __builtin_ctzll(cubes);
		const cube c = {b << ESK_PLACE_BITS | (uint32_t)place, corner_bits(inside, place),
			corner_bits(snapped, place), corner_bits(active, place)};
		add_cube(w, &c);
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
		const edge *e = &w->edges[first + i];
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
		const bool is_quadrangle = c[3] != NO_VERTEX;
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
	esk_lattice_start(lattice, field, origin, step * cbrt(2) / 2);
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
	return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for a mesh of %zu triangles", w->triangle_count);
}

static eskel_status make_polygons(work *w, eskel_error *error)
{
	esk_lattice *l = &w->trace.lattice;
	esk_star_make(&w->star);
	for (unsigned inside = 0; inside < 16; inside++)
		for (int reversed = 0; reversed < 2; reversed++)
			make_crossing(inside, reversed, &w->crossings[reversed][inside]);
	esk_lattice_link(l);
	esk_snap(l, &w->star);
	if (!make_vertices(w))
		return no_memory(w, error);
	for (size_t b = 0; b < l->block_count; b++)
		if (!add_cubes(w, (uint32_t)b))
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
