#include "lattice.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	SIDE = 8, /* of a block, in nodes */
	SIDE_BITS = 3,
	BLOCK = SIDE * SIDE * SIDE,
	KEY_BITS = 21,
	AROUND = 27, /* a block and those next to it */
	BATCH = 256, /* points of a call: they and their values fit into the nearest cache */
};

/* Nodes that lie together, so that most neighbours are found without a search. */
struct esk_block {
	uint64_t key;
	uint32_t around
		[AROUND]; /* blocks at (x, y, z) from -1 to 1, by 9 (x + 1) + 3 (y + 1) + z + 1; 0: not known, else + 1 */
	uint32_t nodes[BLOCK]; /* 0: none, else the node + 1 */
};

void esk_lattice_clear(esk_lattice *l)
{
	free(l->nodes);
	free(l->values);
	free(l->active);
	free(l->blocks);
	free(l->table);
	*l = (esk_lattice){.step_half = l->step_half, .field = l->field};
}

static uint64_t key_of(const int32_t at[3])
{
	uint64_t key = 0;
	for (int a = 0; a < 3; a++)
		key = key << KEY_BITS | (uint64_t)((at[a] + ESK_LATTICE_REACH) >> SIDE_BITS);
	return key;
}

static size_t place_of(const esk_lattice *l, uint64_t key)
{
	/* Multiplication by 2^64 over the golden ratio spreads keys that differ in few bits (Knuth). */
	size_t place = (size_t)(key * 0x9e3779b97f4a7c15u >> 32) & (l->table_capacity - 1);
	while (l->table[place] && l->blocks[l->table[place] - 1].key != key)
		place = (place + 1) & (l->table_capacity - 1);
	return place;
}

/* At most half full. */
static bool reserve_table(esk_lattice *l)
{
	if (2 * (l->block_count + 1) <= l->table_capacity)
		return true;
	const size_t capacity = l->table_capacity ? 2 * l->table_capacity : 256;
	uint32_t *table = esk_memory_zeroed_array(capacity, sizeof *table);
	if (!table)
		return false;
	free(l->table);
	l->table = table;
	l->table_capacity = capacity;
	for (size_t b = 0; b < l->block_count; b++)
		table[place_of(l, l->blocks[b].key)] = (uint32_t)b + 1;
	return true;
}

static esk_block *block_of(esk_lattice *l, const int32_t at[3])
{
	if (!reserve_table(l))
		return NULL;
	const uint64_t key = key_of(at);
	const size_t place = place_of(l, key);
	if (!l->table[place]) {
		void *blocks = l->blocks;
		if (!esk_memory_reserve(&blocks, &l->block_capacity, l->block_count + 1, sizeof *l->blocks))
			return NULL;
		l->blocks = blocks;
		memset(&l->blocks[l->block_count], 0, sizeof *l->blocks);
		l->blocks[l->block_count].key = key;
		l->table[place] = (uint32_t)++l->block_count;
	}
	return &l->blocks[l->table[place] - 1];
}

static size_t within(const int32_t at[3])
{
	size_t index = 0;
	for (int a = 0; a < 3; a++)
		index = index << SIDE_BITS | (size_t)(at[a] & (SIDE - 1));
	return index;
}

static bool make_node(esk_lattice *l, uint32_t *entry, const int32_t at[3])
{
	void *nodes = l->nodes;
	if (l->node_count == ESK_NO_NODE - 1 ||
		!esk_memory_reserve(&nodes, &l->node_capacity, l->node_count + 1, sizeof *l->nodes))
		return false;
	l->nodes = nodes;
	l->nodes[l->node_count] = (esk_node){{at[0], at[1], at[2]}};
	*entry = (uint32_t)++l->node_count;
	return true;
}

bool esk_lattice_node(esk_lattice *l, const int32_t at[3], uint32_t *node)
{
	esk_block *block = block_of(l, at);
	if (!block)
		return false;
	uint32_t *entry = &block->nodes[within(at)];
	if (!*entry && !make_node(l, entry, at))
		return false;
	*node = *entry - 1;
	return true;
}

/* What a block knows of the one in a direction that at lies in. Blocks move when one is made. */
static bool find_around(esk_lattice *l, size_t home, size_t direction, const int32_t at[3])
{
	if (l->blocks[home].around[direction])
		return true;
	const esk_block *block = block_of(l, at);
	if (!block)
		return false;
	l->blocks[home].around[direction] = (uint32_t)(block - l->blocks) + 1;
	return true;
}

/* Neighbours across the block's border, and those that are new. */
static bool find_neighbour(esk_lattice *l, size_t home, const int32_t at[3], int slot, uint32_t *neighbour)
{
	const int mask = slot % ESK_DIRECTIONS + 1, sign = slot < ESK_DIRECTIONS ? 1 : -1;
	int32_t to[3];
	size_t direction = 0;
	for (int a = 0; a < 3; a++) {
		to[a] = at[a] + sign * (mask >> a & 1);
		direction = 3 * direction + (size_t)((to[a] >> SIDE_BITS) - (at[a] >> SIDE_BITS) + 1);
	}
	if (!find_around(l, home, direction, to))
		return false;
	uint32_t *entry = &l->blocks[l->blocks[home].around[direction] - 1].nodes[within(to)];
	if (!*entry && !make_node(l, entry, to))
		return false;
	*neighbour = *entry - 1;
	return true;
}

