#include "union_mesh.h"

#include "memory.h"
#include "mesh.h"
#include "patches.h"
#include "seams.h"
#include "shell.h"

#include <stdlib.h>
#include <string.h>

/* How many times the triangles asked for at most are made, with those that lie in other ellipsoids. */
static const double hidden_most = 4;
/* With edges of creases half as long each time, where what lies between them is narrower than they are long. */
static const int attempts = 3;

typedef enum { UNKNOWN, KEPT, DROPPED } fate;

typedef struct {
	esk_ellipsoid ellipsoids[ESKEL_LEVELS_MAX];
	uint32_t count;
	double step, seam_step;
	size_t most;
	esk_seams seams;
	esk_shell shells[ESKEL_LEVELS_MAX];
	uint8_t *fates[ESKEL_LEVELS_MAX];    /* of triangles */
	esk_patch patches[ESKEL_LEVELS_MAX]; /* what is kept of each, in the mesh */
	uint32_t *numbers[ESKEL_LEVELS_MAX]; /* of vertices, in the mesh */
	bool lacks_memory;
	uint32_t *places; /* the vertex of a shell that a vertex of seams is */
} work;

/* ---- seams into a shell */

static bool place_arc(work *w, uint32_t s, const esk_seam_arc *arc, uint32_t *near)
{
	bool good = true;
	for (size_t i = arc->first; i < arc->first + arc->count && good; i++) {
		const uint32_t v = w->seams.path[i];
		if (w->places[v] != ESK_NONE)
			continue;
		good = esk_shell_place(&w->shells[s], v, w->seams.vertices[v].point, near);
		w->places[v] = good ? esk_shell_start(&w->shells[s], *near) : ESK_NONE;
	}
	return good;
}

static bool join_arc(work *w, uint32_t s, const esk_seam_arc *arc)
{
	bool good = true;
	for (size_t i = arc->first + 1; i < arc->first + arc->count && good; i++)
		good = esk_shell_join(
			&w->shells[s], w->places[w->seams.path[i - 1]], w->places[w->seams.path[i]], arc->b == s);
	return good;
}

static bool lay_seams(work *w, uint32_t s)
{
	bool good = true;
	uint32_t near = 0;
	memset(w->places, 0xff, w->seams.vertex_count * sizeof *w->places);
	for (size_t a = 0; a < w->seams.arc_count && good; a++)
		if (w->seams.arcs[a].a == s || w->seams.arcs[a].b == s)
			good = place_arc(w, s, &w->seams.arcs[a], &near);
	for (size_t a = 0; a < w->seams.arc_count && good; a++)
		if (w->seams.arcs[a].a == s || w->seams.arcs[a].b == s)
			good = join_arc(w, s, &w->seams.arcs[a]);
	return good;
}

/* ---- what is kept */

/* Of a shell that no seam divides. */
static fate judge_whole(const work *w, uint32_t s)
{
	for (uint32_t k = 0; k < w->count; k++)
		if (k != s && !w->seams.swallowed[k] &&
			esk_ellipsoid_value(&w->ellipsoids[k], w->shells[s].points[0]) < 0)
			return DROPPED;
	return KEPT;
}

/* From the seams over all triangles; false where both sides meet. */
static bool spread(const esk_shell *shell, uint8_t *fates, uint32_t *stack)
{
	size_t depth = 0;
	for (uint32_t t = 0; t < shell->triangle_count; t++)
		for (uint32_t h = 4 * t; h < 4 * t + 3; h++)
			if (shell->marks[h] != ESK_FREE && fates[t] == UNKNOWN) {
				fates[t] = shell->marks[h] == ESK_SEAM_KEPT ? KEPT : DROPPED;
				stack[depth++] = t;
			}
	while (depth > 0) {
		const uint32_t t = stack[--depth];
		for (uint32_t h = 4 * t; h < 4 * t + 3; h++) {
			const uint32_t other = esk_shell_twin(shell, h) / 4;
			const uint8_t mark = shell->marks[h];
			if (mark != ESK_FREE) {
				if ((mark == ESK_SEAM_KEPT) != (fates[t] == KEPT))
					return false;
			} else if (fates[other] == UNKNOWN) {
				fates[other] = fates[t];
				stack[depth++] = other;
			} else if (fates[other] != fates[t]) {
				return false;
			}
		}
	}
	return true;
}

static bool lack_memory(work *w)
{
	w->lacks_memory = true;
	return false;
}

