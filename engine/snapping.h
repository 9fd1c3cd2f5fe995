/* Which nodes of the lattice are moved onto the surface, so that it has no slivers.
 *
 * Where the surface cuts an edge close to a node, its triangles are slivers: the node is snapped to the surface, in the
 * place of all cuts of its edges, as in isosurface stuffing (Labelle and Shewchuk, "Isosurface stuffing: fast tetrahedral
 * meshes with good dihedral angles", 2007). A snapped node counts as outside; the patch of the surface between it and
 * its neighbours inside shrinks to a vertex, the strip between it and a snapped neighbour to an edge.
 *
 * Where we differ: a node is snapped only where the mesh stays a manifold.
 * - The patch must be a disk. It is the part of the node's link whose corners are inside: on a sphere, such a part is a
 *   disk (or a curve or point, which shrinks as well) when it and the rest are both connected, and neither is empty.
 * - The strip must be one: around the edge to a snapped neighbour, nodes inside follow one another. And where they are all
 *   but one of the ring, that one is not snapped: else the two triangles at the strip's ends had the same corners.
 * Nodes that break a rule are no longer snapped, and their neighbours looked at again, until all keep them. */
#ifndef ESK_SNAPPING_H
#define ESK_SNAPPING_H

#include "continuation.h"

enum { ESK_INSIDE = 1, ESK_SNAPPED = 2, ESK_ACTIVE = 4 };

/* states[node] of all nodes: ESK_INSIDE, ESK_SNAPPED or, outside, neither; and ESK_ACTIVE. cuts[n] is, where the nth active node
 * is snapped, the slot of the edge on which the surface is nearest. */
void esk_snap(const esk_trace *trace, const esk_star *star, uint8_t *states, uint8_t *cuts);

#endif
