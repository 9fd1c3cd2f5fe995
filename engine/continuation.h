/* Which nodes of the lattice a surface passes by: it is followed from where it was met (section 4).
 *
 * A node is active when the field has another sign at a neighbour. Starting from active nodes, the neighbours of each are
 * evaluated, and those of the other sign are active too. In a tetrahedron that the surface crosses, the edges that it cuts
 * are connected, and so they are from one to the next: each connected piece of the surface is followed whole, and each
 * value is computed once, no further than two edges from the surface. */
#ifndef ESK_CONTINUATION_H
#define ESK_CONTINUATION_H

#include "lattice.h"
#include "polygonise.h"

enum { ESK_CUTS = ESK_DIRECTIONS + 1 };

typedef struct {
	uint32_t node, neighbours[ESK_NEIGHBOURS];
	uint16_t cut; /* the slots of neighbours of the other sign */
	uint32_t vertices
		[ESK_CUTS]; /* of the mesh: on the edge in each direction, and the node itself; ESK_NO_NODE: none */
} esk_active;

/* All zero but the lattice is nothing followed. */
typedef struct {
	esk_lattice lattice;
	esk_active *actives;
	size_t count, capacity;
} esk_trace;

void esk_trace_clear(esk_trace *trace);

static inline bool esk_trace_inside(const esk_trace *trace, uint32_t node)
{
	return trace->lattice.values[node] < 0;
}

/* From the seeds, as the options say. ESKEL_TOO_LARGE with more than most active nodes, or where the surface leaves the
 * box. ESKEL_EMPTY where no surface is met. */
eskel_status esk_trace_surface(
	esk_trace *trace, const esk_polygonise_options *options, size_t most, eskel_error *error);

#endif
