#include "seams.h"

#include "memory.h"
#include "seam_crossings.h"

#include <stdlib.h>
#include <string.h>

/* By how much a potential may pass 0 and not count: a millionth of a radius, and less. */
static const double least_depth = 1e-7;
/* An edge turns by no more than this, in radians. */
static const double turn_most = 0.6;

typedef struct {
	const esk_ellipsoid *all;
	uint32_t count;
	double step;
	uint32_t a, b;
	esk_curve curves[2];
	int curve_count;
	esk_crossings crossings;
	double *lengths; /* up to each of the points of an arc */
	double (*points)[3];
	size_t point_count, point_capacity, length_capacity;
	esk_seams *seams;
	bool lacks_memory;
} work;

static bool reserve(work *w, void **array, size_t *capacity, size_t needed, size_t size)
{
	const bool good = esk_memory_reserve(array, capacity, needed, size);
	w->lacks_memory = w->lacks_memory || !good;
	return good;
}

/* ---- pairs */

/* Whether the surfaces cross; if not, whether one is in the other. */
static eskel_status relate(const work *w, uint32_t a, uint32_t b, esk_seam_starts *starts)
{
	bool *swallowed = w->seams->swallowed;
	starts->count = 0;
	if (!esk_ellipsoids_meet(&w->all[a], &w->all[b]))
		return ESKEL_OK;
	if (!esk_seam_find(&w->all[a], &w->all[b], starts))
		return ESKEL_NUMERIC;
	if (starts->greatest <= least_depth) {
		starts->count = 0;
		swallowed[a] = true;
	} else if (starts->least >= -least_depth) {
		starts->count = 0;
		swallowed[b] = swallowed[b] || esk_ellipsoid_value(&w->all[a], w->all[b].centre) < 0;
	}
	return ESKEL_OK;
}

static bool find_curves(work *w, const esk_seam_starts *starts)
{
	const esk_ellipsoid *a = &w->all[w->a], *b = &w->all[w->b];
	for (int i = 0; i < starts->count; i++) {
		double point[3], way[3];
		memcpy(point, starts->points[i], sizeof point);
		if (!esk_seam_settle(a, b, point) || !esk_seam_way(a, b, point, way))
			return false;
		bool known = false;
		for (int c = 0; c < w->curve_count; c++)
			known = known || esk_seam_passes(&w->curves[c], point, way);
		if (known)
			continue;
		if (w->curve_count == 2)
			return false;
		const eskel_status status = esk_seam_trace(a, b, point, w->step, &w->curves[w->curve_count++]);
		w->lacks_memory = w->lacks_memory || status == ESKEL_NO_MEMORY;
		if (status)
			return false;
	}
	return true;
}

/* ---- arcs */

static bool add_vertex(work *w, const double point[3], uint32_t a, uint32_t b, uint32_t c, uint32_t *vertex)
{
	esk_seams *s = w->seams;
	void *array = s->vertices;
	if (!reserve(w, &array, &s->vertex_capacity, s->vertex_count + 1, sizeof *s->vertices))
		return false;
	s->vertices = array;
	*vertex = (uint32_t)s->vertex_count;
	s->vertices[s->vertex_count++] =
		(esk_seam_vertex){.point = {point[0], point[1], point[2]}, .surfaces = {a, b, c}};
	return true;
}

static bool add_to_path(work *w, uint32_t vertex)
{
	esk_seams *s = w->seams;
	void *array = s->path;
	if (!reserve(w, &array, &s->path_capacity, s->path_count + 1, sizeof *s->path))
		return false;
	s->path = array;
	s->path[s->path_count++] = vertex;
	s->counts[w->a]++;
	s->counts[w->b]++;
	return true;
}