static bool judge(work *w, uint32_t s)
{
	esk_shell *shell = &w->shells[s];
	w->fates[s] = esk_memory_zeroed_array(shell->triangle_capacity, sizeof *w->fates[s]);
	if (!w->fates[s])
		return lack_memory(w);
	if (w->seams.counts[s] == 0) {
		memset(w->fates[s], (int)judge_whole(w, s), shell->triangle_count);
		return true;
	}
	uint32_t *stack = esk_memory_array(shell->triangle_count, sizeof *stack);
	if (!stack)
		return lack_memory(w);
	const bool good = spread(shell, w->fates[s], stack);
	free(stack);
	return good;
}

static bool is_chord(const esk_shell *shell, uint32_t h)
{
	return shell->marks[h] == ESK_FREE && shell->seams[esk_shell_start(shell, h)] != ESK_NONE &&
	       shell->seams[esk_shell_end(shell, h)] != ESK_NONE;
}

/* Edges between vertices of seams, but not along one, cut corners of the surface, and two shells could have the same one. */
static bool divide_chords(work *w, uint32_t s)
{
	esk_shell *shell = &w->shells[s];
	for (uint32_t t = 0; t < shell->triangle_count; t++)
		for (uint32_t h = 4 * t; h < 4 * t + 3 && w->fates[s][t] == KEPT; h++) {
			const size_t before = shell->triangle_count;
			if (!is_chord(shell, h))
				continue;
			if (!esk_shell_divide(shell, h))
				return false;
			memset(w->fates[s] + before, KEPT, shell->triangle_count - before);
			h = 4 * t - 1; /* the triangle is another one */
		}
	return true;
}

/* Of what is kept, the vertices of seams and their neighbours. */
static bool relax(work *w, uint32_t s)
{
	esk_shell *shell = &w->shells[s];
	uint8_t *near = esk_memory_zeroed_array(shell->vertex_count, sizeof *near);
	uint32_t *list = esk_memory_array(shell->vertex_count, sizeof *list);
	size_t count = 0;
	for (uint32_t t = 0; near && t < shell->triangle_count; t++) {
		const uint32_t *corners = shell->starts + 4 * t;
		bool at_seam = false;
		for (int k = 0; k < 3; k++)
			at_seam = at_seam || shell->seams[corners[k]] != ESK_NONE;
		for (int k = 0; k < 3 && at_seam && w->fates[s][t] == KEPT; k++)
			near[corners[k]] = 1;
	}
	for (uint32_t v = 0; near && list && v < shell->vertex_count; v++)
		if (near[v])
			list[count++] = v;
	const esk_ellipsoid *others[ESKEL_LEVELS_MAX];
	size_t other_count = 0;
	for (uint32_t k = 0; k < w->count; k++)
		if (k != s && !w->seams.swallowed[k] && esk_ellipsoids_meet(&w->ellipsoids[k], &w->ellipsoids[s]))
			others[other_count++] = &w->ellipsoids[k];
	const bool good = near && list;
	if (good)
		esk_shell_relax(shell, count, list, others, other_count);
	free(near);
	free(list);
	return good || lack_memory(w);
}

static bool make_shell(work *w, uint32_t s)
{
	/* Room for the seams, and as much again for edges to be divided. */
	const size_t room = 3 * w->seams.counts[s];
	if (!esk_shell_make(&w->ellipsoids[s], w->step, room, &w->shells[s]))
		return lack_memory(w);
	return lay_seams(w, s) && judge(w, s) && (w->seams.counts[s] == 0 || (divide_chords(w, s) && relax(w, s)));
}

/* ---- the mesh */

static void add_slope(const esk_ellipsoid *e, const double point[3], double normal[3])
{
	double slope[3];
	esk_ellipsoid_slope(e, point, slope);
	const double length = esk_triple_length(slope);
	for (int i = 0; i < 3; i++)
		normal[i] += slope[i] / length;
}

static void write_vertex(eskel_mesh *mesh, size_t v, const double point[3], const double normal[3])
{
	const double length = esk_triple_length(normal);
	for (int i = 0; i < 3; i++) {
		mesh->vertices[v][i] = (float)point[i];
		mesh->normals[v][i] = (float)(length > 0 ? normal[i] / length : 0);
	}
}

/* On a crease the normal is the mean of its sides. */
static void write_seams(const work *w, eskel_mesh *mesh)
{
	for (size_t v = 0; v < w->seams.vertex_count; v++) {
		const esk_seam_vertex *vertex = &w->seams.vertices[v];
		double normal[3] = {0, 0, 0};
		for (int i = 0; i < 3 && vertex->surfaces[i] != ESKEL_LEVELS_MAX; i++)
			add_slope(&w->ellipsoids[vertex->surfaces[i]], vertex->point, normal);
		write_vertex(mesh, v, vertex->point, normal);
	}
}

