#include "union_mesh.h"

#include "memory.h"
#include "patches.h"
#include "shell_cut.h"

#include <stdlib.h>
#include <string.h>

/* How many times the triangles asked for at most are made, with those that lie in other ellipsoids. */
static const double hidden_most = 4;
/* With edges of creases half as long each time, where what lies between them is narrower than they are long. */
static const int attempts = 3;

typedef struct {
	esk_ellipsoid ellipsoids[ESKEL_LEVELS_MAX];
	uint32_t count;
	double step, seam_step;
	size_t most;
	esk_seams seams;
	esk_patch patches[ESKEL_LEVELS_MAX]; /* what is kept of each, in the mesh */
	eskel_mesh *mesh;
	size_t vertex_capacity, normal_capacity, triangle_capacity;
} work;

/* ---- the mesh */

static bool reserve(work *w, size_t vertices, size_t triangles)
{
	eskel_mesh *m = w->mesh;
	void *vertex_array = m->vertices, *normal_array = m->normals, *triangle_array = m->triangles;
	const bool good = esk_memory_reserve(&vertex_array, &w->vertex_capacity, m->vertex_count + vertices,
				  sizeof *m->vertices) &&
			  esk_memory_reserve(
				  &normal_array, &w->normal_capacity, m->vertex_count + vertices, sizeof *m->normals) &&
			  esk_memory_reserve(&triangle_array, &w->triangle_capacity, m->triangle_count + triangles,
				  sizeof *m->triangles);
	m->vertices = vertex_array;
	m->normals = normal_array;
	m->triangles = triangle_array;
	return good;
}

static void add_vertex(eskel_mesh *mesh, const double point[3], const double normal[3])
{
	const double length = esk_triple_length(normal);
	for (int i = 0; i < 3; i++) {
		mesh->vertices[mesh->vertex_count][i] = (float)point[i];
		mesh->normals[mesh->vertex_count][i] = (float)(length > 0 ? normal[i] / length : 0);
	}
	mesh->vertex_count++;
}

/* On a crease the normal is the mean of its sides. */
static bool add_seams(work *w)
{
	if (!reserve(w, w->seams.vertex_count, 0))
		return false;
	for (size_t v = 0; v < w->seams.vertex_count; v++) {
		const esk_seam_vertex *vertex = &w->seams.vertices[v];
		double normal[3] = {0, 0, 0};
		for (int k = 0; k < 3 && vertex->surfaces[k] != ESKEL_LEVELS_MAX; k++) {
			double slope[3];
			esk_ellipsoid_slope(&w->ellipsoids[vertex->surfaces[k]], vertex->point, slope);
			const double length = esk_triple_length(slope);
			for (int i = 0; i < 3; i++)
				normal[i] += slope[i] / length;
		}
		add_vertex(w->mesh, vertex->point, normal);
	}
	return true;
}

/* Adds the vertices of kept triangles, but for those of seams, which are there; and the numbers that all have in the mesh. */
static void add_vertices(const esk_cut *cut, uint32_t *numbers, eskel_mesh *mesh)
{
	const esk_shell *shell = &cut->shell;
	memset(numbers, 0xff, shell->vertex_count * sizeof *numbers);
	for (size_t t = 0; t < shell->triangle_count; t++)
		for (size_t k = 0; k < 3 && cut->fates[t] == ESK_KEPT; k++)
			numbers[shell->starts[4 * t + k]] = 0;
	for (size_t v = 0; v < shell->vertex_count; v++) {
		if (numbers[v] == ESK_NONE)
			continue;
		numbers[v] = shell->seams[v];
		if (numbers[v] != ESK_NONE)
			continue;
		numbers[v] = (uint32_t)mesh->vertex_count;
		double normal[3];
		esk_ellipsoid_normal(shell->ellipsoid, shell->units[v], normal);
		add_vertex(mesh, shell->points[v], normal);
	}
}

