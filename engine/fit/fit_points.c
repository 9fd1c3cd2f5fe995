/* Points of the boundary alone would let primitives fall apart where classes meet, and let surface grow where no point is:
 * hence the other kinds. Near ones, off the boundary along its normals, keep the surface from folding; far ones are spread
 * over the box around the cloud by a Kronecker sequence (Roberts' R3: multiples of 1/g, 1/g^2, 1/g^3 modulo 1 with g^4 = g + 1),
 * as even as a lattice from the first few on.
 *
 * A margin is the distance to the boundary, exact, but no more than two voxels: who is further off need only be on the right
 * side. */
#include "fit_points.h"

#include "affine.h"
#include "elementary.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>

/* How far off the boundary near points are, in voxels, by turns. */
static const double steps[] = {1, 2, 4};
enum { STEPS = sizeof steps / sizeof *steps };
/* The box is wider than the cloud by this share on each side, and two voxels. */
static const double rim = 0.15;
/* Tried for each far point at most: a shape that fills a sixtieth of its box still gets all. */
enum { CANDIDATES_EACH = 64 };

typedef struct {
	size_t count, most;
	double (*points)[3], *margins;
} point_list;

static eskel_status make_list(size_t most, point_list *list)
{
	*list = (point_list){
		0, most, esk_memory_array(most, sizeof *list->points), esk_memory_array(most, sizeof(double))};
	return list->points && list->margins ? ESKEL_OK : ESKEL_NO_MEMORY;
}

static void clear_list(point_list *list)
{
	free(list->points);
	free(list->margins);
}

/* The kinds' lists; full ones take no more. */
typedef struct {
	const esk_boundary *boundary;
	double most_margin;
	point_list lists[3];
} collection;

static void add(point_list *list, const double point[3], double margin)
{
	if (list->count == list->most)
		return;
	for (int r = 0; r < 3; r++)
		list->points[list->count][r] = point[r];
	list->margins[list->count++] = margin;
}

static void add_off(collection *c, const double point[3])
{
	const bool inside = esk_boundary_holds(c->boundary, point);
	const double distance = esk_boundary_distance(c->boundary, point, NULL);
	add(&c->lists[inside ? ESK_FIT_INSIDE : ESK_FIT_OUTSIDE], point, fmin(distance, c->most_margin));
}

static void add_near(collection *c, const uint32_t *faces, size_t count)
{
	const esk_boundary *b = c->boundary;
	for (size_t i = 0; i < count; i++) {
		add(&c->lists[ESK_FIT_BOUNDARY], b->points[faces[i]], 0);
		double point[3];
		const double step = steps[i / 2 % STEPS] * b->spacing * (i % 2 ? 1 : -1);
		for (int r = 0; r < 3; r++)
			point[r] = b->points[faces[i]][r] + step * b->normals[b->directions[faces[i]]][r];
		add_off(c, point);
	}
}

static void add_far(collection *c)
{
	const eskel_cloud *cloud = c->boundary->cloud;
	const double g = 1.2207440846057596;
	const double strides[3] = {1 / g, 1 / (g * g), 1 / (g * g * g)};
	const size_t most = CANDIDATES_EACH * c->lists[ESK_FIT_INSIDE].most;
	for (size_t n = 1; n <= most; n++) {
		double index[3], point[3];
		for (int r = 0; r < 3; r++) {
			const double share = fmod((double)n * strides[r], 1);
			const double outer = rim * cloud->extent[r] + 2;
			index[r] = share * (cloud->extent[r] + 2 * outer) - outer - 0.5;
		}
		esk_affine_apply(&cloud->affine, index, point);
		if (c->lists[esk_boundary_holds(c->boundary, point) ? ESK_FIT_INSIDE : ESK_FIT_OUTSIDE].count <
			c->lists[ESK_FIT_INSIDE].most)
			add_off(c, point);
		else if (c->lists[ESK_FIT_INSIDE].count == c->lists[ESK_FIT_INSIDE].most &&
			 c->lists[ESK_FIT_OUTSIDE].count == c->lists[ESK_FIT_OUTSIDE].most)
			return;
	}
}