/* The vertex of a corner, which three curves find each on its own. */
static bool find_corner(work *w, const esk_crossing *c, uint32_t *vertex)
{
	esk_seams *s = w->seams;
	uint32_t surfaces[3] = {w->a, w->b, c->by};
	for (int i = 2; i > 0 && surfaces[i] < surfaces[i - 1]; i--) {
		const uint32_t swap = surfaces[i];
		surfaces[i] = surfaces[i - 1];
		surfaces[i - 1] = swap;
	}
	for (*vertex = 0; *vertex < s->vertex_count; (*vertex)++) {
		const esk_seam_vertex *v = &s->vertices[*vertex];
		double square = 0;
		if (memcmp(v->surfaces, surfaces, sizeof surfaces) != 0)
			continue;
		for (int i = 0; i < 3; i++)
			square += (v->point[i] - c->point[i]) * (v->point[i] - c->point[i]);
		if (square < ESK_SAME_CORNER * ESK_SAME_CORNER * w->step * w->step)
			break;
	}
	if (*vertex == s->vertex_count && !add_vertex(w, c->point, surfaces[0], surfaces[1], surfaces[2], vertex))
		return false;
	s->vertices[*vertex].ends++;
	return true;
}

static bool add_length(work *w, const double point[3])
{
	void *array = w->points;
	if (!reserve(w, &array, &w->point_capacity, w->point_count + 1, sizeof *w->points))
		return false;
	w->points = array;
	array = w->lengths;
	if (!reserve(w, &array, &w->length_capacity, w->point_count + 1, sizeof *w->lengths))
		return false;
	w->lengths = array;
	double length = 0;
	if (w->point_count) {
		const double *before = w->points[w->point_count - 1];
		const double u[3] = {point[0] - before[0], point[1] - before[1], point[2] - before[2]};
		length = w->lengths[w->point_count - 1] + esk_triple_length(u);
	}
	w->lengths[w->point_count] = length;
	memcpy(w->points[w->point_count++], point, sizeof *w->points);
	return true;
}

/* The points of the curve from one place to another, with both ends. */
static bool copy_arc(work *w, const esk_curve *c, const double *start, double from, double to, const double *end)
{
	w->point_count = 0;
	bool good = add_length(w, start);
	for (size_t i = (size_t)from + 1; (double)i < to && good; i++)
		good = add_length(w, c->points[i % c->count]);
	return good && add_length(w, end);
}

/* How many edges an arc becomes: of a step, and as many as its turns ask for. */
static size_t count_edges(const work *w)
{
	double turn = 0;
	for (size_t i = 2; i < w->point_count; i++) {
		double u[3], v[3], across[3];
		esk_triple_subtract(w->points[i - 1], w->points[i - 2], u);
		esk_triple_subtract(w->points[i], w->points[i - 1], v);
		esk_triple_cross(u, v, across);
		const double size = esk_triple_length(u) * esk_triple_length(v);
		turn += size > 0 ? esk_triple_length(across) / size : 0;
	}
	const double by_length = w->lengths[w->point_count - 1] / w->step + 0.5, by_turn = turn / turn_most + 1;
	return (size_t)(by_length > by_turn ? by_length : by_turn);
}

/* Puts vertices on an arc at equal distances, and its ends. */
static bool lay_arc(work *w, uint32_t first, uint32_t last)
{
	const double whole = w->lengths[w->point_count - 1];
	const size_t edges = count_edges(w);
	esk_seams *s = w->seams;
	void *array = s->arcs;
	if (!reserve(w, &array, &s->arc_capacity, s->arc_count + 1, sizeof *s->arcs))
		return false;
	s->arcs = array;
	s->arcs[s->arc_count++] = (esk_seam_arc){w->a, w->b, s->path_count, edges + 1};
	bool good = add_to_path(w, first);
	for (size_t e = 1, at = 0; e < edges && good; e++) {
		const double length = whole * (double)e / (double)edges;
		while (at + 2 < w->point_count && w->lengths[at + 1] < length)
			at++;
		const double share = (length - w->lengths[at]) / (w->lengths[at + 1] - w->lengths[at]);
		double point[3];
		uint32_t vertex = 0;
		for (int k = 0; k < 3; k++)
			point[k] = w->points[at][k] + share * (w->points[at + 1][k] - w->points[at][k]);
		good = esk_seam_settle(&w->all[w->a], &w->all[w->b], point) &&
		       add_vertex(w, point, w->a, w->b, ESKEL_LEVELS_MAX, &vertex) && add_to_path(w, vertex);
	}
	return good && add_to_path(w, last);
}

static bool lay_closed(work *w, const esk_curve *c)
{
	uint32_t vertex = 0;
	return add_vertex(w, c->points[0], w->a, w->b, ESKEL_LEVELS_MAX, &vertex) &&
	       copy_arc(w, c, c->points[0], 0, (double)c->count, c->points[0]) && lay_arc(w, vertex, vertex);
}