static void add_triangles(const esk_cut *cut, const uint32_t *numbers, eskel_mesh *mesh)
{
	for (size_t t = 0; t < cut->shell.triangle_count; t++)
		if (cut->fates[t] == ESK_KEPT) {
			uint32_t *triangle = mesh->triangles[mesh->triangle_count++];
			for (size_t k = 0; k < 3; k++)
				triangle[k] = numbers[cut->shell.starts[4 * t + k]];
		}
}

static eskel_status add_cut(work *w, const esk_cut *cut, esk_patch *patch)
{
	eskel_mesh *mesh = w->mesh;
	const size_t first_vertex = mesh->vertex_count, first_triangle = mesh->triangle_count;
	uint32_t *numbers = esk_memory_array(cut->shell.vertex_count, sizeof *numbers);
	if (!numbers || !reserve(w, cut->shell.vertex_count, cut->shell.triangle_count)) {
		free(numbers);
		return ESKEL_NO_MEMORY;
	}
	add_vertices(cut, numbers, mesh);
	add_triangles(cut, numbers, mesh);
	free(numbers);
	*patch = (esk_patch){cut->shell.ellipsoid, first_triangle, mesh->triangle_count - first_triangle, first_vertex,
		mesh->vertex_count - first_vertex};
	return mesh->triangle_count > w->most ? ESKEL_TOO_LARGE : ESKEL_OK;
}

/* ---- the whole */

static eskel_status add_ellipsoid(work *w, uint32_t s)
{
	esk_cut cut;
	w->patches[s] = (esk_patch){&w->ellipsoids[s], 0, 0, 0, 0};
	if (w->seams.swallowed[s])
		return ESKEL_OK;
	eskel_status status = esk_cut_make(w->ellipsoids, w->count, s, &w->seams, w->step, &cut);
	if (!status) {
		status = add_cut(w, &cut, &w->patches[s]);
		esk_cut_clear(&cut);
	}
	return status;
}

/* Into an empty mesh. */
static eskel_status attempt(work *w)
{
	eskel_status status = esk_seams_make(w->ellipsoids, w->count, w->seam_step, &w->seams);
	if (status)
		return status;
	w->mesh->vertex_count = w->mesh->triangle_count = 0;
	if (!add_seams(w))
		status = ESKEL_NO_MEMORY;
	for (uint32_t s = 0; s < w->count && !status; s++)
		status = add_ellipsoid(w, s);
	if (!status)
		status = esk_patches_check(w->mesh, w->patches, w->count, w->seams.vertex_count);
	esk_seams_clear(&w->seams);
	return status;
}

/* False where the triangles are too many, with those that lie in other ellipsoids. */
static bool prepare(work *w, const eskel_primitive *primitives, double step)
{
	double longest = 0, estimate = 0;
	for (uint32_t i = 0; i < w->count; i++) {
		esk_ellipsoid_make(&primitives[i], &w->ellipsoids[i]);
		longest = fmax(longest, w->ellipsoids[i].radii[2]);
	}
	/* Longer edges there are not. */
	w->step = fmin(step, longest);
	for (uint32_t i = 0; i < w->count; i++)
		estimate += esk_shell_estimate(&w->ellipsoids[i], w->step);
	return estimate < hidden_most * (double)w->most && estimate < 1 << 28;
}

eskel_status esk_union_mesh(
	const eskel_primitive *primitives, uint32_t count, double step, size_t triangles_max, eskel_mesh **mesh)
{
	work w = {.count = count, .most = triangles_max};
	if (!prepare(&w, primitives, step))
		return ESKEL_TOO_LARGE;
	w.mesh = esk_memory_zeroed_array(1, sizeof *w.mesh);
	eskel_status status = w.mesh ? ESKEL_NUMERIC : ESKEL_NO_MEMORY;
	w.seam_step = w.step;
	for (int i = 0; i < attempts && status == ESKEL_NUMERIC; i++, w.seam_step /= 2)
		status = attempt(&w);
	if (status)
		eskel_mesh_free(w.mesh);
	else
		*mesh = w.mesh;
	return status;
}
