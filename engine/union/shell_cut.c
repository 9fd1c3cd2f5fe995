#include "shell_cut.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	const esk_ellipsoid *ellipsoids;
	uint32_t count, s;
	const esk_seams *seams;
	double step;
	esk_cut *cut;
	uint32_t *places; /* the vertex of the shell that a vertex of seams is */
	bool lacks_memory;
} work;

static bool lack_memory(work *w)
{
	w->lacks_memory = true;
	return false;
}

/* ---- seams into a shell */

static bool place_arc(work *w, const esk_seam_arc *arc, uint32_t *near)
{
	bool good = true;
	for (size_t i = arc->first; i < arc->first + arc->count && good; i++) {
		const uint32_t v = w->seams->path[i];
		if (w->places[v] != ESK_NONE)
			continue;
		good = esk_shell_place(&w->cut->shell, v, w->seams->vertices[v].point, near);
		w->places[v] = good ? esk_shell_start(&w->cut->shell, *near) : ESK_NONE;
	}
	return good;
}

static bool join_arc(work *w, const esk_seam_arc *arc)
{
	bool good = true;
	for (size_t i = arc->first + 1; i < arc->first + arc->count && good; i++)
		good = esk_shell_join(
			&w->cut->shell, w->places[w->seams->path[i - 1]], w->places[w->seams->path[i]], arc->b == w->s);
	return good;
}

static bool lay_seams(work *w)
{
	bool good = true;
	uint32_t near = 0;
	memset(w->places, 0xff, w->seams->vertex_count * sizeof *w->places);
	for (size_t a = 0; a < w->seams->arc_count && good; a++)
		if (w->seams->arcs[a].a == w->s || w->seams->arcs[a].b == w->s)
			good = place_arc(w, &w->seams->arcs[a], &near);
	for (size_t a = 0; a < w->seams->arc_count && good; a++)
		if (w->seams->arcs[a].a == w->s || w->seams->arcs[a].b == w->s)
			good = join_arc(w, &w->seams->arcs[a]);
	return good;
}

/* ---- what is kept */

/* Of a shell that no seam divides. */
static esk_fate judge_whole(const work *w)
{
	for (uint32_t k = 0; k < w->count; k++)
		if (k != w->s && !w->seams->swallowed[k] &&
			esk_ellipsoid_value(&w->ellipsoids[k], w->cut->shell.points[0]) < 0)
			return ESK_DROPPED;
	return ESK_KEPT;
}

/* From the seams over all triangles; false where both sides meet. */
static bool spread(const esk_shell *shell, uint8_t *fates, uint32_t *stack)
{
	size_t depth = 0;
	for (uint32_t t = 0; t < shell->triangle_count; t++)
		for (uint32_t h = 4 * t; h < 4 * t + 3; h++)
			if (shell->marks[h] != ESK_FREE && fates[t] == ESK_UNKNOWN) {
				fates[t] = shell->marks[h] == ESK_SEAM_KEPT ? ESK_KEPT : ESK_DROPPED;
				stack[depth++] = t;
			}
	while (depth > 0) {
		const uint32_t t = stack[--depth];
		for (uint32_t h = 4 * t; h < 4 * t + 3; h++) {
			const uint32_t other = esk_shell_twin(shell, h) / 4;
			const uint8_t mark = shell->marks[h];
			if (mark != ESK_FREE) {
				if ((mark == ESK_SEAM_KEPT) != (fates[t] == ESK_KEPT))
					return false;
			} else if (fates[other] == ESK_UNKNOWN) {
				fates[other] = fates[t];
				stack[depth++] = other;
			} else if (fates[other] != fates[t]) {
				return false;
			}
		}
	}
	return true;
}

static bool judge(work *w)
{
	esk_shell *shell = &w->cut->shell;
	w->cut->fates = esk_memory_zeroed_array(shell->triangle_capacity, sizeof *w->cut->fates);
	if (!w->cut->fates)
		return lack_memory(w);
	if (w->seams->counts[w->s] == 0) {
		memset(w->cut->fates, (int)judge_whole(w), shell->triangle_count);
		return true;
	}
	uint32_t *stack = esk_memory_array(shell->triangle_count, sizeof *stack);
	if (!stack)
		return lack_memory(w);
	const bool good = spread(shell, w->cut->fates, stack);
	free(stack);
	return good;
}

