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
 * - The patch must be more than an edge: the rest of the link is not a single node that is snapped itself.
 * - The strip must be one: around the edge to a snapped neighbour, nodes inside follow one another. And where they are all
 *   but one of the ring, that one is not snapped: else the two triangles at the strip's ends had the same corners.
 * Nodes that break a rule are no longer snapped, and their neighbours looked at again, until all keep them. */
#ifndef ESK_SNAPPING_H
#define ESK_SNAPPING_H

#include "lattice.h"
#include "star.h"

/* Sets the words ESK_SNAPPED and ESK_FILLED of all blocks. */
void esk_snap(esk_lattice *lattice, const esk_star *star);
/* The slot of the edge from a place in a block on which the surface is nearest, as the field changes most by length: of a
 * set of slots, in which neighbours are on the other side. */
int esk_snap_slot(const esk_lattice *lattice, esk_block *const around[ESK_AROUND], int place, unsigned cut);

#endif