bool esk_lattice_neighbours(esk_lattice *l, uint32_t node, uint32_t neighbours[ESK_NEIGHBOURS])
{
	static const int strides[ESK_DIRECTIONS] = {64, 8, 72, 1, 65, 9, 73}; /* as within() */
	const int32_t at[3] = {l->nodes[node].at[0], l->nodes[node].at[1], l->nodes[node].at[2]};
	const esk_block *block = block_of(l, at);
	if (!block)
		return false;
	const size_t home = (size_t)(block - l->blocks);
	const int place = (int)within(at);
	bool ends[2] = {false, false}; /* of the block: no neighbours further on, or further back, in it */
	for (int a = 0; a < 3; a++) {
		ends[0] |= (at[a] & (SIDE - 1)) == SIDE - 1;
		ends[1] |= (at[a] & (SIDE - 1)) == 0;
	}
	for (int back = 0; back < 2; back++)
		for (int d = 0; d < ESK_DIRECTIONS; d++) {
			uint32_t *neighbour = &neighbours[back * ESK_DIRECTIONS + d];
			const int to = place + (back ? -strides[d] : strides[d]);
			const uint32_t entry = ends[back] ? 0 : l->blocks[home].nodes[to];
			*neighbour = entry - 1;
			if (!entry && !find_neighbour(l, home, at, back * ESK_DIRECTIONS + d, neighbour))
				return false;
		}
	return true;
}

void esk_lattice_position(const esk_lattice *l, const int32_t at[3], double position[3])
{
	const int32_t sum = at[0] + at[1] + at[2];
	for (int a = 0; a < 3; a++)
		position[a] = l->origin[a] + l->step_half * (sum - 2 * at[a]);
}

bool esk_lattice_evaluate(esk_lattice *l)
{
	void *values = l->values, *active = l->active;
	if (!esk_memory_reserve(&values, &l->value_capacity, l->node_count, sizeof *l->values))
		return false;
	l->values = values;
	if (!esk_memory_reserve(&active, &l->active_capacity, l->node_count, sizeof *l->active))
		return false;
	l->active = active;
	double points[BATCH][3];
	while (l->node_known < l->node_count) {
		const size_t rest = l->node_count - l->node_known, count = rest < BATCH ? rest : BATCH;
		for (size_t i = 0; i < count; i++)
			esk_lattice_position(l, l->nodes[l->node_known + i].at, points[i]);
		l->field->values(l->field->context, count, (const double(*)[3])points, l->values + l->node_known);
		memset(l->active + l->node_known, 0xff, count * sizeof *l->active); /* ESK_NO_NODE */
		l->node_known += count;
	}
	return true;
}

/* The lattice is two cubic ones, of side 2 step_half, of which the second lies in the centres of the first. */
void esk_lattice_nearest(const esk_lattice *l, const double position[3], int32_t at[3])
{
	double least = INFINITY;
	for (int centred = 0; centred < 2; centred++) {
		double square = 0, twice[3]; /* odd where centred */
		for (int a = 0; a < 3; a++) {
			const double x = (position[a] - l->origin[a]) / l->step_half;
			twice[a] = 2 * floor((x - centred) / 2 + 0.5) + centred;
			square += (x - twice[a]) * (x - twice[a]);
		}
		if (square < least) {
			least = square;
			for (int a = 0; a < 3; a++)
				at[a] = (int32_t)((twice[(a + 1) % 3] + twice[(a + 2) % 3]) / 2);
		}
	}
}

/* The slot that leads from one corner of Kuhn's path to another. */
static uint8_t slot_between(unsigned from, unsigned to)
{
	return (uint8_t)(from == to  ? ESK_NEIGHBOURS
			 : from < to ? (to & ~from) - 1
				     : (from & ~to) + ESK_DIRECTIONS - 1);
}

static void add_to_rings(esk_star *star, int counts[ESK_NEIGHBOURS], uint16_t others)
{
	for (int s = 0; s < ESK_NEIGHBOURS; s++) {
		if (!(others >> s & 1))
			continue;
		const uint16_t edge = (uint16_t)(others & ~(1u << s));
		star->adjacent[s] |= edge;
		star->rings[s][counts[s]++] = edge;
	}
}

void esk_star_make(esk_star *star)
{
	/* The axes in the order in which a path goes along them; every other order is odd. */
	static const uint8_t orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}};
	int counts[ESK_NEIGHBOURS] = {0};
	*star = (esk_star){0};
	for (unsigned t = 0; t < ESK_STAR; t++) {
		esk_star_cell *cell = &star->cells[t];
		const uint8_t *order = orders[t / 4];
		const unsigned corner = t % 4; /* that the node is */
		cell->reversed = t / 4 % 2;
		for (int c = 1; c < 4; c++)
			cell->masks[c] = (uint8_t)(cell->masks[c - 1] | 1u << order[c - 1]);
		for (int c = 0; c < 4; c++) {
			cell->slots[c] = slot_between(cell->masks[corner], cell->masks[c]);
			if (cell->slots[c] < ESK_NEIGHBOURS)
				cell->others = (uint16_t)(cell->others | 1u << cell->slots[c]);
		}
		add_to_rings(star, counts, cell->others);
	}
	for (unsigned back = 0; back < 2; back++)
		for (unsigned set = 0; set < 1u << ESK_DIRECTIONS; set++)
			for (unsigned t = 0; t < ESK_STAR; t++)
				if (star->cells[t].others & set << back * ESK_DIRECTIONS)
					star->halves[back][set] |= 1u << t;
}
