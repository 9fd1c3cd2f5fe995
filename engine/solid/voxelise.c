/* Closed meshes to runs of voxels, see voxelise.h.
 *
 * Along every row of voxel centres (a line of fixed y and z) the winding number changes where the row crosses the surface:
 * by 1 where it enters a triangle from outside, by -1 where it leaves. A voxel is inside where the sum of the changes at or
 * below its centre is not 0, so parts that overlap unite. Crossings are found triangle by triangle, sorted by row, and
 * summed; there is no array of voxels.
 *
 * All decisions are exact. Vertices are rounded once, each by itself, to 1024ths of a voxel: the surface stays closed,
 * and everything that follows is integer arithmetic. A row through an edge or a vertex counts as moved by an infinitesimal
 * amount along y, and by one infinitesimal to that along z (Edelsbrunner and Muecke, "Simulation of Simplicity", 1990): it
 * then misses all edges, and neighbours agree on the side, as edges compare the same seen from both.
 */
#include "voxelise.h"

#include "affine.h"
#include "error.h"
#include "memory.h"
#include "moments.h"
#include "radix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { part = 1024, half = part / 2 };
static const double longest_extent = 65535;

/* Of the box about the grid, in voxels: less than the half that would hide the centre of a further one. */
static const double margin = 0.375;

/* Slices that all triangles reach into: seconds of work. A slice without a crossing costs time as well. */
static const uint64_t most_slices = (uint64_t)1 << 30;

/* A point in 1024ths of a voxel from the grid's corner: no farther outside it than margin, so differences are below 2^27. */
typedef struct {
	int64_t x, y, z;
} point;

/* A crossing is a number: z, y and the first voxel whose centre is not below it, 16 bits each, then whether the row
 * leaves. So their order is that of the rows, and of the crossings in them. */
static uint64_t crossing(int64_t x, int64_t y, int64_t z, bool leaves)
{
	return (uint64_t)z << 33 | (uint64_t)y << 17 | (uint64_t)x << 1 | leaves;
}

static const double mesh_axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/* The rotation of the quaternion (24, 2, 5, 7), exact in 327ths: 40 degrees about (2, 5, 7). The centres i, j, k lie along
 * the mesh's x at (253 i + 178 j - 106 k) / 327 of a voxel, and so on: as these numbers have no common factor, at every
 * 327th. A face along the axes, wide enough to meet them all, is right within half of that, 0.15 % of a voxel. */
static const double turned_axes[3][3] = {
	{253.0 / 327, -158.0 / 327, 134.0 / 327},
	{178.0 / 327, 274.0 / 327, -13.0 / 327},
	{-106.0 / 327, 83.0 / 327, 298.0 / 327},
};

static double along(const double axis[3], const float at[3])
{
	return axis[0] * (double)at[0] + axis[1] * (double)at[1] + axis[2] * (double)at[2];
}

static void find_box(const esk_solid *solid, const double axis[3], double *least, double *greatest)
{
	*least = INFINITY;
	*greatest = -INFINITY;
	for (size_t t = 0; t < solid->triangle_count; t++)
		for (int c = 0; c < 3; c++) {
			const double place = along(axis, solid->vertices[solid->triangles[t][c]].at);
			*least = place < *least ? place : *least;
			*greatest = place > *greatest ? place : *greatest;
		}
}

eskel_status esk_voxelise_fit(
	const esk_solid *solid, double spacing, bool turned, esk_voxelise_grid *grid, eskel_error *error)
{
	esk_voxelise_grid g = {.spacing = (double)(float)spacing}; /* as a cloud has it */
	memcpy(g.axes, turned ? turned_axes : mesh_axes, sizeof g.axes);
	for (int r = 0; r < 3; r++) {
		double least, greatest;
		find_box(solid, g.axes[r], &least, &greatest);
		const double length = greatest - least, count = fmax(rint(length / spacing), 1);
		if (count > longest_extent)
			return esk_error_set(error, ESKEL_TOO_LARGE,
				"the mesh is %g mm long, %.0f voxels of %g mm, expected at most %.0f", length, count,
				spacing, longest_extent);
		g.extent[r] = (uint32_t)count;
		g.corner[r] = (least + greatest - count * g.spacing) / 2;
	}
	const eskel_affine affine = esk_voxelise_affine(&g);
	eskel_status status = eskel_affine_check(&affine, error);
	if (status == ESKEL_OK)
		*grid = g;
	return status;
}

