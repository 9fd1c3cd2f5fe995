/* The triangles of a surface in the tetrahedra of a lattice. */
#ifndef ESK_CELLS_H
#define ESK_CELLS_H

#include "lattice.h"
#include "star.h"

/* All zero is none. */
typedef struct {
	uint32_t (*triangles)[3];
	size_t count, capacity;
} esk_cells;

/* Of a lattice whose vertices are numbered (vertices.h) and lie at the positions; false when memory ran out. A quadrangle is
 * divided along its shorter diagonal. */
bool esk_cells_make(const esk_lattice *lattice, const esk_star *star, size_t vertex_count, const float (*positions)[3],
	esk_cells *cells);
void esk_cells_clear(esk_cells *cells);

#endif
