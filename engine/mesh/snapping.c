#include "snapping.h"

#include "lanes.h"

#include <math.h>

#define SHORT 1.7320508f /* sqrt(3) */
#define LONG 2.0f
/* Of an edge, how near to a node a cut must be: the pair with which the paper proves its dihedral angles of tetrahedra, 10.7
 * degrees at least. What they do to triangles, whose angles it does not bound, is measured: 15 degrees at least on smooth
 * surfaces (test_polygonise.c). */
#define NEAR_SHORT 0.41189f
#define NEAR_LONG 0.24999f

/* 1 over the length in step_half, by slot, and parts of the edge, by direction. */
static const float edge_slopes[ESK_NEIGHBOURS] = {1 / SHORT, 1 / SHORT, 1 / LONG, 1 / SHORT, 1 / LONG, 1 / LONG,
	1 / SHORT, 1 / SHORT, 1 / SHORT, 1 / LONG, 1 / SHORT, 1 / LONG, 1 / LONG, 1 / SHORT};
static const float near_parts[ESK_DIRECTIONS] = {
	NEAR_SHORT, NEAR_SHORT, NEAR_LONG, NEAR_SHORT, NEAR_LONG, NEAR_LONG, NEAR_SHORT};

/* Of a cut edge from a place in a block, in a direction: marks the other end if the cut is near to it, and tells as a bit
 * if it is near to the place. Values are as far from 0 as, to first order, the ends are from the cut. Without a branch,
 * which no processor would foresee. */
ESK_IN_LANES uint64_t snap_ends(const esk_lattice *l, esk_block *const around[ESK_AROUND], int place, int direction)
{
	esk_block *next = around[l->next_slots[place][direction]];
	const int next_place = l->next_places[place][direction];
	const float value = fabsf(around[ESK_OWN]->values[place]), next_value = fabsf(next->values[next_place]);
	const float near = near_parts[direction] * (value + next_value);
	next->words[ESK_SNAPPED] |= (uint64_t)(next_value <= near) << next_place;
	return (uint64_t)(value <= near) << place;
}

ESK_EVERY_WIDTH static void snap_block(const esk_lattice *l, uint32_t b)
{
	esk_block *block = &l->blocks[b], *around[ESK_AROUND];
	const uint64_t active = block->words[ESK_ACTIVE];
	uint64_t inside[ESK_AROUND], snapped = 0;
	if (!active)
		return;
	esk_lattice_around(l, b, around);
	esk_lattice_gather(l, b, ESK_INSIDE, false, inside);
	for (int d = 0; d < ESK_DIRECTIONS; d++)
		for (uint64_t cut = active & (inside[ESK_OWN] ^ inside[d]); cut; cut &= cut - 1)
			snapped |= snap_ends(l, around, __builtin_ctzll(cut), d);
	block->words[ESK_SNAPPED] |= snapped;
}

int esk_snap_slot(const esk_lattice *l, esk_block *const around[ESK_AROUND], int place, unsigned cut)
{
	const uint8_t *slots = l->next_slots[place], *places = l->next_places[place];
	const float value = fabsf(around[ESK_OWN]->values[place]);
	float most = 0;
	int nearest = __builtin_ctz(cut);
	for (; cut; cut &= cut - 1) {
		const int slot = __builtin_ctz(cut);
		const float change = value + fabsf(around[slots[slot]]->values[places[slot]]);
		const float slope = change * edge_slopes[slot];
		nearest = slope > most ? slot : nearest;
		most = slope > most ? slope : most;
	}
	return nearest;
}

/* Whether the slots of a set are connected in the link. */
static bool is_connected(const esk_star *star, unsigned set)
{
	unsigned reached = set & -set, fresh = reached;
	while (fresh) {
		unsigned next = 0;
		for (; fresh; fresh &= fresh - 1)
			next |= star->adjacent[__builtin_ctz(fresh)];
		fresh = next & set & ~reached;
		reached |= fresh;
	}
	return reached == set;
}

/* How often the side changes along the ring around the edge to a neighbour. */
static int count_changes(const esk_star *star, int slot, unsigned inside)
{
	int changes = 0;
	for (int e = 0; e < 6; e++) {
		const unsigned edge = star->rings[slot][e] & inside;
		changes += edge && edge != star->rings[slot][e];
	}
	return changes;
}

/* The neighbours outside in the ring around the edge to one, but 0 where they are not a single one. */
static unsigned find_single(const esk_star *star, int slot, unsigned inside)
{
	const unsigned rest = star->adjacent[slot] & ~inside;
	return rest & (rest - 1) ? 0 : rest;
}