eskel_affine esk_voxelise_affine(const esk_voxelise_grid *grid)
{
	eskel_affine affine = {0};
	for (int i = 0; i < 3; i++)
		for (int r = 0; r < 3; r++) {
			affine.m[i][r] = grid->axes[r][i] * grid->spacing;
			affine.m[i][3] += grid->axes[r][i] * (grid->corner[r] + grid->spacing / 2);
		}
	return affine;
}

static point *round_vertices(const esk_solid *solid, const esk_voxelise_grid *grid)
{
	point *points = esk_memory_array(solid->vertex_count, sizeof *points);
	for (size_t i = 0; points && i < solid->vertex_count; i++) {
		int64_t rounded[3];
		for (int r = 0; r < 3; r++) {
			/* A vertex that no triangle has may lie outside the box. */
			const double place =
				(along(grid->axes[r], solid->vertices[i].at) - grid->corner[r]) / grid->spacing;
			rounded[r] = (int64_t)rint(part * fmin(fmax(place, -margin), grid->extent[r] + margin));
		}
		points[i] = (point){rounded[0], rounded[1], rounded[2]};
	}
	return points;
}

/* Twice the area of the triangle a, b, row in the plane of y and z: positive when it is counterclockwise as seen from
 * +x, below 2^55. It changes sign, and nothing else, with the order of a and b. */
static int64_t area(const point *a, const point *b, int64_t y, int64_t z)
{
	return (b->y - a->y) * (z - a->z) - (b->z - a->z) * (y - a->y);
}

/* Whether that area is positive, or becomes so as the row moves: by e along y it changes by -(b.z - a.z) e, by e^2 along
 * z by (b.y - a.y) e^2. */
static bool is_left(const point *a, const point *b, int64_t row_area)
{
	if (row_area != 0)
		return row_area > 0;
	return b->z != a->z ? b->z < a->z : b->y > a->y;
}

static int64_t ceiling(esk_int128 numerator, esk_int128 denominator)
{
	esk_int128 quotient = numerator / denominator; /* towards 0 */
	return (int64_t)(quotient + (numerator % denominator > 0));
}

static eskel_status add_crossing(esk_crossings *c, size_t most, uint64_t key, eskel_error *error)
{
	if (c->count == most)
		return esk_error_set(
			error, ESKEL_TOO_LARGE, "the mesh crosses the rows of voxels more than %zu times", most);
	void *items = c->items;
	if (!esk_memory_reserve(&items, &c->capacity, c->count + 1, sizeof *c->items))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu crossings", c->count + 1);
	c->items = items;
	c->items[c->count++] = key;
	return ESKEL_OK;
}

/* The row crosses a triangle that is not parallel to it when it is on one side of all three edges. There, x is the mean
 * of the corners' by the areas opposite to them; voxel i lies at part i + half. */
static eskel_status cross_row(
	const point *const t[3], int64_t j, int64_t k, size_t most, esk_crossings *c, eskel_error *error)
{
	const int64_t y = part * j + half, z = part * k + half;
	int64_t whole = 0, opposite[3];
	int left = 0;
	esk_int128 moment = 0;
	for (int i = 0; i < 3; i++) {
		const point *from = t[(i + 1) % 3], *to = t[(i + 2) % 3];
		opposite[i] = area(from, to, y, z);
		left += is_left(from, to, opposite[i]);
		whole += opposite[i];
		moment += (esk_int128)opposite[i] * (t[i]->x - half);
	}
	if (left != 0 && left != 3)
		return ESKEL_OK;
	bool leaves = whole > 0; /* the normal's x is positive */
	int64_t first =
		leaves ? ceiling(moment, (esk_int128)whole * part) : ceiling(-moment, -(esk_int128)whole * part);
	return add_crossing(c, most, crossing(first, j, k, leaves), error);
}

static int64_t least_of(int64_t a, int64_t b)
{
	return a < b ? a : b;
}

static int64_t greatest_of(int64_t a, int64_t b)
{
	return a > b ? a : b;
}

/* The first row or slice at or above a coordinate, which is above -half; and the first one above it. */
static int64_t first_from(int64_t at)
{
	return (at + half - 1) / part;
}

static int64_t first_above(int64_t at)
{
	return (at + half) / part;
}

/* The y of all points of the triangle in the slice, widened by more than rounding: the exact test follows. */
static void reach(const point *const t[3], int64_t z, int64_t *low, int64_t *high)
{
	double least = INFINITY, greatest = -INFINITY;
	for (int i = 0; i < 3; i++) {
		const point *a = t[i], *b = t[(i + 1) % 3];
		if (z < least_of(a->z, b->z) || z > greatest_of(a->z, b->z))
			continue;
		double share = a->z == b->z ? 0 : (double)(z - a->z) / (double)(b->z - a->z);
		double y = (double)a->y + share * (double)(b->y - a->y);
		double other = a->z == b->z ? (double)b->y : y;
		least = fmin(least, fmin(y, other));
		greatest = fmax(greatest, fmax(y, other));
	}
	*low = greatest_of((int64_t)least - 1, 0);
	*high = (int64_t)greatest + 2;
}

