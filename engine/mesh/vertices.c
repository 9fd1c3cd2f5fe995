/* Vertices are numbered by block, direction of the edge, and place, those of snapped nodes last: a number is that of the first
 * one of its kind in the block, and the count of bits below its own. */
#include "vertices.h"

#include "memory.h"
#include "roots.h"
#include "snapping.h"

#include <math.h>
#include <stdlib.h>
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

static int opposite(int slot)
{
	return slot < ESK_DIRECTIONS ? slot + ESK_DIRECTIONS : slot - ESK_DIRECTIONS;
}

/* From a node to the neighbour in a slot, turned around where the node is outside. */
static void add_edge(const esk_lattice *l, esk_vertices *v, uint32_t node, int slot)
{
	const uint32_t other = esk_lattice_next(l, node, slot);
	const bool inside = esk_lattice_has(l, node, ESK_INSIDE);
	v->edges[v->count++] = (esk_edge){inside ? node : other, (uint32_t)(inside ? slot : opposite(slot))};
}

static void add_cut_edges(const esk_lattice *l, esk_vertices *v, uint32_t block, int direction)
{
	for (uint64_t rest = l->blocks[block].vertices[direction]; rest; rest &= rest - 1)
		add_edge(l, v, block << ESK_PLACE_BITS | (uint32_t)__builtin_ctzll(rest), direction);
}

static void add_snapped_edges(const esk_lattice *l, esk_vertices *v, uint32_t block)
{
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
		add_edge(l, v, node, esk_snap_slot(l, node, esk_words_bits(cut, place)));
	}
}

bool esk_vertices_make(esk_lattice *l, esk_vertices *v)
{
	size_t count = 0;
	for (size_t b = 0; b < l->block_count; b++) {
		find_vertices(l, (uint32_t)b);
		for (int kind = 0; kind < ESK_VERTEX_KINDS; kind++) {
			l->blocks[b].first[kind] = (uint32_t)count;
			count += (size_t)__builtin_popcountll(l->blocks[b].vertices[kind]);
		}
	}
	v->edges = esk_memory_array(count, sizeof *v->edges);
	if (!v->edges)
		return false;
	for (size_t b = 0; b < l->block_count; b++) {
		for (int d = 0; d < ESK_DIRECTIONS; d++)
			add_cut_edges(l, v, (uint32_t)b, d);
		add_snapped_edges(l, v, (uint32_t)b);
	}
	return true;
}

void esk_vertices_clear(esk_vertices *v)
{
	free(v->edges);
	*v = (esk_vertices){0};
}

/* ---- where they lie */

/* In step_half: the way to the neighbour in a slot. */
static void find_ways(double ways[ESK_NEIGHBOURS][3])
{
	for (int s = 0; s < ESK_NEIGHBOURS; s++) {
		const int mask = s % ESK_DIRECTIONS + 1, sign = s < ESK_DIRECTIONS ? 1 : -1;
		for (int a = 0; a < 3; a++)
			ways[s][a] = sign * (__builtin_popcount((unsigned)mask) - 2 * (mask >> a & 1));
	}
}

/* Ends of cut edges are active, and so all of their neighbours known. */
static void find_root(const esk_lattice *l, const esk_edge *e, const double way[3], size_t i, esk_roots *roots)
{
	const int slot = (int)e->slot;
	const uint32_t outside = esk_lattice_next(l, e->inside, slot);
	double position[3];
	esk_lattice_find(l, e->inside, position);
	for (int a = 0; a < 3; a++) {
		roots->inside[a][i] = position[a];
		roots->along[a][i] = way[a] * l->step_half;
	}
	roots->values[0][i] = esk_lattice_value(l, esk_lattice_next(l, e->inside, opposite(slot)));
	roots->values[1][i] = esk_lattice_value(l, e->inside);
	roots->values[2][i] = esk_lattice_value(l, outside);
	roots->values[3][i] = esk_lattice_value(l, esk_lattice_next(l, outside, slot));
}

static void write_normal(const double gradient[3], float normal[3])
{
	const double length = sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
	for (int a = 0; a < 3; a++)
		normal[a] = (float)(length > 0 && length < INFINITY ? gradient[a] / length : 0);
}

void esk_vertices_place(const esk_vertices *v, const esk_lattice *l, float (*positions)[3], float (*normals)[3])
{
	esk_roots roots;
	double ways[ESK_NEIGHBOURS][3], points[ESK_ROOTS_MOST][3], gradients[ESK_ROOTS_MOST][3];
	find_ways(ways);
	for (size_t first = 0; first < v->count; first += ESK_ROOTS_MOST) {
		const size_t rest = v->count - first, count = rest < ESK_ROOTS_MOST ? rest : ESK_ROOTS_MOST;
		for (size_t i = 0; i < count; i++) {
			const esk_edge *e = &v->edges[first + i];
			find_root(l, e, ways[e->slot], i, &roots);
		}
		esk_roots_find(l->field, count, &roots, points, gradients);
		for (size_t i = 0; i < count; i++) {
			for (int a = 0; a < 3; a++)
				positions[first + i][a] = (float)points[i][a];
			write_normal(gradients[i], normals[first + i]);
		}
	}
}