/* In the order of a k-d tree, so that neighbours share a group. */
static eskel_status group(const point_list *list, esk_fit_kind kind, esk_fit_points *to)
{
	esk_nearest *tree = NULL;
	if (list->count == 0)
		return ESKEL_OK;
	const eskel_status status = esk_nearest_new((const double(*)[3])list->points, list->count, &tree);
	if (status)
		return status;
	for (size_t first = 0; first < list->count; first += ESK_LANES) {
		esk_fit_group *g = &to->groups[to->group_count++];
		g->kind = kind;
		for (size_t l = 0; l < ESK_LANES; l++) {
			const bool is_there = first + l < list->count;
			const size_t place = is_there ? first + l : first;
			for (int r = 0; r < 3; r++)
				g->points[r][l] = tree->centres[place][r];
			g->margins[l] = list->margins[tree->items[place]];
			g->weights[l] = is_there ? 1 / (double)list->count : 0;
		}
	}
	esk_nearest_free(tree);
	return ESKEL_OK;
}

/* Of the three kinds. */
static eskel_status group_all(const point_list lists[3], double length, esk_fit_points **points)
{
	size_t groups = 0;
	for (int kind = 0; kind < 3; kind++)
		groups += (lists[kind].count + ESK_LANES - 1) / ESK_LANES;
	eskel_status status = ESKEL_NO_MEMORY;
	esk_fit_points *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return status;
	made->length = length;
	made->groups = aligned_alloc(_Alignof(esk_fit_group), (groups + 1) * sizeof *made->groups);
	status = made->groups ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (int kind = 0; kind < 3 && !status; kind++)
		status = group(&lists[kind], (esk_fit_kind)kind, made);
	if (status)
		esk_fit_points_free(made);
	else
		*points = made;
	return status;
}

eskel_status esk_fit_points_select(
	const esk_fit_points *points, const uint32_t *classes, uint32_t class_index, esk_fit_points **selected)
{
	point_list lists[3] = {{0}};
	eskel_status status = ESKEL_OK;
	for (int kind = 0; kind < 3 && !status; kind++)
		status = make_list(points->group_count * ESK_LANES, &lists[kind]);
	for (size_t g = 0; g < points->group_count && !status; g++)
		for (size_t l = 0; l < ESK_LANES; l++) {
			const esk_fit_group *from = &points->groups[g];
			const double point[3] = {from->points[0][l], from->points[1][l], from->points[2][l]};
			if (classes[g * ESK_LANES + l] == class_index && from->weights[l] > 0)
				add(&lists[from->kind], point, from->margins[l]);
		}
	if (!status)
		status = group_all(lists, points->length, selected);
	for (int kind = 0; kind < 3; kind++)
		clear_list(&lists[kind]);
	return status;
}

eskel_status esk_fit_points_new(const esk_boundary *boundary, size_t boundary_count, esk_fit_points **points)
{
	collection c = {.boundary = boundary};
	uint32_t *faces = esk_memory_array(boundary_count, sizeof *faces);
	eskel_status status = faces ? ESKEL_OK : ESKEL_NO_MEMORY;
	/* A margin that saturation leaves within reach. */
	c.most_margin = fmin(2 * boundary->spacing, 0.05 * esk_elementary_cbrt(eskel_cloud_volume(boundary->cloud)));
	for (int kind = 0; kind < 3 && !status; kind++)
		status = make_list(boundary_count, &c.lists[kind]);
	if (!status) {
		add_near(&c, faces, esk_boundary_sample(boundary, boundary_count, faces));
		add_far(&c);
		status = group_all(c.lists, 0.1 * esk_elementary_cbrt(eskel_cloud_volume(boundary->cloud)), points);
	}
	for (int kind = 0; kind < 3; kind++)
		clear_list(&c.lists[kind]);
	free(faces);
	return status;
}

void esk_fit_points_free(esk_fit_points *points)
{
	if (!points)
		return;
	free(points->groups);
	free(points);
}
