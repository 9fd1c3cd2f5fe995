/* The triangles of a field's zero, by marching tetrahedra with continuation (section 4). */
#ifndef ESK_POLYGONISE_H
#define ESK_POLYGONISE_H

#include "eskel.h"
#include "field.h"

#define ESK_TRIANGLES_MAX ((size_t)1 << 24)

typedef struct {
	double step;                  /* mm: there is a node of the lattice for each step^3 */
	double least[3], greatest[3]; /* mm: a box that holds the whole surface */
	const double (*seeds)[3];     /* points inside, such as the centres of ellipsoids; of any order */
	size_t seed_count;
	size_t triangles_max; /* 0: ESK_TRIANGLES_MAX */
	bool scan;            /* search all of the box too, for pieces on no vertical line through a seed */
} esk_polygonise_options;

/* A closed mesh without boundary, an oriented 2-manifold, counterclockwise from outside. Its vertices lie on the surface,
 * its normals are those of the field. It is the same for any order of the seeds.
 *
 * Found is every piece of the surface, outer or of a cavity, that crosses the vertical line of nodes next to a seed, or an
 * edge of the node nearest to a seed; scan adds each that has a node inside of it on a grid of four steps. A piece in which
 * no node lies is smaller than the step and not seen.
 *
 * ESKEL_INVALID for a step that is not positive, an empty box or a seed outside of it; ESKEL_EMPTY where no surface is met;
 * ESKEL_TOO_LARGE for more than triangles_max triangles, with a step that would do, for a box of more than 2^20 steps, or
 * for a surface that leaves the box. Memory is in proportion to the triangles, some 100 bytes for each. */
eskel_status esk_polygonise(
	const esk_field *field, const esk_polygonise_options *options, eskel_mesh **mesh, eskel_error *error);

#endif
