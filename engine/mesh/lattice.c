#include "lattice.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	SIDE_BITS = 2, /* of a block */
	KEY_BITS = 21,
	BATCH = 256,           /* points of a call: they and their values fit into the nearest cache */
	MOST_BLOCKS = 1 << 26, /* numbers of nodes have 32 bits */
	/* Room made at once, for some 200,000 triangles: what is not written to costs no memory, to grow a copy. */
	FIRST_BLOCKS = 1 << 14,
	FIRST_TABLE = 1 << 12,
};

/* Where a node lies from a block's first one. */
static void spread_place(unsigned place, int32_t from[3])
{
	for (int a = 0; a < 3; a++)
		from[a] = (int32_t)(place / (unsigned)esk_layer_steps[a] & 3);
}

/* In step_half, from the origin to a node. */
static void find_ways(const int32_t at[3], double ways[3])
{
	for (int a = 0; a < 3; a++)
		ways[a] = at[0] + at[1] + at[2] - 2 * at[a];
}

static void find_next(esk_lattice *l, unsigned place, int slot)
{
	const int mask = slot % ESK_DIRECTIONS + 1, sign = slot < ESK_DIRECTIONS ? 1 : -1;
	int32_t to[3];
	int across = 0, next = 0; /* axes on which it lies in another block */
	spread_place(place, to);
	for (int a = 0; a < 3; a++) {
		to[a] += sign * (mask >> a & 1);
		across |= (to[a] < 0 || to[a] > 3) << a;
		next += (to[a] & 3) * esk_layer_steps[a];
	}
	l->next_slots[place][slot] = (uint8_t)esk_slot_of(across, sign < 0);
	l->next_places[place][slot] = (uint8_t)next;
}

void esk_lattice_start(esk_lattice *l, const esk_field *field, const double origin[3], double step_half)
{
	*l = (esk_lattice){.origin = {origin[0], origin[1], origin[2]}, .step_half = step_half, .field = field};
	for (unsigned place = 0; place < ESK_PLACES; place++) {
		int32_t from[3];
		spread_place(place, from);
		find_ways(from, l->ways[place]);
		for (int slot = 0; slot < ESK_NEIGHBOURS; slot++)
			find_next(l, place, slot);
		l->next_slots[place][ESK_OWN] = ESK_OWN;
		l->next_places[place][ESK_OWN] = (uint8_t)place;
	}
}

void esk_lattice_clear(esk_lattice *l)
{
	free(l->blocks);
	free(l->table);
	free(l->asked);
	l->blocks = NULL;
	l->table = l->asked = NULL;
	l->block_count = l->block_capacity = l->table_capacity = l->asked_count = l->asked_capacity = 0;
}

static size_t place_of(const esk_lattice *l, const int32_t at[3])
{
	uint64_t key = 0;
	for (int a = 0; a < 3; a++)
		key = key << KEY_BITS | (uint64_t)((at[a] + ESK_LATTICE_REACH) >> SIDE_BITS);
	/* Multiplication by 2^64 over the golden ratio spreads keys that differ in few bits (Knuth). */
	size_t place = (size_t)(key * 0x9e3779b97f4a7c15u >> 32) & (l->table_capacity - 1);
	while (l->table[place] && memcmp(l->blocks[l->table[place] - 1].at, at, sizeof l->blocks->at) != 0)
		place = (place + 1) & (l->table_capacity - 1);
	return place;
}

/* At most half full. */
static bool reserve_table(esk_lattice *l)
{
	if (2 * (l->block_count + 1) <= l->table_capacity)
		return true;
	const size_t capacity = l->table_capacity ? 2 * l->table_capacity : FIRST_TABLE;
	uint32_t *table = esk_memory_zeroed_array(capacity, sizeof *table);
	if (!table)
		return false;
	free(l->table);
	l->table = table;
	l->table_capacity = capacity;
	for (size_t b = 0; b < l->block_count; b++)
		table[place_of(l, l->blocks[b].at)] = (uint32_t)b + 1;
	return true;
}

static bool reserve_block(esk_lattice *l)
{
	void *blocks = l->blocks;
	const size_t needed = l->block_count < FIRST_BLOCKS ? FIRST_BLOCKS : l->block_count + 1;
	if (needed > MOST_BLOCKS || !esk_memory_reserve(&blocks, &l->block_capacity, needed, sizeof *l->blocks))
		return false;
	l->blocks = blocks;
	return true;
}

/* The block whose first node is at. */
static bool find_block(esk_lattice *l, const int32_t at[3], uint32_t *block)
{
	if (!reserve_table(l))
		return false;
	uint32_t *entry = &l->table[place_of(l, at)];
	if (!*entry) {
		if (!reserve_block(l))
			return false;
		esk_block *made = &l->blocks[l->block_count];
		memset(made, 0, offsetof(esk_block, vertices));
		memset(made->around, 0xff, sizeof made->around); /* ESK_NO_BLOCK */
		memcpy(made->at, at, sizeof made->at);
		find_ways(at, made->ways);
		made->around[ESK_OWN] = (uint32_t)l->block_count;
		*entry = (uint32_t)++l->block_count;
	}
	*block = *entry - 1;
	return true;
}

