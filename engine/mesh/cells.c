/* For one of the six tetrahedra of a cube after the other, all cubes of a block at once: which of them the surface
 * crosses is a word of bits. What is crossed has its polygon in a table, by which of its corners are inside, and which
 * snapped. */
#include "cells.h"

#include "lanes.h"
#include "memory.h"

#include <stdlib.h>

/* A corner of a polygon: the slot from a cube's first node to the node at which a vertex is numbered, and its kind. */
typedef struct {
	uint8_t slot, kind;
} corner;

typedef struct {
	uint8_t count;
	corner corners[4];
} crossing;

typedef struct {
	const esk_lattice *lattice;
	const esk_star *star;
	const float (*positions)[3];
	esk_cells *cells;
	crossing crossings[ESK_TETRAHEDRA][1 << 8]; /* by corners inside, and 16 times those snapped */
} work;

/* ---- the table */

/* The vertex between two corners of a cube, of which the second is outside. */
static corner corner_between(unsigned in, unsigned out, bool snapped)
{
	const unsigned lower = in < out ? in : out, upper = in < out ? out : in;
	if (snapped)
		return (corner){(uint8_t)esk_slot_of((int)out, false), ESK_DIRECTIONS};
	return (corner){(uint8_t)esk_slot_of((int)lower, false), (uint8_t)((upper & ~lower) - 1)};
}

/* Corners that are the same vertex, one after another, count once. */
static void keep_different(const corner *corners, int count, crossing *made)
{
	made->count = 0;
	for (int c = 0; c < count; c++) {
		const corner *next = &corners[c + 1 < count ? c + 1 : 0];
		if (corners[c].slot != next->slot || corners[c].kind != next->kind)
			made->corners[made->count++] = corners[c];
	}
}

/* Which edges of a tetrahedron with a set of corners inside its polygon has its own corners on: from a corner inside to one
 * outside, counterclockwise from outside.
 *
 * Of corners a, b, c, d of positive volume, (b - a) x (c - a) points to d. So with a alone inside, its cuts to b, c, d run
 * counterclockwise; with d alone outside, the cuts from a, b, c to it do; with a and b inside, ac, ad, bd, bc. */
static void make_crossing(const esk_tetrahedron *t, unsigned inside_set, unsigned snapped_set, crossing *made)
{
	static const uint8_t edges[4][4][2] = {
		{{0}}, {{0, 1}, {0, 2}, {0, 3}}, {{0, 2}, {0, 3}, {1, 3}, {1, 2}}, {{0, 3}, {1, 3}, {2, 3}}};
	uint8_t order[4], others[4]; /* corners inside first */
	int inside = 0, outside = 0;
	bool odd = t->reversed;
	for (uint8_t c = 0; c < 4; c++)
		if (inside_set >> c & 1) {
			order[inside++] = c;
			odd ^= outside & 1; /* it passes those before it that are outside */
		} else {
			others[outside++] = c;
		}
	for (int c = 0; c < outside; c++)
		order[inside + c] = others[c];
	corner corners[4];
	const int count = inside % 4 == 0 ? 0 : inside == 2 ? 4 : 3;
	for (int e = 0; e < count; e++) {
		const uint8_t *ends = edges[inside][odd ? count - 1 - e : e];
		const uint8_t in = order[ends[0]], out = order[ends[1]];
		corners[e] = corner_between(t->corners[in], t->corners[out], snapped_set >> out & 1);
	}
	keep_different(corners, count, made);
}

static void make_crossings(work *w)
{
	for (int t = 0; t < ESK_TETRAHEDRA; t++)
		for (unsigned inside = 0; inside < 16; inside++)
			for (unsigned snapped = 0; snapped < 16; snapped++) {
				if (!(inside & snapped))
					make_crossing(&w->star->tetrahedra[t], inside, snapped,
						&w->crossings[t][snapped << 4 | inside]);
			}
}

/* ---- blocks */

/* By slot: a block, those around it, and words about the corners of its cubes. */
typedef struct {
	esk_block *blocks[ESK_AROUND];
	uint64_t inside[ESK_AROUND], snapped[ESK_AROUND], active[ESK_AROUND];
} neighbourhood;

/* Of a tetrahedron in each cube of a block: words of the corners inside, then of those snapped; and which has a polygon. */
typedef struct {
	uint64_t corners[8], crossed;
} crossed_cubes;

ESK_IN_LANES uint64_t two_of(uint64_t a, uint64_t b, uint64_t c, uint64_t d)
{
	return (a & b) | (c & d) | ((a | b) & (c | d));
}

/* The cubes of a block of which a tetrahedron has a polygon.
 *
 * Its corners are all active, where their signs differ; or all but one, where that one is inside and the others too, but
 * snapped. So of any two of them, the blocks know of each other, and no word is missed. And the polygon has an area,
 * unless the corners outside are all snapped and more than one is inside: they shrink it to an edge or a vertex. */