/* The numbers of a shell's vertices in the mesh, from next on; ESK_NONE of those that are dropped. */
static size_t number_shell(const work *w, uint32_t s, uint32_t *numbers, size_t next)
{
	const esk_shell *shell = &w->shells[s];
	memset(numbers, 0xff, shell->vertex_count * sizeof *numbers);
	for (size_t t = 0; t < shell->triangle_count; t++)
		for (size_t k = 0; k < 3 && w->fates[s][t] == KEPT; k++)
			numbers[shell->starts[4 * t + k]] = 0;
	for (size_t v = 0; v < shell->vertex_count; v++)
		if (numbers[v] == 0)
			numbers[v] = shell->seams[v] != ESK_NONE ? shell->seams[v] : (uint32_t)next++;
	return next;
}

static void write_shell(const work *w, uint32_t s, eskel_mesh *mesh)
{
	const esk_shell *shell = &w->shells[s];
	const uint32_t *numbers = w->numbers[s];
	uint32_t(*triangle)[3] = mesh->triangles + w->patches[s].first_triangle;
	for (size_t v = 0; v < shell->vertex_count; v++)
		if (numbers[v] != ESK_NONE && shell->seams[v] == ESK_NONE) {
			double normal[3] = {0, 0, 0};
			add_slope(shell->ellipsoid, shell->points[v], normal);
			write_vertex(mesh, numbers[v], shell->points[v], normal);
		}
	for (size_t t = 0; t < shell->triangle_count; t++)
		if (w->fates[s][t] == KEPT) {
			for (size_t k = 0; k < 3; k++)
				(*triangle)[k] = numbers[shell->starts[4 * t + k]];
			triangle++;
		}
}

/* Numbers what is kept, shell by shell. */
static bool number_all(work *w, eskel_mesh *counts)
{
	counts->vertex_count = w->seams.vertex_count;
	counts->triangle_count = 0;
	for (uint32_t s = 0; s < w->count; s++) {
		const esk_shell *shell = &w->shells[s];
		esk_patch *patch = &w->patches[s];
		*patch = (esk_patch){&w->ellipsoids[s], counts->triangle_count, 0, counts->vertex_count, 0};
		w->numbers[s] = esk_memory_array(shell->vertex_count, sizeof *w->numbers[s]);
		if (!w->numbers[s])
			return false;
		for (size_t t = 0; t < shell->triangle_count; t++)
			patch->triangle_count += w->fates[s][t] == KEPT;
		counts->vertex_count = number_shell(w, s, w->numbers[s], counts->vertex_count);
		counts->triangle_count += patch->triangle_count;
		patch->vertex_count = counts->vertex_count - patch->first_vertex;
	}
	return true;
}

static eskel_status write_mesh(work *w, eskel_mesh **mesh)
{
	eskel_mesh counts = {0};
	if (!number_all(w, &counts))
		return ESKEL_NO_MEMORY;
	if (counts.triangle_count > w->most)
		return ESKEL_TOO_LARGE;
	eskel_mesh *made = esk_mesh_new(counts.vertex_count, counts.triangle_count);
	if (!made)
		return ESKEL_NO_MEMORY;
	write_seams(w, made);
	for (uint32_t s = 0; s < w->count; s++)
		write_shell(w, s, made);
	const eskel_status status = esk_patches_check(made, w->patches, w->count);
	if (status)
		eskel_mesh_free(made);
	else
		*mesh = made;
	return status;
}

/* ---- the whole */

static eskel_status attempt(work *w, eskel_mesh **mesh)
{
	const eskel_status status = esk_seams_make(w->ellipsoids, w->count, w->seam_step, &w->seams);
	if (status)
		return status;
	w->places = esk_memory_array(w->seams.vertex_count, sizeof *w->places);
	if (!w->places)
		return ESKEL_NO_MEMORY;
	for (uint32_t s = 0; s < w->count; s++)
		if (!w->seams.swallowed[s] && !make_shell(w, s))
			return w->lacks_memory ? ESKEL_NO_MEMORY : ESKEL_NUMERIC;
	return write_mesh(w, mesh);
}

static void clear(work *w)
{
	for (uint32_t s = 0; s < w->count; s++) {
		esk_shell_clear(&w->shells[s]);
		free(w->fates[s]);
		free(w->numbers[s]);
		w->fates[s] = NULL;
		w->numbers[s] = NULL;
	}
	esk_seams_clear(&w->seams);
	free(w->places);
	w->places = NULL;
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
	eskel_status status = ESKEL_NUMERIC;
	w.seam_step = w.step;
	for (int i = 0; i < attempts && status == ESKEL_NUMERIC; i++, w.seam_step /= 2) {
		status = attempt(&w, mesh);
		clear(&w);
	}
	return status;
}
