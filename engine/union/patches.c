/* A triangle with corners on an ellipsoid lies inside of it. So where triangles of two ellipsoids cross, they do so inside of
 * both; and the triangle of one reaches into the other. The potential f of that is convex, and on a triangle at least the
 * least of its corners less a third of the longest edge, squared, in units of the least radius:
 *	f(sum t_i p_i) = sum t_i f(p_i) - sum_(i<j) t_i t_j |A (p_i - p_j)|^2,   sum_(i<j) t_i t_j <= 1/3.
 * Few triangles next to the creases are left to be compared. */
#include "patches.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	uint32_t corners[3];
	double least[3], greatest[3]; /* its box */
} item;

typedef struct {
	size_t count, capacity;
	item *items;
} list;

typedef struct {
	const eskel_mesh *mesh;
	double (*points)[3];
	uint8_t *near; /* vertices: to the ellipsoid in question */
	list lists[2];
} work;

/* ---- triangles that reach into an ellipsoid */

static double longest_edge(const work *w, const esk_patch *patch)
{
	double longest = 0;
	for (size_t t = patch->first_triangle; t < patch->first_triangle + patch->triangle_count; t++)
		for (int k = 0; k < 3; k++) {
			const double *p = w->points[w->mesh->triangles[t][k]],
				     *q = w->points[w->mesh->triangles[t][(k + 1) % 3]];
			const double edge[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]},
				     square = esk_triple_dot(edge, edge);
			longest = square > longest ? square : longest;
		}
	return sqrt(longest);
}

/* By how much coordinates that are rounded to floats change the potential at most. */
static double find_rounding(const esk_ellipsoid *e)
{
	double farthest = 0, least = e->radii[2];
	for (int i = 0; i < 3; i++) {
		farthest = fmax(farthest, fabs(e->centre[i]) + e->reach[i]);
		least = fmin(least, e->radii[i]);
	}
	return 4 * 0x1p-24 * farthest / least;
}

/* False if one lies inside by more than the rounding. */
static bool find_near(work *w, size_t first, size_t count, const esk_ellipsoid *e, double depth, double inside)
{
	double reach[3];
	bool good = true;
	for (int i = 0; i < 3; i++)
		reach[i] = e->reach[i] * sqrt(1 + depth);
	for (size_t v = first; v < first + count; v++) {
		const double *p = w->points[v];
		w->near[v] = false;
		if (fabs(p[0] - e->centre[0]) < reach[0] && fabs(p[1] - e->centre[1]) < reach[1] &&
			fabs(p[2] - e->centre[2]) < reach[2]) {
			const double value = esk_ellipsoid_value(e, p);
			w->near[v] = value < depth;
			good = good && value >= -inside;
		}
	}
	return good;
}

static bool add_item(work *w, list *l, const uint32_t corners[3])
{
	void *array = l->items;
	if (!esk_memory_reserve(&array, &l->capacity, l->count + 1, sizeof *l->items))
		return false;
	l->items = array;
	item *made = &l->items[l->count++];
	memcpy(made->corners, corners, sizeof made->corners);
	for (int i = 0; i < 3; i++) {
		const double a = w->points[corners[0]][i], b = w->points[corners[1]][i], c = w->points[corners[2]][i];
		made->least[i] = a < b ? (a < c ? a : c) : (b < c ? b : c);
		made->greatest[i] = a > b ? (a > c ? a : c) : (b > c ? b : c);
	}
	return true;
}

/* Those of a patch that may reach into another one's ellipsoid; ESKEL_NUMERIC where a vertex is there. */
static eskel_status list_near(
	work *w, const esk_patch *patch, double edge, const esk_patch *other, size_t seams, list *l)
{
	const esk_ellipsoid *e = other->ellipsoid;
	const double least = fmin(fmin(e->radii[0], e->radii[1]), e->radii[2]), rounding = find_rounding(e);
	const double depth = edge * edge / (3 * least * least) + rounding;
	l->count = 0;
	find_near(w, 0, seams, e, depth, rounding);
	if (!find_near(w, patch->first_vertex, patch->vertex_count, e, depth, rounding))
		return ESKEL_NUMERIC;
	for (size_t t = patch->first_triangle; t < patch->first_triangle + patch->triangle_count; t++) {
		const uint32_t *c = w->mesh->triangles[t];
		if ((w->near[c[0]] | w->near[c[1]] | w->near[c[2]]) && !add_item(w, l, c))
			return ESKEL_NO_MEMORY;
	}
	return ESKEL_OK;
}

/* ---- pairs of triangles */

/* Six times the volume of a tetrahedron. */
static double volume(const double a[3], const double b[3], const double c[3], const double d[3])
{
	double u[3], v[3], w[3], across[3];
	esk_triple_subtract(a, d, u);
	esk_triple_subtract(b, d, v);
	esk_triple_subtract(c, d, w);
	esk_triple_cross(v, w, across);
	return esk_triple_dot(u, across);
}

