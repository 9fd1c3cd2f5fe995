#include "snapping.h"

#include <math.h>

#define SHORT 1.7320508075688772 /* sqrt(3) */
#define LONG 2.0
/* Of an edge, how near to a node a cut must be: the pair with which the paper proves its dihedral angles of tetrahedra, 10.7
 * degrees at least. What they do to triangles, whose angles it does not bound, is measured: 15 degrees at least on smooth
 * surfaces (test_polygonise.c). */
#define NEAR_SHORT 0.41189
#define NEAR_LONG 0.24999

/* By direction: in step_half, and in parts of the edge. */
static const double edge_lengths[ESK_DIRECTIONS] = {SHORT, SHORT, LONG, SHORT, LONG, LONG, SHORT};
static const double near_parts[ESK_DIRECTIONS] = {
	NEAR_SHORT, NEAR_SHORT, NEAR_LONG, NEAR_SHORT, NEAR_LONG, NEAR_LONG, NEAR_SHORT};

static void snap(const esk_lattice *l, uint32_t node)
{
	esk_lattice_block(l, node)->words[ESK_SNAPPED] |= esk_lattice_bit(node);
}

/* The ends of an edge that its cut is near to. Values are as far from 0 as, to first order, the ends are from the cut. */
static void snap_ends(const esk_lattice *l, uint32_t node, int direction)
{
	const uint32_t other = esk_lattice_next(l, node, direction);
	const double value = fabs(esk_lattice_value(l, node)), other_value = fabs(esk_lattice_value(l, other));
	const double near = near_parts[direction] * (value + other_value);
	if (value <= near)
		snap(l, node);
	if (other_value <= near)
		snap(l, other);
}

static void snap_block(const esk_lattice *l, uint32_t b)
{
	const esk_block *block = &l->blocks[b];
	uint64_t inside[ESK_AROUND];
	if (!block->words[ESK_ACTIVE])
		return;
	esk_lattice_gather(l, b, ESK_INSIDE, false, inside);
	for (int d = 0; d < ESK_DIRECTIONS; d++)
		for (uint64_t cut = block->words[ESK_ACTIVE] & (inside[ESK_OWN] ^ inside[d]); cut; cut &= cut - 1)
			snap_ends(l, b << ESK_PLACE_BITS | (uint32_t)__builtin_ctzll(cut), d);
}

uint32_t esk_snap_other(const esk_lattice *l, uint32_t node)
{
	const double value = esk_lattice_value(l, node);
	double least = INFINITY;
	uint32_t nearest = node;
	for (int s = 0; s < ESK_NEIGHBOURS; s++) {
		const uint32_t other = esk_lattice_next(l, node, s);
		const double other_value = esk_lattice_value(l, other), part = value / (value - other_value);
		if ((value < 0) == (other_value < 0))
			continue;
		if (part * edge_lengths[s % ESK_DIRECTIONS] < least || nearest == node) {
			least = part * edge_lengths[s % ESK_DIRECTIONS];
			nearest = other;
		}
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

/* Whether the strip to the snapped neighbour in a slot is one. */
static bool is_strip(const esk_star *star, int slot, unsigned inside, unsigned snapped)
{
	int changes = 0; /* of side, along the ring */
	for (int e = 0; e < 6; e++) {
		const unsigned edge = star->rings[slot][e] & inside;
		changes += edge && edge != star->rings[slot][e];
	}
	const unsigned rest = star->adjacent[slot] & ~inside;
	const bool is_pillow = rest && !(rest & (rest - 1)) && (rest & snapped);
	return changes <= 2 && !is_pillow;
}

static bool may_snap(const esk_star *star, unsigned inside, unsigned snapped)
{
	const unsigned outside = ~inside & ((1u << ESK_NEIGHBOURS) - 1);
	if (!inside || !outside || !is_connected(star, inside) || !is_connected(star, outside))
		return false;
	if (outside == snapped && !(outside & (outside - 1)))
		return false;
	for (unsigned rest = snapped; rest; rest &= rest - 1)
		if (!is_strip(star, __builtin_ctz(rest), inside, snapped))
			return false;
	return true;
}

/* A bit for each neighbour of a node of the block. */
static unsigned bits_of(const uint64_t near[ESK_AROUND], int place)
{
	unsigned bits = 0;
	for (int s = 0; s < ESK_NEIGHBOURS; s++)
		bits |= (unsigned)(near[s] >> place & 1) << s;
	return bits;
}

/* The suspects among the nodes of a block that break a rule. */
static uint64_t find_breakers(const esk_lattice *l, const esk_star *star, uint32_t b)
{
	const esk_block *block = &l->blocks[b];
	uint64_t inside[ESK_AROUND], snapped[ESK_AROUND], breakers = 0;
	uint64_t suspects = block->words[ESK_SUSPECT] & block->words[ESK_SNAPPED];
	if (!suspects)
		return 0;
	for (int back = 0; back < 2; back++) {
		esk_lattice_gather(l, b, ESK_INSIDE, back, inside);
		esk_lattice_gather(l, b, ESK_SNAPPED, back, snapped);
	}
	for (; suspects; suspects &= suspects - 1) {
		const int place = __builtin_ctzll(suspects);
		if (!may_snap(star, bits_of(inside, place), bits_of(snapped, place)))
			breakers |= (uint64_t)1 << place;
	}
	return breakers;
}

/* Nodes of a block are no longer snapped, and their neighbours suspect. */
static void release(const esk_lattice *l, esk_block *block, uint64_t nodes)
{
	uint64_t reached[ESK_AROUND];
	block->words[ESK_SNAPPED] &= ~nodes;
	esk_words_spread(nodes, reached);
	for (int s = 0; s < ESK_AROUND; s++)
		if (reached[s])
			l->blocks[block->around[s]].words[ESK_SUSPECT] |= reached[s];
	for (; nodes; nodes &= nodes - 1)
		if (block->values[__builtin_ctzll(nodes)] < 0)
			block->words[ESK_INSIDE] |= nodes & -nodes;
}

/* All at once, so that no order matters. Whether there was one. */
static bool release_breakers(const esk_lattice *l, const esk_star *star)
{
	bool any = false;
	for (size_t b = 0; b < l->block_count; b++)
		l->blocks[b].words[ESK_BREAKS] = find_breakers(l, star, (uint32_t)b);
	for (size_t b = 0; b < l->block_count; b++)
		l->blocks[b].words[ESK_SUSPECT] = 0;
	for (size_t b = 0; b < l->block_count; b++) {
		uint64_t *breakers = &l->blocks[b].words[ESK_BREAKS];
		if (*breakers) {
			release(l, &l->blocks[b], *breakers);
			any = true;
		}
		*breakers = 0;
	}
	return any;
}

void esk_snap(esk_lattice *l, const esk_star *star)
{
	for (size_t b = 0; b < l->block_count; b++)
		snap_block(l, (uint32_t)b);
	for (size_t b = 0; b < l->block_count; b++) {
		uint64_t *words = l->blocks[b].words;
		words[ESK_INSIDE] &= ~words[ESK_SNAPPED];
		words[ESK_SUSPECT] = words[ESK_SNAPPED];
	}
	while (release_breakers(l, star))
		;
}