/* Whether the strip to the snapped neighbour in a slot is one. */
static bool is_strip(const esk_star *star, int slot, unsigned inside, unsigned snapped)
{
	return count_changes(star, slot, inside) <= 2 && !(find_single(star, slot, inside) & snapped);
}

/* What the rules say of a set of neighbours inside: a bit for each slot in which a snapped neighbour may break them. */
enum { FOUND = 1 << 15, BROKEN = 1 << 14, SETS = 1 << ESK_NEIGHBOURS };

static uint16_t find_rules(const esk_star *star, unsigned inside)
{
	const unsigned outside = ~inside & (SETS - 1);
	unsigned rules = FOUND;
	if (!inside || !outside || !is_connected(star, inside) || !is_connected(star, outside))
		rules |= BROKEN;
	for (int s = 0; s < ESK_NEIGHBOURS; s++)
		if (count_changes(star, s, inside) > 2 || find_single(star, s, inside))
			rules |= 1u << s;
	return (uint16_t)rules;
}

typedef struct {
	const esk_star *star;
	uint16_t found[SETS]; /* 0: not yet */
} rule_book;

static bool may_snap(rule_book *book, unsigned inside, unsigned snapped)
{
	uint16_t *rules = &book->found[inside];
	const unsigned outside = ~inside & (SETS - 1);
	if (!*rules)
		*rules = find_rules(book->star, inside);
	if (*rules & BROKEN || (outside == snapped && !(outside & (outside - 1))))
		return false;
	for (unsigned rest = snapped & *rules; rest; rest &= rest - 1)
		if (!is_strip(book->star, __builtin_ctz(rest), inside, snapped))
			return false;
	return true;
}

/* The suspects among the nodes of a block that break a rule. */
ESK_EVERY_WIDTH static uint64_t find_breakers(const esk_lattice *l, rule_book *book, uint32_t b)
{
	const esk_block *block = &l->blocks[b];
	uint64_t filled[ESK_AROUND], snapped[ESK_AROUND], breakers = 0;
	uint64_t suspects = block->words[ESK_SUSPECT] & block->words[ESK_SNAPPED];
	if (!suspects)
		return 0;
	for (int back = 0; back < 2; back++) {
		esk_lattice_gather(l, b, ESK_FILLED, back, filled);
		esk_lattice_gather(l, b, ESK_SNAPPED, back, snapped);
	}
	for (; suspects; suspects &= suspects - 1) {
		const int place = __builtin_ctzll(suspects);
		if (!may_snap(book, esk_words_bits(filled, place), esk_words_bits(snapped, place)))
			breakers |= (uint64_t)1 << place;
	}
	return breakers;
}

/* Nodes of a block are no longer snapped, and their neighbours suspect. */
static void release(const esk_lattice *l, esk_block *block, uint64_t nodes)
{
	uint64_t reached[ESK_AROUND];
	block->words[ESK_SNAPPED] &= ~nodes;
	block->words[ESK_FILLED] |= nodes & block->words[ESK_INSIDE];
	esk_words_spread(nodes, reached);
	for (int s = 0; s < ESK_AROUND; s++)
		if (reached[s])
			l->blocks[block->around[s]].words[ESK_SUSPECT] |= reached[s];
}

/* All at once, so that no order matters. Whether there was one. */
static bool release_breakers(const esk_lattice *l, rule_book *book)
{
	uint64_t any = 0;
	for (size_t b = 0; b < l->block_count; b++) {
		uint64_t *words = l->blocks[b].words;
		words[ESK_BREAKS] = find_breakers(l, book, (uint32_t)b);
		words[ESK_SUSPECT] = 0;
		any |= words[ESK_BREAKS];
	}
	for (size_t b = 0; b < l->block_count && any; b++)
		if (l->blocks[b].words[ESK_BREAKS])
			release(l, &l->blocks[b], l->blocks[b].words[ESK_BREAKS]);
	return any;
}

void esk_snap(esk_lattice *l, const esk_star *star)
{
	rule_book book = {.star = star};
	for (size_t b = 0; b < l->block_count; b++)
		snap_block(l, (uint32_t)b);
	for (size_t b = 0; b < l->block_count; b++) {
		uint64_t *words = l->blocks[b].words;
		words[ESK_FILLED] = words[ESK_INSIDE] & ~words[ESK_SNAPPED];
		words[ESK_SUSPECT] = words[ESK_SNAPPED];
	}
	while (release_breakers(l, &book))
		;
}
