/* The creases of a union of ellipsoids: the curves that two of them have in common, where no other one hides them.
 *
 * A crease is a closed curve, or an arc between two corners. In a corner three surfaces meet, and three arcs end. */
#ifndef ESK_SEAMS_H
#define ESK_SEAMS_H

#include "ellipsoid.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
	double point[3];      /* mm */
	uint32_t surfaces[3]; /* ascending; the last ESKEL_LEVELS_MAX but in corners */
	uint32_t ends;        /* arcs that end there */
} esk_seam_vertex;

/* Of the surfaces of a < b. On that of a, b is to the left of the way that it goes. */
typedef struct {
	uint32_t a, b;
	size_t first, count; /* of the path; a closed one comes back to its first vertex */
} esk_seam_arc;

typedef struct {
	size_t vertex_count, vertex_capacity, arc_count, arc_capacity, path_count, path_capacity;
	esk_seam_vertex *vertices;
	esk_seam_arc *arcs;
	uint32_t *path;                   /* vertices */
	size_t counts[ESKEL_LEVELS_MAX];  /* of vertices on each surface, about */
	bool swallowed[ESKEL_LEVELS_MAX]; /* it lies within another one */
} esk_seams;

/* Vertices are about a step apart. ESKEL_NUMERIC where ellipsoids touch, or meet so closely that corners cannot be told
 * from one another. */
eskel_status esk_seams_make(const esk_ellipsoid *ellipsoids, uint32_t count, double step, esk_seams *seams);
void esk_seams_clear(esk_seams *seams);

#endif
