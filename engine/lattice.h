/* Space cut into equal tetrahedra: the body-centred cubic lattice, of which only nodes that were asked for exist.
 *
 * A node has integer coordinates (i, j, k), and lies at origin + step_half ((-i, i, i) + (j, -j, j) + (k, k, -k)). The
 * tetrahedra are those of Kuhn's division of the unit cubes of (i, j, k): from a corner b of a cube to the opposite one,
 * along one axis after the other, in any order. The map to space turns them into disphenoids, all equal, with dihedral
 * angles of 60 and 90 degrees: the best there are that fill space by congruent copies. A node has 14 neighbours: 8 along
 * half diagonals of the centred cubes, sqrt(3) step_half away, and 6 along axes of space, 2 step_half away.
 *
 * A direction is a mask of axes, 1 to 7; the neighbour in direction d is in slot d - 1, the one against it in slot d + 6. */
#ifndef ESK_LATTICE_H
#define ESK_LATTICE_H

#include "field.h"

#include <stdbool.h>
#include <stdint.h>

enum {
	ESK_DIRECTIONS = 7,
	ESK_NEIGHBOURS = 2 * ESK_DIRECTIONS,
	ESK_STAR = 24,               /* tetrahedra around a node */
	ESK_LATTICE_REACH = 1 << 22, /* coordinates are smaller than that, of either sign */
};

#define ESK_NO_NODE UINT32_MAX

typedef struct {
	int32_t at[3];
} esk_node;

typedef struct esk_block esk_block;

/* All zero but origin, step_half and field is a lattice without nodes. */
typedef struct {
	double origin[3], step_half;
	const esk_field *field;
	esk_node *nodes;
	double *values;   /* of the field; of the first node_known nodes */
	uint32_t *active; /* the caller's, of those; ESK_NO_NODE at first */
	size_t node_count, node_known, node_capacity, value_capacity, active_capacity;
	esk_block *blocks;
	uint32_t *table; /* of blocks, by place: 0: empty, else the block + 1 */
	size_t block_count, block_capacity, table_capacity;
} esk_lattice;

void esk_lattice_clear(esk_lattice *lattice);

/* The number of a node, which is made if there is none; false when memory ran out. */
bool esk_lattice_node(esk_lattice *lattice, const int32_t at[3], uint32_t *node);
/* Those of its neighbours, by slot. */
bool esk_lattice_neighbours(esk_lattice *lattice, uint32_t node, uint32_t neighbours[ESK_NEIGHBOURS]);
/* The values of all nodes that have none; false when memory ran out. */
bool esk_lattice_evaluate(esk_lattice *lattice);

void esk_lattice_position(const esk_lattice *lattice, const int32_t at[3], double position[3]);
void esk_lattice_nearest(const esk_lattice *lattice, const double position[3], int32_t at[3]);

/* A tetrahedron around a node: its corners in the order of Kuhn's path. */
typedef struct {
	uint8_t slots[4]; /* of the node's neighbours; that of the node itself is ESK_NEIGHBOURS */
	uint8_t masks[4]; /* the axes gone along so far: 0, one, two, all */
	uint16_t others;  /* the slots of the three other corners, a bit each */
	bool reversed;    /* of negative volume in this order */
} esk_star_cell;

/* The neighbourhood of every node. Its link, the surface of the star, is a sphere of 24 triangles with the neighbours as
 * corners. */
typedef struct {
	esk_star_cell cells[ESK_STAR];
	uint16_t adjacent[ESK_NEIGHBOURS]; /* slots next to a slot in the link: a cycle around their common edge */
	uint16_t rings[ESK_NEIGHBOURS]
		      [6]; /* the edges of that cycle, two bits each; 0 past the fourth of a short one */
	uint32_t halves
		[2][1 << ESK_DIRECTIONS]; /* the cells, a bit each, that have one of a set of slots, forward or back */
} esk_star;

void esk_star_make(esk_star *star);

/* The cells that have one of a set of slots. */
static inline uint32_t esk_star_cells(const esk_star *star, unsigned slots)
{
	const unsigned half = (1u << ESK_DIRECTIONS) - 1;
	return star->halves[0][slots & half] | star->halves[1][slots >> ESK_DIRECTIONS & half];
}

#endif
