/* Meshes simplified and put in order by meshoptimizer (https://github.com/zeux/meshoptimizer).
 *
 * The library collapses edges in the order of their quadric errors (Garland and Heckbert, 1997) and keeps the topology but for
 * rare cases, in which a triangle or an edge comes up twice. A result of a closed manifold that is none is discarded, and half
 * of the reduction asked for, until it is one; without any reduction it is the mesh itself. */
#include "memory.h"
#include "mesh.h"

#include <meshoptimizer.h>

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { STRIDE = 3 * sizeof(float) };

/* The vertices that triangles need, in the order in which they are first needed. */
static eskel_status gather(const eskel_mesh *mesh, const uint32_t *indices, size_t index_count, eskel_mesh **gathered)
{
	uint32_t *places = esk_memory_array(mesh->vertex_count, sizeof *places);
	if (!places)
		return ESKEL_NO_MEMORY;
	const size_t needed = meshopt_optimizeVertexFetchRemap(places, indices, index_count, mesh->vertex_count);
	eskel_mesh *made = esk_mesh_new(needed, index_count / 3);
	if (made) {
		meshopt_remapIndexBuffer(&made->triangles[0][0], indices, index_count, places);
		meshopt_remapVertexBuffer(made->vertices, mesh->vertices, mesh->vertex_count, STRIDE, places);
		meshopt_remapVertexBuffer(made->normals, mesh->normals, mesh->vertex_count, STRIDE, places);
		*gathered = made;
	}
	free(places);
	return made ? ESKEL_OK : ESKEL_NO_MEMORY;
}

/* A mesh with something left of it. */
static eskel_status is_manifold(const eskel_mesh *mesh, bool *manifold)
{
	eskel_mesh_check_result r;
	eskel_status status = eskel_mesh_check(mesh, &r);
	if (status == ESKEL_OK || status == ESKEL_INVALID)
		*manifold = status == ESKEL_OK && r.is_manifold && mesh->triangle_count > 0;
	return status == ESKEL_INVALID ? ESKEL_OK : status;
}

/* Once, towards a number of triangles. */
static eskel_status simplify(
	const eskel_mesh *mesh, size_t triangles, double most, uint32_t *indices, eskel_mesh **made, double *error)
{
	const double scale = (double)meshopt_simplifyScale(&mesh->vertices[0][0], mesh->vertex_count, STRIDE);
	const float relative = most > 0 && scale > 0 ? (float)(most / scale) : FLT_MAX;
	float reached = 0;
	const size_t count = meshopt_simplify(indices, &mesh->triangles[0][0], 3 * mesh->triangle_count,
		&mesh->vertices[0][0], mesh->vertex_count, STRIDE, 3 * triangles, relative, 0, &reached);
	*error = (double)reached * scale;
	return gather(mesh, indices, count, made);
}

eskel_status eskel_mesh_simplify(
	const eskel_mesh *mesh, const eskel_simplify_options *options, eskel_mesh **simplified, double *error)
{
	if (!(options->error >= 0))
		return ESKEL_INVALID;
	eskel_mesh_check_result before;
	eskel_status status = eskel_mesh_check(mesh, &before);
	if (status != ESKEL_OK)
		return status;
	uint32_t *indices = esk_memory_array(mesh->triangle_count, sizeof *mesh->triangles);
	if (!indices)
		return ESKEL_NO_MEMORY;
	size_t triangles = options->triangles < mesh->triangle_count ? options->triangles : mesh->triangle_count;
	for (bool manifold = false; status == ESKEL_OK && !manifold;) {
		eskel_mesh *made = NULL;
		double reached = 0;
		status = simplify(mesh, triangles, options->error, indices, &made, &reached);
		if (status == ESKEL_OK)
			status = is_manifold(made, &manifold);
		manifold |= !before.is_manifold || triangles == mesh->triangle_count;
		if (status == ESKEL_OK && manifold) {
			*simplified = made;
			*error = reached;
		} else {
			eskel_mesh_free(made);
		}
		triangles += (mesh->triangle_count - triangles + 1) / 2;
	}
	free(indices);
	return status;
}

eskel_status eskel_mesh_reorder(eskel_mesh *mesh)
{
	uint32_t *indices = esk_memory_array(mesh->triangle_count, sizeof *mesh->triangles);
	if (!indices)
		return ESKEL_NO_MEMORY;
	meshopt_optimizeVertexCache(indices, &mesh->triangles[0][0], 3 * mesh->triangle_count, mesh->vertex_count);
	eskel_mesh *made = NULL;
	const eskel_status status = gather(mesh, indices, 3 * mesh->triangle_count, &made);
	if (status == ESKEL_OK) {
		eskel_mesh old = *mesh;
		*mesh = *made;
		*made = old;
	}
	eskel_mesh_free(made);
	free(indices);
	return status;
}