/* The arc from the crossing where nothing hides the curve any more to the next one. */
static bool lay_between(work *w, const esk_curve *c, const esk_crossing *from, const esk_crossing *to)
{
	uint32_t first = 0, last = 0;
	const double end = to->at > from->at ? to->at : to->at + (double)c->count;
	return to->hides && find_corner(w, from, &first) && find_corner(w, to, &last) && first != last &&
	       copy_arc(w, c, from->point, from->at, end, to->point) && lay_arc(w, first, last);
}

/* hidden: how many hide the curve where it starts. */
static bool lay_visible(work *w, size_t hidden)
{
	const esk_curve *c = &w->curves[w->curve_count - 1];
	const size_t count = w->crossings.count, before = hidden;
	if (count == 0)
		return hidden || lay_closed(w, c);
	esk_crossings_sort(&w->crossings);
	for (size_t i = 0; i < count; i++) {
		if (!w->crossings.items[i].hides && hidden == 0)
			return false;
		hidden = w->crossings.items[i].hides ? hidden + 1 : hidden - 1;
		if (hidden == 0 && !lay_between(w, c, &w->crossings.items[i], &w->crossings.items[(i + 1) % count]))
			return false;
	}
	return hidden == before;
}

static bool lay_curve(work *w)
{
	const esk_curve *c = &w->curves[w->curve_count - 1];
	size_t hidden = 0;
	w->crossings.count = 0;
	for (uint32_t k = 0; k < w->count; k++) {
		if (k == w->a || k == w->b || w->seams->swallowed[k] ||
			!esk_ellipsoids_meet(&w->all[k], &w->all[w->a]) ||
			!esk_ellipsoids_meet(&w->all[k], &w->all[w->b]))
			continue;
		hidden += esk_ellipsoid_value(&w->all[k], c->points[0]) < 0;
		const eskel_status status =
			esk_crossings_add(&w->all[w->a], &w->all[w->b], c, &w->all[k], k, w->step, &w->crossings);
		w->lacks_memory = w->lacks_memory || status == ESKEL_NO_MEMORY;
		if (status)
			return false;
	}
	return lay_visible(w, hidden);
}

static bool lay_pair(work *w, const esk_seam_starts *starts)
{
	bool good = find_curves(w, starts);
	for (; w->curve_count > 0; w->curve_count--) {
		good = good && lay_curve(w);
		esk_curve_clear(&w->curves[w->curve_count - 1]);
	}
	return good;
}

/* ---- the whole */

static bool are_corners_whole(const esk_seams *s)
{
	for (size_t v = 0; v < s->vertex_count; v++)
		if (s->vertices[v].surfaces[2] != ESKEL_LEVELS_MAX && s->vertices[v].ends != 3)
			return false;
	return true;
}

eskel_status esk_seams_make(const esk_ellipsoid *all, uint32_t count, double step, esk_seams *seams)
{
	work w = {.all = all, .count = count, .step = step, .seams = seams};
	esk_seam_starts *starts = esk_memory_array((size_t)count * count, sizeof *starts);
	eskel_status status = starts ? ESKEL_OK : ESKEL_NO_MEMORY;
	*seams = (esk_seams){0};
	for (uint32_t a = 0; a < count && !status; a++)
		for (uint32_t b = a + 1; b < count && !status; b++)
			status = relate(&w, a, b, &starts[a * count + b]);
	for (w.a = 0; w.a < count && !status; w.a++)
		for (w.b = w.a + 1; w.b < count && !status; w.b++)
			if (starts[w.a * count + w.b].count && !seams->swallowed[w.a] && !seams->swallowed[w.b] &&
				!lay_pair(&w, &starts[w.a * count + w.b]))
				status = w.lacks_memory ? ESKEL_NO_MEMORY : ESKEL_NUMERIC;
	if (!status && !are_corners_whole(seams))
		status = ESKEL_NUMERIC;
	free(starts);
	free(w.crossings.items);
	free(w.points);
	free(w.lengths);
	if (status)
		esk_seams_clear(seams);
	return status;
}

void esk_seams_clear(esk_seams *seams)
{
	free(seams->vertices);
	free(seams->arcs);
	free(seams->path);
	*seams = (esk_seams){0};
}
