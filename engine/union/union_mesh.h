/* The triangles of a union of ellipsoids, without marching (section 4). */
#ifndef ESK_UNION_MESH_H
#define ESK_UNION_MESH_H

#include "eskel.h"

/* Each ellipsoid's own triangles (shell.h), cut along the creases (seams.h), without what lies in others: closed, oriented, a
 * manifold, which does not intersect itself unless a radius is so small that floats round it off. Vertices lie on the
 * surface, those of creases on both; edges are about a step (mm) long and shorter where the surface bends more.
 * ESKEL_NUMERIC where ellipsoids touch or creases are too close to one another for the step, so that this is not certain;
 * ESKEL_TOO_LARGE for more than triangles_max triangles. */
eskel_status esk_union_mesh(
	const eskel_primitive *ellipsoids, uint32_t count, double step, size_t triangles_max, eskel_mesh **mesh);

#endif