bool esk_lattice_ask(esk_lattice *l, uint32_t block, uint64_t nodes)
{
	uint64_t *words = l->blocks[block].words;
	nodes &= ~words[ESK_KNOWN];
	if (!nodes)
		return true;
	if (!words[ESK_ASKED]) {
		void *asked = l->asked;
		if (!esk_memory_reserve(&asked, &l->asked_capacity, l->asked_count + 1, sizeof *l->asked))
			return false;
		l->asked = asked;
		l->asked[l->asked_count++] = block;
	}
	words[ESK_ASKED] |= nodes;
	return true;
}

bool esk_lattice_node(esk_lattice *l, const int32_t at[3], uint32_t *node)
{
	int32_t first[3];
	uint32_t block, place = 0;
	for (int a = 0; a < 3; a++) {
		first[a] = at[a] & ~3;
		place += (uint32_t)((at[a] & 3) * esk_layer_steps[a]);
	}
	if (!find_block(l, first, &block) || !esk_lattice_ask(l, block, (uint64_t)1 << place))
		return false;
	*node = block << ESK_PLACE_BITS | place;
	return true;
}

/* The first node of the block in a slot. */
static void find_corner(const esk_block *block, int slot, int32_t at[3])
{
	for (int a = 0; a < 3; a++)
		at[a] = block->at[a] + ((slot % ESK_DIRECTIONS + 1) >> a & 1) * (slot < ESK_DIRECTIONS ? 4 : -4);
}

/* The block in a slot around another, which is made if there is none. */
static bool find_next_block(esk_lattice *l, uint32_t block, int slot, uint32_t *next)
{
	int32_t at[3];
	find_corner(&l->blocks[block], slot, at);
	if (!find_block(l, at, next))
		return false;
	l->blocks[block].around[slot] = *next;
	l->blocks[*next].around[esk_slot_opposite(slot)] = block;
	return true;
}

bool esk_lattice_ask_around(esk_lattice *l, uint32_t block, const uint64_t reached[ESK_AROUND])
{
	bool good = true;
	for (int s = 0; s < ESK_AROUND && good; s++) {
		uint32_t to = l->blocks[block].around[s];
		if (reached[s])
			good = (to != ESK_NO_BLOCK || find_next_block(l, block, s, &to)) &&
			       esk_lattice_ask(l, to, reached[s]);
	}
	return good;
}

void esk_lattice_around(const esk_lattice *l, uint32_t block, esk_block *around[ESK_AROUND])
{
	for (int s = 0; s < ESK_AROUND; s++) {
		const uint32_t next = l->blocks[block].around[s];
		around[s] = &l->blocks[next == ESK_NO_BLOCK ? block : next];
	}
}

void esk_lattice_gather(const esk_lattice *l, uint32_t b, esk_word word, bool back, uint64_t near[ESK_AROUND])
{
	const esk_block *block = &l->blocks[b];
	uint64_t words[ESK_AROUND];
	for (int m = 0; m < 8; m++) {
		const int slot = esk_slot_of(m, back);
		words[slot] = block->around[slot] == ESK_NO_BLOCK ? 0 : l->blocks[block->around[slot]].words[word];
	}
	if (back)
		esk_words_gather(words, true, near);
	else
		esk_words_gather(words, false, near);
}

/* Nodes whose values are asked for, until they are enough for a call. */
typedef struct {
	size_t count;
	uint32_t nodes[BATCH];
	double points[BATCH][3];
} batch;

static void evaluate_batch(esk_lattice *l, batch *b)
{
	double values[BATCH];
	l->field->values(l->field->context, b->count, (const double(*)[3])b->points, values);
	for (size_t i = 0; i < b->count; i++) {
		const uint32_t node = b->nodes[i];
		const uint32_t place = node & (ESK_PLACES - 1);
		esk_block *block = esk_lattice_block(l, node);
		block->values[place] = (float)values[i];
		block->words[ESK_INSIDE] |= (uint64_t)(values[i] < 0) << place;
	}
	b->count = 0;
}

static void evaluate_block(esk_lattice *l, uint32_t block, batch *b)
{
	uint64_t *words = l->blocks[block].words, rest = words[ESK_ASKED];
	words[ESK_KNOWN] |= rest;
	words[ESK_ASKED] = 0;
	for (; rest; rest &= rest - 1) {
		const int place = __builtin_ctzll(rest);
		if (b->count == BATCH)
			evaluate_batch(l, b);
		esk_lattice_find(l, &l->blocks[block], place, b->points[b->count]);
		b->nodes[b->count++] = block << ESK_PLACE_BITS | (uint32_t)place;
	}
}

void esk_lattice_evaluate(esk_lattice *l)
{
	batch b;
	b.count = 0;
	for (size_t i = 0; i < l->asked_count; i++)
		evaluate_block(l, l->asked[i], &b);
	if (b.count)
		evaluate_batch(l, &b);
	l->asked_count = 0;
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
