/* Vertices are numbered by block, direction of the edge, and place, those of snapped nodes last: a number is that of the first
 * one of its kind in the block, and the count of bits below its own. Polygons come from cubes with nodes inside and outside,
 * six tetrahedra each; where a corner of one is active, all of its corners are known. */
#include "cells.h"

#include "lanes.h"
#include "memory.h"
#include "snapping.h"

#include <stdlib.h>
#include <string.h>

/* Of a tetrahedron, by which of its corners are inside. */
typedef struct {
	int count;           /* of corners of the polygon */
	uint8_t edges[4][2]; /* that they lie on */
} crossing;

typedef struct {
	esk_lattice *lattice;
	const esk_star *star;
	crossing crossings[2][16]; /* of tetrahedra, and of reversed ones */
	uint8_t crossed[256];      /* tetrahedra of a cube, a bit each, by which of its corners are inside */
	esk_cells *cells;
} work;

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
	const bool inside = esk_lattice_has(w->lattice, node, ESK_INSIDE);
	w->cells->edges[w->cells->edge_count++] = inside ? (esk_edge){node, other} : (esk_edge){other, node};
}

static void add_cut_edges(work *w, uint32_t block, int direction)
{
	const esk_lattice *l = w->lattice;
	for (uint64_t rest = l->blocks[block].cuts[direction]; rest; rest &= rest - 1) {
		const uint32_t node = block << ESK_PLACE_BITS | (uint32_t)__builtin_ctzll(rest);
		add_edge(w, node, esk_lattice_next(l, node, direction));
	}
}

static void add_snapped_edges(work *w, uint32_t block)
{
	const esk_lattice *l = w->lattice;
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
	const esk_lattice *l = w->lattice;
	size_t count = 0;
	for (size_t b = 0; b < l->block_count; b++) {
		find_cuts(l, (uint32_t)b);
		for (int kind = 0; kind <= SNAPPED; kind++) {
			l->blocks[b].first[kind] = (uint32_t)count;
			count += (size_t)__builtin_popcountll(vertices_of(&l->blocks[b], kind));
		}
	}
	w->cells->edges = esk_memory_array(count, sizeof *w->cells->edges);
	for (size_t b = 0; b < l->block_count && w->cells->edges; b++) {
		for (int d = 0; d < ESK_DIRECTIONS; d++)
			add_cut_edges(w, (uint32_t)b, d);
		add_snapped_edges(w, (uint32_t)b);
	}
	return w->cells->edges;
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
	esk_polygon p = {{ESK_NO_VERTEX, ESK_NO_VERTEX, ESK_NO_VERTEX, ESK_NO_VERTEX}};
	int kept = 0;
	for (int c = 0; c < count; c++)
		if (corners[c] != corners[c + 1 < count ? c + 1 : 0])
			p.corners[kept++] = corners[c];
	w->cells->polygons[w->cells->polygon_count++] = p;
	w->cells->triangle_count += (size_t)kept - 2;
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
		corners[e] = vertex_between(w->lattice, c, t->corners[x->edges[e][0]], t->corners[x->edges[e][1]]);
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
	for (unsigned rest = w->crossed[c->inside]; rest; rest &= rest - 1) {
		const esk_tetrahedron *t = &w->star->tetrahedra[__builtin_ctz(rest)];
		const unsigned all = t->set;
		if (c->active & all && has_area(c->inside & all, ~c->inside & all, c->snapped & all))
			add_tetrahedron(w, c, t);
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
	const esk_lattice *l = w->lattice;
	uint64_t inside[ESK_AROUND], snapped[ESK_AROUND], active[ESK_AROUND];
	const size_t most = w->cells->polygon_count + ESK_TETRAHEDRA * ESK_PLACES;
	void *polygons = w->cells->polygons;
	if (!esk_memory_reserve(&polygons, &w->cells->polygon_capacity, most, sizeof *w->cells->polygons))
		return false;
	w->cells->polygons = polygons;
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

static unsigned find_crossed(const esk_star *star, unsigned inside)
{
	unsigned crossed = 0;
	for (int t = 0; t < ESK_TETRAHEDRA; t++) {
		const unsigned all = star->tetrahedra[t].set;
		crossed |= (unsigned)((inside & all) && (inside & all) != all) << t;
	}
	return crossed;
}

bool esk_cells_make(esk_lattice *lattice, const esk_star *star, esk_cells *cells)
{
	work w = {.lattice = lattice, .star = star, .cells = cells};
	for (unsigned inside = 0; inside < 16; inside++)
		for (int reversed = 0; reversed < 2; reversed++)
			make_crossing(inside, reversed, &w.crossings[reversed][inside]);
	for (unsigned inside = 0; inside < 256; inside++)
		w.crossed[inside] = (uint8_t)find_crossed(star, inside);
	bool good = make_vertices(&w);
	for (size_t b = 0; b < lattice->block_count && good; b++)
		good = add_cubes(&w, (uint32_t)b);
	return good;
}

void esk_cells_clear(esk_cells *cells)
{
	free(cells->edges);
	free(cells->polygons);
	*cells = (esk_cells){0};
}