ESK_IN_LANES void find_crossed(const neighbourhood *n, const esk_tetrahedron *t, crossed_cubes *cubes)
{
	uint64_t *in = cubes->corners, active[4], smooth = 0; /* some corner is neither inside nor snapped */
	for (int c = 0; c < 4; c++) {
		const int slot = esk_slot_of(t->corners[c], false);
		in[c] = n->inside[slot];
		in[4 + c] = n->snapped[slot];
		active[c] = n->active[slot];
		smooth |= ~(in[c] | in[4 + c]);
	}
	const uint64_t any = in[0] | in[1] | in[2] | in[3], all = in[0] & in[1] & in[2] & in[3];
	const uint64_t three_active =
		(active[0] & active[1] & (active[2] | active[3])) | (active[2] & active[3] & (active[0] | active[1]));
	cubes->crossed = any & ~all & three_active & (smooth | ~two_of(in[0], in[1], in[2], in[3]));
}

ESK_IN_LANES uint32_t vertex_at(const esk_lattice *l, const neighbourhood *n, int place, corner c)
{
	const esk_block *block = n->blocks[l->next_slots[place][c.slot]];
	const uint64_t before = ((uint64_t)1 << l->next_places[place][c.slot]) - 1;
	return block->first[c.kind] + (uint32_t)__builtin_popcountll(block->vertices[c.kind] & before);
}

ESK_IN_LANES unsigned corners_at(const crossed_cubes *cubes, int place)
{
	uint64_t bits = 0;
	for (int c = 0; c < 8; c++)
		bits |= (cubes->corners[c] >> place & 1) << c;
	return (unsigned)bits;
}

static double distance(const float a[3], const float b[3])
{
	double square = 0;
	for (int i = 0; i < 3; i++) {
		const double d = (double)a[i] - b[i];
		square += d * d;
	}
	return square;
}

static void add_triangle(esk_cells *cells, uint32_t a, uint32_t b, uint32_t c)
{
	uint32_t *triangle = cells->triangles[cells->count++];
	triangle[0] = a;
	triangle[1] = b;
	triangle[2] = c;
}

static void add_quadrangle(work *w, const uint32_t v[4])
{
	const float(*p)[3] = w->positions;
	const int turn = distance(p[v[1]], p[v[3]]) < distance(p[v[0]], p[v[2]]);
	add_triangle(w->cells, v[turn], v[turn + 1], v[turn + 2]);
	add_triangle(w->cells, v[turn], v[turn + 2], v[(turn + 3) % 4]);
}

ESK_IN_LANES void add_polygons(work *w, const neighbourhood *n, const crossing *crossings, const crossed_cubes *cubes)
{
	for (uint64_t rest = cubes->crossed; rest; rest &= rest - 1) {
		const int place = __builtin_ctzll(rest);
		const crossing *x = &crossings[corners_at(cubes, place)];
		uint32_t v[4];
		for (int c = 0; c < 3; c++)
			v[c] = vertex_at(w->lattice, n, place, x->corners[c]);
		if (x->count == 3) {
			add_triangle(w->cells, v[0], v[1], v[2]);
			continue;
		}
		v[3] = vertex_at(w->lattice, n, place, x->corners[3]);
		add_quadrangle(w, v);
	}
}

static bool reserve(esk_cells *cells, size_t count)
{
	void *triangles = cells->triangles;
	const bool good =
		esk_memory_reserve(&triangles, &cells->capacity, cells->count + count, sizeof *cells->triangles);
	cells->triangles = triangles;
	return good;
}

/* Whether a corner of a cube of the block is active. */
static bool find_neighbourhood(const esk_lattice *l, uint32_t b, neighbourhood *n)
{
	uint64_t any = 0;
	esk_lattice_around(l, b, n->blocks);
	for (int m = 0; m < 8; m++)
		any |= n->blocks[esk_slot_of(m, false)]->words[ESK_ACTIVE];
	if (!any)
		return false;
	esk_lattice_gather(l, b, ESK_FILLED, false, n->inside);
	esk_lattice_gather(l, b, ESK_SNAPPED, false, n->snapped);
	esk_lattice_gather(l, b, ESK_ACTIVE, false, n->active);
	return true;
}

ESK_EVERY_WIDTH static bool add_block(work *w, uint32_t b)
{
	neighbourhood n;
	crossed_cubes cubes[ESK_TETRAHEDRA];
	size_t count = 0;
	if (!find_neighbourhood(w->lattice, b, &n))
		return true;
	for (int t = 0; t < ESK_TETRAHEDRA; t++) {
		find_crossed(&n, &w->star->tetrahedra[t], &cubes[t]);
		count += (size_t)__builtin_popcountll(cubes[t].crossed);
	}
	if (!reserve(w->cells, 2 * count))
		return false;
	for (int t = 0; t < ESK_TETRAHEDRA; t++)
		add_polygons(w, &n, w->crossings[t], &cubes[t]);
	return true;
}

bool esk_cells_make(const esk_lattice *lattice, const esk_star *star, size_t vertex_count, const float (*positions)[3],
	esk_cells *cells)
{
	work w = {.lattice = lattice, .star = star, .positions = positions, .cells = cells};
	make_crossings(&w);
	/* Euler's formula, but for 4 a component less or a handle more, and a block that is taken for one of quadrangles. */
	bool good = reserve(cells, 2 * vertex_count + 2 * ESK_TETRAHEDRA * ESK_PLACES);
	for (size_t b = 0; b < lattice->block_count && good; b++)
		good = add_block(&w, (uint32_t)b);
	return good;
}

void esk_cells_clear(esk_cells *cells)
{
	free(cells->triangles);
	*cells = (esk_cells){0};
}
