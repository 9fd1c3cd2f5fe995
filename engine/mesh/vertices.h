/* The vertices of a surface on the edges of a lattice: their numbers, and where they lie. */
#ifndef ESK_VERTICES_H
#define ESK_VERTICES_H

#include "lattice.h"

/* Of a lattice that is followed and snapped: its blocks get the words of their vertices, and their numbers. How many. */
size_t esk_vertices_number(esk_lattice *lattice);
/* Their positions, and normals: those of the field, or 0 where it has none. */
void esk_vertices_place(const esk_lattice *lattice, float (*positions)[3], float (*normals)[3]);

#endif
