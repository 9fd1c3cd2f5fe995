/* Triangles that enclose solids.
 *
 * Corners are floats, as in STL, which is finer than any grid that they are laid on. Vertices at equal places are one
 * vertex, so a format that repeats them has neighbours too. */
#ifndef ESK_SOLID_H
#define ESK_SOLID_H

#include "eskel.h"

#define ESK_SOLID_MOST_TRIANGLES ((uint32_t)1 << 22)

typedef struct {
	float at[3]; /* mm */
} esk_solid_vertex;

/* All zero: empty. */
typedef struct {
	esk_solid_vertex *vertices;
	size_t vertex_count, vertex_capacity;
	uint32_t (*triangles)[3]; /* vertices, counterclockwise as seen from outside */
	size_t triangle_count, triangle_capacity;
} esk_solid;

void esk_solid_clear(esk_solid *solid);

/* ESKEL_MALFORMED unless finite and within 10 km. At most three vertices for each triangle that is allowed. */
eskel_status esk_solid_add_vertex(esk_solid *solid, const double at[3], eskel_error *error);
/* The vertices may still be to come. */
eskel_status esk_solid_add_triangle(esk_solid *solid, const uint32_t vertices[3], eskel_error *error);

/* All is there: turned by half a turn about z (LPS to RAS) if so told, welded, checked. ESKEL_EMPTY without triangles,
 * ESKEL_MALFORMED for a missing vertex and for an open surface: over every edge go as many triangles one way as the other,
 * or no row through the mesh could be told inside from outside. Surfaces may cross and touch. O(n). */
eskel_status esk_solid_close(esk_solid *solid, bool turn, eskel_error *error);

/* The volume that a closed mesh encloses, mm^3; negative when it is inside out, and twice what lies in two overlapping
 * parts. */
double esk_solid_enclosed(const esk_solid *solid);

#endif
