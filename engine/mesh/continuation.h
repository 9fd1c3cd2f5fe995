/* Which nodes of the lattice a surface passes by: it is followed from where it was met (section 4).
 *
 * A node is active when the field has another sign at a neighbour. Starting from active nodes, the neighbours of each are
 * evaluated, and those of the other sign are active too: for all nodes of a block at once, as a block's neighbourhood is
 * words of bits, and within a block as far as the surface goes there before others are looked at. In a tetrahedron that the
 * surface crosses, the edges that it cuts are connected, and so they are from one to the next: each connected piece of the
 * surface is followed whole, and each value is computed once, no further than two edges from the surface. */
#ifndef ESK_CONTINUATION_H
#define ESK_CONTINUATION_H

#include "lattice.h"
#include "polygonise.h"

/* All zero but the lattice is nothing followed. */
typedef struct {
	esk_lattice lattice;
	size_t count; /* of active nodes */
} esk_trace;

/* From the seeds, as the options say. ESKEL_TOO_LARGE with more than most active nodes, or where the surface leaves the
 * box. ESKEL_EMPTY where no surface is met. */
eskel_status esk_trace_surface(
	esk_trace *trace, const esk_polygonise_options *options, size_t most, eskel_error *error);

#endif
