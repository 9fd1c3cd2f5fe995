/* Triangles in the making. */
#ifndef ESK_MESH_H
#define ESK_MESH_H

#include "eskel.h"

/* With room for so many, and zero of each but the counts given; NULL when memory ran out. */
eskel_mesh *esk_mesh_new(size_t vertex_count, size_t triangle_count);

/* Gives each vertex whose normal is 0, or not finite, the mean of its triangles by area; (0, 0, 1) where that is 0. */
eskel_status esk_mesh_complete_normals(eskel_mesh *mesh);

#endif
