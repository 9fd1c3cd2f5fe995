/* Space cut into equal tetrahedra: the body-centred cubic lattice, of which only blocks that were asked for exist.
 *
 * A node has integer coordinates (i, j, k), and lies at origin + step_half ((-i, i, i) + (j, -j, j) + (k, k, -k)). The
 * tetrahedra are those of Kuhn's division of the unit cubes of (i, j, k): from a corner b of a cube to the opposite one,
 * along one axis after the other, in any order. The map to space turns them into disphenoids, all equal, with dihedral
 * angles of 60 and 90 degrees: the best there are that fill space by congruent copies. A node has 14 neighbours: 8 along
 * half diagonals of the centred cubes, sqrt(3) step_half away, and 6 along axes of space, 2 step_half away.
 *
 * Nodes lie in blocks of 4 x 4 x 4, with a word for each thing that is known of them: a bit each (block_words.h).
 *
 * A direction is a mask of axes, 1 to 7; the neighbour in direction d is in slot d - 1, the one against it in slot d + 6. */
#ifndef ESK_LATTICE_H
#define ESK_LATTICE_H

#include "block_words.h"
#include "field.h"

#include <stdbool.h>
#include <stdint.h>

enum {
	ESK_DIRECTIONS = 7,
	ESK_NEIGHBOURS = 2 * ESK_DIRECTIONS,
	ESK_STAR = 24,   /* tetrahedra around a node */
	ESK_PLACES = 64, /* nodes of a block */
	ESK_PLACE_BITS = 6,
	ESK_VERTEX_KINDS = ESK_DIRECTIONS + 1, /* on edges by direction, and snapped nodes */
	ESK_LATTICE_REACH = 1 << 22,           /* coordinates are smaller than that, of either sign */
};

#define ESK_NO_BLOCK UINT32_MAX

/* What words tell of nodes. */
typedef enum {
	ESK_KNOWN,    /* its value is known */
	ESK_INSIDE,   /* that is below 0 */
	ESK_ASKED,    /* it will be known after esk_lattice_evaluate */
	ESK_ACTIVE,   /* the surface passes by it (continuation.h) */
	ESK_FOLLOWED, /* so it was, and its neighbours are known */
	ESK_SNAPPED,  /* it is moved onto the surface (snapping.h), */
	ESK_FILLED,   /* and this is inside and not snapped; */
	ESK_SUSPECT,  /* this one snapping.h still looks at, */
	ESK_BREAKS,   /* and this breaks its rules */
	ESK_WORDS
} esk_word;

typedef struct {
	int32_t at[3];               /* of its first node, */
	double ways[3];              /* and from the origin to it, in step_half */
	uint32_t around[ESK_AROUND]; /* blocks by slot; ESK_NO_BLOCK: neither has asked for the other */
	uint64_t words[ESK_WORDS];
	uint64_t vertices[ESK_VERTEX_KINDS]; /* vertices.h: those of a kind, by the first node of their edge, */
	uint32_t first[ESK_VERTEX_KINDS];    /* and the number of the first of them */
	float values[ESK_PLACES]; /* of the field: they tell where about its zero is, and the words on which side */
} esk_block;

/* A node's number is 64 times that of its block, and its place there. */
typedef struct {
	double origin[3], step_half;
	const esk_field *field;
	esk_block *blocks;
	uint32_t *table; /* of blocks, by coordinates: 0: empty, else the block + 1 */
	uint32_t *asked; /* blocks with such nodes */
	size_t block_count, block_capacity, table_capacity, asked_count, asked_capacity;
	double ways[ESK_PLACES][3];                  /* from a block's first node to a node, in step_half, */
	uint8_t next_slots[ESK_PLACES][ESK_AROUND];  /* of the block that the neighbour in a slot lies in, */
	uint8_t next_places[ESK_PLACES][ESK_AROUND]; /* and its place there */
} esk_lattice;

/* A lattice without blocks. */
void esk_lattice_start(esk_lattice *lattice, const esk_field *field, const double origin[3], double step_half);
void esk_lattice_clear(esk_lattice *lattice);

/* The number of a node, whose value is asked for; false when memory ran out. */
bool esk_lattice_node(esk_lattice *lattice, const int32_t at[3], uint32_t *node);
/* Asks for nodes of a block; false when memory ran out. */
bool esk_lattice_ask(esk_lattice *lattice, uint32_t block, uint64_t nodes);
/* Asks for nodes of the blocks around one, by slot; false when memory ran out. */
bool esk_lattice_ask_around(esk_lattice *lattice, uint32_t block, const uint64_t nodes[ESK_AROUND]);
/* The values of all nodes asked for. */
void esk_lattice_evaluate(esk_lattice *lattice);
/* The words of a block's neighbourhood, as bits by slot of neighbours (esk_words_gather). */
void esk_lattice_gather(
	const esk_lattice *lattice, uint32_t block, esk_word word, bool back, uint64_t near[ESK_AROUND]);

/* The blocks around one, by slot; itself where none is known. */
void esk_lattice_around(const esk_lattice *lattice, uint32_t block, esk_block *around[ESK_AROUND]);

void esk_lattice_nearest(const esk_lattice *lattice, const double position[3], int32_t at[3]);

static inline esk_block *esk_lattice_block(const esk_lattice *lattice, uint32_t node)
{
	return &lattice->blocks[node >> ESK_PLACE_BITS];
}

static inline uint64_t esk_lattice_bit(uint32_t node)
{
	return (uint64_t)1 << (node & (ESK_PLACES - 1));
}

static inline bool esk_lattice_has(const esk_lattice *lattice, uint32_t node, esk_word word)
{
	return esk_lattice_block(lattice, node)->words[word] & esk_lattice_bit(node);
}

static inline float esk_lattice_value(const esk_lattice *lattice, uint32_t node)
{
	return esk_lattice_block(lattice, node)->values[node & (ESK_PLACES - 1)];
}

static inline void esk_lattice_at(const esk_lattice *lattice, uint32_t node, int32_t at[3])
{
	const esk_block *block = esk_lattice_block(lattice, node);
	for (int a = 0; a < 3; a++)
		at[a] = block->at[a] + (int32_t)(node >> (4 - 2 * a) & 3);
}

static inline void esk_lattice_position(const esk_lattice *lattice, const int32_t at[3], double position[3])
{
	const int32_t sum = at[0] + at[1] + at[2];
	for (int a = 0; a < 3; a++)
		position[a] = lattice->origin[a] + lattice->step_half * (sum - 2 * at[a]);
}

/* The position of a place in a block, of the same bits as from coordinates. */
static inline void esk_lattice_find(const esk_lattice *lattice, const esk_block *block, int place, double position[3])
{
	for (int a = 0; a < 3; a++)
		position[a] = lattice->origin[a] + lattice->step_half * (block->ways[a] + lattice->ways[place][a]);
}

/* A node's neighbour in a slot, where one of their blocks has asked for the other. */
static inline uint32_t esk_lattice_next(const esk_lattice *lattice, uint32_t node, int slot)
{
	const uint32_t place = node & (ESK_PLACES - 1);
	const uint32_t block = esk_lattice_block(lattice, node)->around[lattice->next_slots[place][slot]];
	return block << ESK_PLACE_BITS | lattice->next_places[place][slot];
}

#endif