static bool is_chord(const esk_shell *shell, uint32_t h)
{
	return shell->marks[h] == ESK_FREE && shell->seams[esk_shell_start(shell, h)] != ESK_NONE &&
	       shell->seams[esk_shell_end(shell, h)] != ESK_NONE;
}

/* Edges between vertices of seams, but not along one, cut corners of the surface, and two shells could have the same one. */
static bool divide_chords(work *w)
{
	esk_shell *shell = &w->cut->shell;
	for (uint32_t t = 0; t < shell->triangle_count; t++)
		for (uint32_t h = 4 * t; h < 4 * t + 3 && w->cut->fates[t] == ESK_KEPT; h++) {
			const size_t before = shell->triangle_count;
			if (!is_chord(shell, h))
				continue;
			if (!esk_shell_divide(shell, h))
				return false;
			memset(w->cut->fates + before, ESK_KEPT, shell->triangle_count - before);
			h = 4 * t - 1; /* the triangle is another one */
		}
	return true;
}

/* Of what is kept, the vertices of seams and their neighbours. */
static bool relax(work *w)
{
	esk_shell *shell = &w->cut->shell;
	uint8_t *near = esk_memory_zeroed_array(shell->vertex_count, sizeof *near);
	uint32_t *list = esk_memory_array(shell->vertex_count, sizeof *list);
	size_t count = 0;
	for (uint32_t t = 0; near && t < shell->triangle_count; t++) {
		const uint32_t *corners = shell->starts + 4 * t;
		bool at_seam = false;
		for (int k = 0; k < 3; k++)
			at_seam = at_seam || shell->seams[corners[k]] != ESK_NONE;
		for (int k = 0; k < 3 && at_seam && w->cut->fates[t] == ESK_KEPT; k++)
			near[corners[k]] = 1;
	}
	for (uint32_t v = 0; near && list && v < shell->vertex_count; v++)
		if (near[v])
			list[count++] = v;
	const esk_ellipsoid *others[ESKEL_LEVELS_MAX];
	size_t other_count = 0;
	for (uint32_t k = 0; k < w->count; k++)
		if (k != w->s && !w->seams->swallowed[k] &&
			esk_ellipsoids_meet(&w->ellipsoids[k], &w->ellipsoids[w->s]))
			others[other_count++] = &w->ellipsoids[k];
	const bool good = near && list;
	if (good)
		esk_shell_relax(shell, count, list, others, other_count);
	free(near);
	free(list);
	return good || lack_memory(w);
}

static bool make(work *w)
{
	/* Room for the seams, and as much again for edges to be divided. */
	const size_t room = 3 * w->seams->counts[w->s];
	if (!esk_shell_make(&w->ellipsoids[w->s], w->step, room, &w->cut->shell))
		return lack_memory(w);
	w->places = esk_memory_array(w->seams->vertex_count, sizeof *w->places);
	if (!w->places)
		return lack_memory(w);
	return lay_seams(w) && judge(w) && (w->seams->counts[w->s] == 0 || (divide_chords(w) && relax(w)));
}

eskel_status esk_cut_make(
	const esk_ellipsoid *ellipsoids, uint32_t count, uint32_t s, const esk_seams *seams, double step, esk_cut *cut)
{
	work w = {.ellipsoids = ellipsoids, .count = count, .s = s, .seams = seams, .step = step, .cut = cut};
	*cut = (esk_cut){0};
	const bool good = make(&w);
	free(w.places);
	if (good)
		return ESKEL_OK;
	esk_cut_clear(cut);
	return w.lacks_memory ? ESKEL_NO_MEMORY : ESKEL_NUMERIC;
}

void esk_cut_clear(esk_cut *cut)
{
	esk_shell_clear(&cut->shell);
	free(cut->fates);
	cut->fates = NULL;
}
