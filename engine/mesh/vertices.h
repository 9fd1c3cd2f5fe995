/* The vertices of a surface on the edges of a lattice: their numbers, and where they lie. */
#ifndef ESK_VERTICES_H
#define ESK_VERTICES_H

#include "lattice.h"

/* The edge that a vertex lies on: from a node inside to the neighbour in a slot, which is outside. */
typedef struct {
	uint32_t inside, slot;
} esk_edge;

/* All zero is none. */
typedef struct {
	esk_edge *edges; /* by vertex */
	size_t count;
} esk_vertices;

/* Of a lattice that is followed and snapped, whose blocks get the words of their vertices and the numbers of these; false when
 * memory ran out. */
bool esk_vertices_make(esk_lattice *lattice, esk_vertices *vertices);
void esk_vertices_clear(esk_vertices *vertices);
/* Their positions, and normals: those of the field, or 0 where it has none. */
void esk_vertices_place(
	const esk_vertices *vertices, const esk_lattice *lattice, float (*positions)[3], float (*normals)[3]);

#endif
