#include "mesh.h"

#include "memory.h"
#include "triple.h"

#include <math.h>
#include <stdlib.h>

eskel_mesh *esk_mesh_new(size_t vertex_count, size_t triangle_count)
{
	eskel_mesh *mesh = esk_memory_zeroed_array(1, sizeof *mesh);
	if (!mesh)
		return NULL;
	*mesh = (eskel_mesh){
		.vertex_count = vertex_count,
		.triangle_count = triangle_count,
		.vertices = esk_memory_array(vertex_count, sizeof *mesh->vertices),
		.normals = esk_memory_zeroed_array(vertex_count, sizeof *mesh->normals),
		.triangles = esk_memory_array(triangle_count, sizeof *mesh->triangles),
	};
	if (mesh->vertices && mesh->normals && mesh->triangles)
		return mesh;
	eskel_mesh_free(mesh);
	return NULL;
}

void eskel_mesh_free(eskel_mesh *mesh)
{
	if (!mesh)
		return;
	free(mesh->vertices);
	free(mesh->normals);
	free(mesh->triangles);
	free(mesh);
}

/* (b - a) x (c - a): twice the area, along the normal. */
static void double_area(const eskel_mesh *mesh, size_t triangle, double out[3])
{
	const uint32_t *t = mesh->triangles[triangle];
	double u[3], v[3];
	for (int i = 0; i < 3; i++) {
		u[i] = (double)mesh->vertices[t[1]][i] - mesh->vertices[t[0]][i];
		v[i] = (double)mesh->vertices[t[2]][i] - mesh->vertices[t[0]][i];
	}
	esk_triple_cross(u, v, out);
}

double eskel_mesh_area(const eskel_mesh *mesh)
{
	double sum = 0, area[3];
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		double_area(mesh, t, area);
		sum += esk_triple_length(area);
	}
	return sum / 2;
}

/* Of tetrahedra from a point near to the mesh, so that little cancels. */
double eskel_mesh_volume(const eskel_mesh *mesh)
{
	double sum = 0, area[3];
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		const float *corner = mesh->vertices[mesh->triangles[t][0]];
		double_area(mesh, t, area);
		for (int i = 0; i < 3; i++)
			sum += area[i] * ((double)corner[i] - mesh->vertices[0][i]);
	}
	return sum / 6;
}

/* Adds to each vertex whose normal was not known the area of a triangle. */
static void add_area(const eskel_mesh *mesh, size_t triangle, double (*sums)[3])
{
	double area[3];
	double_area(mesh, triangle, area);
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < 3; i++)
			sums[mesh->triangles[triangle][c]][i] += area[i];
}

static bool is_known(const float normal[3])
{
	const float square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
	return square > 0 && square < INFINITY;
}

static bool knows_normals(const eskel_mesh *mesh)
{
	bool known = true;
	for (size_t v = 0; v < mesh->vertex_count && known; v++)
		known = is_known(mesh->normals[v]);
	return known;
}

eskel_status esk_mesh_complete_normals(eskel_mesh *mesh)
{
	if (knows_normals(mesh))
		return ESKEL_OK;
	double(*sums)[3] = esk_memory_zeroed_array(mesh->vertex_count, sizeof *sums);
	if (!sums)
		return ESKEL_NO_MEMORY;
	for (size_t t = 0; t < mesh->triangle_count; t++)
		add_area(mesh, t, sums);
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		if (is_known(mesh->normals[v]))
			continue;
		const double length = esk_triple_length(sums[v]);
		for (int i = 0; i < 3; i++)
			mesh->normals[v][i] = length > 0 ? (float)(sums[v][i] / length) : i == 2;
	}
	free(sums);
	return ESKEL_OK;
}
