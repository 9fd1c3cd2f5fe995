/* The triangles of a surface in the tetrahedra of a lattice: which there are, and on which edge each vertex lies. */
#ifndef ESK_CELLS_H
#define ESK_CELLS_H

#include "lattice.h"
#include "star.h"

#define ESK_NO_VERTEX UINT32_MAX

typedef struct {
	uint32_t corners[4]; /* vertices; the last is ESK_NO_VERTEX in a triangle */
} esk_polygon;

/* The nodes of the edge that a vertex lies on. */
typedef struct {
	uint32_t inside, outside;
} esk_edge;

/* All zero is none. */
typedef struct {
	esk_edge *edges; /* by vertex */
	esk_polygon *polygons;
	size_t edge_count, polygon_count, polygon_capacity;
	size_t triangle_count; /* that the polygons give */
} esk_cells;

/* Of a lattice that is followed and snapped; false when memory ran out. */
bool esk_cells_make(esk_lattice *lattice, const esk_star *star, esk_cells *cells);
void esk_cells_clear(esk_cells *cells);

#endif