static eskel_status cross_triangle(
	const point *const t[3], const esk_voxelise_grid *grid, size_t most, esk_crossings *c, eskel_error *error)
{
	if (area(t[0], t[1], t[2]->y, t[2]->z) == 0)
		return ESKEL_OK;
	int64_t last = first_above(greatest_of(t[0]->z, greatest_of(t[1]->z, t[2]->z)));
	eskel_status status = ESKEL_OK;
	for (int64_t k = first_from(least_of(t[0]->z, least_of(t[1]->z, t[2]->z)));
		k < last && k < grid->extent[2] && status == ESKEL_OK; k++) {
		int64_t low, high;
		if (c->slices++ == most_slices)
			return esk_error_set(error, ESKEL_TOO_LARGE, "the triangles reach into more than %llu slices",
				(unsigned long long)most_slices);
		reach(t, part * k + half, &low, &high);
		int64_t end = least_of(first_above(high), grid->extent[1]);
		for (int64_t j = first_from(low); j < end && status == ESKEL_OK; j++)
			status = cross_row(t, j, k, most, c, error);
	}
	return status;
}

static eskel_status find_crossings(
	const esk_solid *solid, const esk_voxelise_grid *grid, size_t most, esk_crossings *c, eskel_error *error)
{
	point *points = round_vertices(solid, grid);
	eskel_status status = ESKEL_OK;
	if (!points)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu vertices", solid->vertex_count);
	for (size_t i = 0; i < solid->triangle_count && status == ESKEL_OK; i++) {
		const uint32_t *v = solid->triangles[i];
		const point *const corners[3] = {&points[v[0]], &points[v[1]], &points[v[2]]};
		status = cross_triangle(corners, grid, most, c, error);
	}
	free(points);
	return status;
}

void esk_crossings_clear(esk_crossings *crossings)
{
	free(crossings->items);
	*crossings = (esk_crossings){0};
}

eskel_status esk_crossings_find(const esk_solid *solid, const esk_voxelise_grid *grid, size_t most,
	esk_crossings *crossings, eskel_error *error)
{
	esk_crossings found = {0};
	eskel_status status = find_crossings(solid, grid, most, &found, error);
	if (status == ESKEL_OK && !esk_radix_sort(found.items, found.count, 1))
		status = esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu crossings", found.count);
	if (status == ESKEL_OK) {
		*crossings = found;
		found = (esk_crossings){0};
	}
	esk_crossings_clear(&found);
	return status;
}

/* The voxels from a crossing to the next, if any have this winding number; it is 0 at the end of each row, as the mesh is
 * closed. */
static eskel_run run_after(const uint64_t *item, int64_t winding, size_t *length)
{
	const uint16_t first = (uint16_t)(item[0] >> 1), end = (uint16_t)(item[1] >> 1);
	*length = winding == 0 ? 0 : (size_t)(end - first);
	return (eskel_run){first, (uint16_t)(end - 1), (uint16_t)(item[0] >> 17), (uint16_t)(item[0] >> 33)};
}

static int64_t change(uint64_t item)
{
	return item & 1 ? -1 : 1;
}

esk_winding_counts esk_crossings_count(const esk_crossings *crossings)
{
	esk_winding_counts counts = {0};
	uint64_t negative = 0;
	int64_t winding = 0;
	for (size_t i = 0; i + 1 < crossings->count; i++) {
		size_t length;
		winding += change(crossings->items[i]);
		run_after(&crossings->items[i], winding, &length);
		counts.sum += winding * (int64_t)length;
		counts.inside += length;
		counts.multiple += winding > 1 || winding < -1 ? length : 0;
		negative += winding < 0 ? length : 0;
	}
	counts.reversed = counts.sum < 0 ? counts.inside - negative : negative;
	return counts;
}

eskel_status esk_crossings_fill(const esk_crossings *crossings, esk_run_builder *builder, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	int64_t winding = 0;
	for (size_t i = 0; i + 1 < crossings->count && status == ESKEL_OK; i++) {
		size_t length;
		winding += change(crossings->items[i]);
		const eskel_run run = run_after(&crossings->items[i], winding, &length);
		if (length > 0)
			status = esk_run_builder_add_run(builder, 1, run, error);
	}
	return status;
}