/* Whether the line through p and q goes through a triangle. */
static bool goes_through(const work *w, const uint32_t corners[3], uint32_t p, uint32_t q)
{
	const double *a = w->points[corners[0]], *b = w->points[corners[1]], *c = w->points[corners[2]];
	const double *from = w->points[p], *to = w->points[q];
	const double x = volume(from, to, a, b), y = volume(from, to, b, c), z = volume(from, to, c, a);
	return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

static bool has_corner(const uint32_t corners[3], uint32_t v)
{
	return corners[0] == v || corners[1] == v || corners[2] == v;
}

static bool have_same_sign(double a, double b)
{
	return (a > 0 && b > 0) || (a < 0 && b < 0);
}

/* Whether an edge of a, with no end in common with b, goes through b, or touches it. */
static bool pierces(const work *w, const uint32_t a[3], const uint32_t b[3])
{
	double sides[3]; /* of the plane of b */
	for (int k = 0; k < 3; k++)
		sides[k] = has_corner(b, a[k])
				   ? 0
				   : volume(w->points[b[0]], w->points[b[1]], w->points[b[2]], w->points[a[k]]);
	for (int k = 0; k < 3; k++) {
		const int next = (k + 1) % 3;
		if (!has_corner(b, a[k]) && !has_corner(b, a[next]) && !have_same_sign(sides[k], sides[next]) &&
			goes_through(w, b, a[k], a[next]))
			return true;
	}
	return false;
}

static bool cross(const work *w, const item *a, const item *b)
{
	int common = 0;
	for (int i = 0; i < 3; i++) {
		if (a->least[i] > b->greatest[i] || b->least[i] > a->greatest[i])
			return false;
		common += has_corner(b->corners, a->corners[i]);
	}
	return common < 2 && (pierces(w, a->corners, b->corners) || pierces(w, b->corners, a->corners));
}

static int compare_items(const void *a, const void *b)
{
	const item *x = a, *y = b;
	return (x->least[0] > y->least[0]) - (x->least[0] < y->least[0]);
}

/* Sweeps along x. */
static bool any_cross(const work *w)
{
	const list *a = &w->lists[0], *b = &w->lists[1];
	double longest = 0;
	qsort(b->items, b->count, sizeof *b->items, compare_items);
	qsort(a->items, a->count, sizeof *a->items, compare_items);
	for (size_t j = 0; j < b->count; j++) {
		const double length = b->items[j].greatest[0] - b->items[j].least[0];
		longest = length > longest ? length : longest;
	}
	for (size_t i = 0, first = 0; i < a->count; i++) {
		while (first < b->count && b->items[first].least[0] < a->items[i].least[0] - longest)
			first++;
		for (size_t j = first; j < b->count && b->items[j].least[0] <= a->items[i].greatest[0]; j++)
			if (cross(w, &a->items[i], &b->items[j]))
				return true;
	}
	return false;
}

/* ---- the whole */

static eskel_status check_pair(
	work *w, const esk_patch *a, double edge_a, const esk_patch *b, double edge_b, size_t seams)
{
	if (!a->triangle_count || !b->triangle_count || !esk_ellipsoids_meet(a->ellipsoid, b->ellipsoid))
		return ESKEL_OK;
	eskel_status status = list_near(w, a, edge_a, b, seams, &w->lists[0]);
	if (!status)
		status = list_near(w, b, edge_b, a, seams, &w->lists[1]);
	if (!status && w->lists[0].count && w->lists[1].count && any_cross(w))
		status = ESKEL_NUMERIC;
	return status;
}

static eskel_status check_pairs(work *w, const esk_patch *patches, const double *edges, size_t count, size_t seams)
{
	eskel_status status = ESKEL_OK;
	for (size_t a = 0; a < count && !status; a++)
		for (size_t b = a + 1; b < count && !status; b++)
			status = check_pair(w, &patches[a], edges[a], &patches[b], edges[b], seams);
	return status;
}

eskel_status esk_patches_check(const eskel_mesh *mesh, const esk_patch *patches, size_t count, size_t seams)
{
	double edges[ESKEL_LEVELS_MAX];
	work w = {.mesh = mesh,
		.points = esk_memory_array(mesh->vertex_count, sizeof *w.points),
		.near = esk_memory_zeroed_array(mesh->vertex_count, sizeof *w.near)};
	eskel_status status = w.points && w.near ? ESKEL_OK : ESKEL_NO_MEMORY;
	if (!status) {
		for (size_t v = 0; v < mesh->vertex_count; v++)
			for (int i = 0; i < 3; i++)
				w.points[v][i] = mesh->vertices[v][i];
		for (size_t p = 0; p < count; p++)
			edges[p] = longest_edge(&w, &patches[p]);
		status = check_pairs(&w, patches, edges, count, seams);
	}
	free(w.points);
	free(w.near);
	free(w.lists[0].items);
	free(w.lists[1].items);
	return status;
}
