/* The tetrahedra of the lattice: six in a cube of (i, j, k), and 24 around a node, which are its star. */
#ifndef ESK_STAR_H
#define ESK_STAR_H

#include "lattice.h"

enum { ESK_TETRAHEDRA = 6 };

/* Corners of cubes are masks of axes, as directions are: the way from the first corner. */
typedef struct {
	uint8_t corners[4]; /* in the order of Kuhn's path: 0, one axis, two, all */
	uint8_t set;        /* the same, a bit for each mask */
	bool reversed;      /* of negative volume in this order */
} esk_tetrahedron;

/* The same for all nodes. A node's link, the surface of its star, is a sphere of 24 triangles with the neighbours as
 * corners, and slots are a bit each. */
typedef struct {
	esk_tetrahedron tetrahedra[ESK_TETRAHEDRA];
	uint16_t adjacent[ESK_NEIGHBOURS]; /* slots next to a slot in the link: a cycle around their common edge */
	uint16_t rings[ESK_NEIGHBOURS]
		      [6]; /* the edges of that cycle, two bits each; 0 past the fourth of a short one */
} esk_star;

void esk_star_make(esk_star *star);

#endif
