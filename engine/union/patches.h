/* Whether triangles of different ellipsoids cross, which would make the mesh of their union intersect itself. */
#ifndef ESK_PATCHES_H
#define ESK_PATCHES_H

#include "ellipsoid.h"

#include <stddef.h>

/* The part of a mesh that an ellipsoid gave: its triangles, with corners on the ellipsoid, and its own vertices. */
typedef struct {
	const esk_ellipsoid *ellipsoid;
	size_t first_triangle, triangle_count, first_vertex, vertex_count;
} esk_patch;

/* The first seams vertices are those of creases. ESKEL_NUMERIC if any cross, or touch but in corners or edges that they share, or a vertex lies inside of another one's
 * ellipsoid. */
eskel_status esk_patches_check(const eskel_mesh *mesh, const esk_patch *patches, size_t count, size_t seams);

#endif
