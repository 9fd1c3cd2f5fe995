/* Vertices are numbered by block, direction of the edge, and place, those of snapped nodes last: a number is that of the
 * first one of its kind in the block, and the count of bits below its own. */
#include "vertices.h"

#include "lanes.h"
#include "roots.h"
#include "snapping.h"

#include <math.h>
#include <string.h>

/* Edges from active nodes on, from inside to outside, of which neither end is snapped. */
static void find_vertices(const esk_lattice *l, uint32_t b)
{
	esk_block *block = &l->blocks[b];
	uint64_t filled[ESK_AROUND], snapped[ESK_AROUND];
	memset(block->vertices, 0, sizeof block->vertices);
	if (!block->words[ESK_ACTIVE])
		return;
	esk_lattice_gather(l, b, ESK_FILLED, false, filled);
	esk_lattice_gather(l, b, ESK_SNAPPED, false, snapped);
	for (int d = 0; d < ESK_DIRECTIONS; d++)
		block->vertices[d] =
			block->words[ESK_ACTIVE] & (filled[ESK_OWN] ^ filled[d]) & ~(snapped[ESK_OWN] | snapped[d]);
	block->vertices[ESK_DIRECTIONS] = block->words[ESK_SNAPPED];
}

ESK_EVERY_WIDTH size_t esk_vertices_number(esk_lattice *l)
{
	size_t count = 0;
	for (size_t b = 0; b < l->block_count; b++) {
		esk_block *block = &l->blocks[b];
		find_vertices(l, (uint32_t)b);
		for (int kind = 0; kind < ESK_VERTEX_KINDS; kind++) {
			block->first[kind] = (uint32_t)count;
			count += (size_t)__builtin_popcountll(block->vertices[kind]);
		}
	}
	return count;
}

/* ---- where they lie */

typedef struct {
	const esk_lattice *lattice;
	double ways[ESK_NEIGHBOURS][3]; /* in mm, to the neighbour in a slot */
	esk_roots roots;
	size_t first, count; /* number of the first of the roots, and how many they are */
	float (*positions)[3], (*normals)[3];
} work;

static void find_ways(double step_half, double ways[ESK_NEIGHBOURS][3])
{
	for (int s = 0; s < ESK_NEIGHBOURS; s++) {
		const int mask = s % ESK_DIRECTIONS + 1, sign = s < ESK_DIRECTIONS ? 1 : -1;
		for (int a = 0; a < 3; a++)
			ways[s][a] = sign * (__builtin_popcount((unsigned)mask) - 2 * (mask >> a & 1)) * step_half;
	}
}

static void write_normal(const double gradient[3], float normal[3])
{
	const double length = sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
	for (int a = 0; a < 3; a++)
		normal[a] = (float)(length > 0 && length < INFINITY ? gradient[a] / length : 0);
}

static void place_roots(work *w)
{
	double points[ESK_ROOTS_MOST][3], gradients[ESK_ROOTS_MOST][3];
	esk_roots_find(w->lattice->field, w->count, &w->roots, points, gradients);
	for (size_t i = 0; i < w->count; i++) {
		for (int a = 0; a < 3; a++)
			w->positions[w->first + i][a] = (float)points[i][a];
		write_normal(gradients[i], w->normals[w->first + i]);
	}
	w->first += w->count;
	w->count = 0;
}

/* The vertex on the edge from a place in a block to the neighbour in a slot. Ends of cut edges are active, and so all of
 * their neighbours known. */
static void add_root(work *w, esk_block *const around[ESK_AROUND], int place, int slot)
{
	const esk_lattice *l = w->lattice;
	const int back = esk_slot_opposite(slot);
	const uint8_t *slots = l->next_slots[place], *places = l->next_places[place];
	const esk_block *block = around[ESK_OWN], *next = around[slots[slot]];
	const bool outside = !(block->words[ESK_INSIDE] >> place & 1);
	const uint32_t next_node = (uint32_t)(next - l->blocks) << ESK_PLACE_BITS | places[slot];
	esk_roots *r = &w->roots;
	double position[3];
	if (w->count == ESK_ROOTS_MOST)
		place_roots(w);
	const size_t i = w->count++;
	esk_lattice_find(l, outside ? next : block, outside ? places[slot] : place, position);
	for (int a = 0; a < 3; a++) {
		r->inside[a][i] = position[a];
		r->along[a][i] = w->ways[outside ? back : slot][a];
	}
	r->values[outside ? 3 : 0][i] = around[slots[back]]->values[places[back]];
	r->values[outside ? 2 : 1][i] = block->values[place];
	r->values[outside ? 1 : 2][i] = next->values[places[slot]];
	r->values[outside ? 0 : 3][i] = esk_lattice_value(l, esk_lattice_next(l, next_node, slot));
}

ESK_EVERY_WIDTH static void add_snapped_nodes(work *w, esk_block *const around[ESK_AROUND], uint32_t block)
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
		add_root(w, around, place, esk_snap_slot(l, around, place, esk_words_bits(cut, place)));
	}
}

void esk_vertices_place(const esk_lattice *l, float (*positions)[3], float (*normals)[3])
{
	work w;
	w.lattice = l;
	w.first = w.count = 0;
	w.positions = positions;
	w.normals = normals;
	find_ways(l->step_half, w.ways);
	for (uint32_t b = 0; b < l->block_count; b++) {
		esk_block *around[ESK_AROUND];
		if (!l->blocks[b].words[ESK_ACTIVE])
			continue;
		esk_lattice_around(l, b, around);
		for (int d = 0; d < ESK_DIRECTIONS; d++)
			for (uint64_t rest = l->blocks[b].vertices[d]; rest; rest &= rest - 1)
				add_root(&w, around, __builtin_ctzll(rest), d);
		add_snapped_nodes(&w, around, b);
	}
	place_roots(&w);
}
