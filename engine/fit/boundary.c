/* Faces come from runs: the ends of a run, and along each of the four rows beside it what the runs there do not cover. Runs
 * are sorted by (z, y, x), so a cursor into the neighbouring row only moves forward. Corners, edges and faces are exact
 * images of the voxel's, whatever the affine; with a negative determinant the cross product of two columns points inward,
 * which its sign sets right. */
#include "boundary.h"

#include "affine.h"
#include "error.h"
#include "elementary.h"
#include "memory.h"
#include "triple.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
	size_t count;
	esk_boundary *to; /* NULL: faces are only counted */
} sink;

static void add_face(sink *s, int x, int y, int z, int direction)
{
	if (s->to) {
		double index[3] = {x, y, z};
		index[direction / 2] += direction & 1 ? 0.5 : -0.5;
		esk_affine_apply(&s->to->cloud->affine, index, s->to->points[s->count]);
		s->to->directions[s->count] = (uint8_t)direction;
	}
	s->count++;
}

static void add_ends(sink *s, const eskel_cloud *cloud)
{
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *run = &cloud->runs[i], *next = run + 1;
		const bool continues = i + 1 < cloud->run_count && next->z == run->z && next->y == run->y &&
				       next->x_first == run->x_last + 1; /* with another weight */
		const bool continued =
			i > 0 && run[-1].z == run->z && run[-1].y == run->y && run[-1].x_last + 1 == run->x_first;
		if (!continued)
			add_face(s, run->x_first, run->y, run->z, 0);
		if (!continues)
			add_face(s, run->x_last, run->y, run->z, 1);
	}
}

/* Rows in the order of the runs, also those beside the grid. */
static int64_t row_at(int y, int z)
{
	return (int64_t)z * (1 << 18) + y;
}

static int64_t row_of(const eskel_run *run)
{
	return row_at(run->y, run->z);
}

/* What no run of the row that is (dy, dz) apart covers. */
static void add_sides(sink *s, const eskel_cloud *cloud, int dy, int dz)
{
	const int direction = dy ? 2 + (dy > 0) : 4 + (dz > 0);
	size_t cursor = 0;
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *run = &cloud->runs[i];
		const int64_t row = row_at(run->y + dy, run->z + dz);
		while (cursor < cloud->run_count &&
			(row_of(&cloud->runs[cursor]) < row ||
				(row_of(&cloud->runs[cursor]) == row && cloud->runs[cursor].x_last < run->x_first)))
			cursor++;
		int x = run->x_first;
		for (size_t j = cursor; x <= run->x_last; j++) {
			const bool meets = j < cloud->run_count && row_of(&cloud->runs[j]) == row &&
					   cloud->runs[j].x_first <= run->x_last;
			const int end = meets ? cloud->runs[j].x_first : run->x_last + 1;
			for (; x < end; x++)
				add_face(s, x, run->y, run->z, direction);
			if (!meets)
				break;
			x = cloud->runs[j].x_last + 1;
		}
	}
}

static size_t add_faces(const eskel_cloud *cloud, esk_boundary *to)
{
	sink s = {0, to};
	add_ends(&s, cloud);
	for (int step = -1; step <= 1; step += 2) {
		add_sides(&s, cloud, step, 0);
		add_sides(&s, cloud, 0, step);
	}
	return s.count;
}

static void measure_faces(esk_boundary *b)
{
	const double determinant = eskel_affine_determinant(&b->cloud->affine);
	b->spacing = esk_elementary_cbrt(fabs(determinant));
	for (int axis = 0; axis < 3; axis++) {
		double across[3], (*edges)[3] = b->edges[axis];
		for (int e = 0; e < 2; e++)
			for (int r = 0; r < 3; r++)
				edges[e][r] = b->cloud->affine.m[r][(axis + 1 + e) % 3] / 2;
		esk_triple_cross(edges[0], edges[1], across);
		const double area = esk_triple_length(across);
		b->areas[axis] = 4 * area;
		for (int r = 0; r < 3; r++) {
			b->normals[2 * axis + 1][r] = across[r] / copysign(area, determinant);
			b->normals[2 * axis][r] = -b->normals[2 * axis + 1][r];
		}
		const double sum = esk_triple_dot(edges[0], edges[0]) + esk_triple_dot(edges[1], edges[1]) +
				   2 * fabs(esk_triple_dot(edges[0], edges[1]));
		b->reach = fmax(b->reach, sqrt(sum));
	}
	for (size_t i = 0; i < b->count; i++)
		b->area += b->areas[b->directions[i] / 2];
}

eskel_status esk_boundary_new(const eskel_cloud *cloud, esk_boundary **boundary, eskel_error *error)
{
	const size_t count = add_faces(cloud, NULL);
	if (count > ESK_BOUNDARY_MOST)
		return esk_error_set(error, ESKEL_TOO_LARGE,
			"the boundary has %zu voxel faces, at most %d are possible", count, ESK_BOUNDARY_MOST);
	eskel_status status = ESKEL_NO_MEMORY;
	esk_boundary *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		goto end;
	made->cloud = cloud;
	made->count = count;
	made->points = esk_memory_array(count, sizeof *made->points);
	made->directions = esk_memory_array(count, sizeof *made->directions);
	if (!made->points || !made->directions)
		goto end;
	add_faces(cloud, made);
	measure_faces(made);
	status = esk_nearest_new((const double(*)[3])made->points, count, &made->tree);
	if (status)
		goto end;
	*boundary = made;
	made = NULL;
end:
	esk_boundary_free(made);
	if (status)
		esk_error_set(error, status, "memory ran out before a boundary of %zu voxel faces", count);
	return status;
}

void esk_boundary_free(esk_boundary *boundary)
{
	if (!boundary)
		return;
	free(boundary->points);
	free(boundary->directions);
	esk_nearest_free(boundary->tree);
	free(boundary);
}

/* The point from + t edge, |t| <= 1, that is nearest to 0, as a square of its length. */
static double segment_square(const double from[3], const double edge[3])
{
	const double t = fmin(fmax(-esk_triple_dot(from, edge) / esk_triple_dot(edge, edge), -1), 1);
	double square = 0;
	for (int r = 0; r < 3; r++) {
		const double at = from[r] + t * edge[r];
		square += at * at;
	}
	return square;
}

/* To the plane where the foot of the perpendicular, s and t edges from the centre, is on the face; else to an edge. */
static double face_distance(const void *context, uint32_t face, const double point[3])
{
	const esk_boundary *b = context;
	const int axis = b->directions[face] / 2;
	const double *e = b->edges[axis][0], *f = b->edges[axis][1];
	double from[3];
	for (int r = 0; r < 3; r++)
		from[r] = b->points[face][r] - point[r];
	const double ee = esk_triple_dot(e, e), ef = esk_triple_dot(e, f), ff = esk_triple_dot(f, f),
		     de = -esk_triple_dot(from, e), df = -esk_triple_dot(from, f);
	const double determinant = ee * ff - ef * ef;
	const double s = (de * ff - df * ef) / determinant, t = (df * ee - de * ef) / determinant;
	if (fabs(s) <= 1 && fabs(t) <= 1)
		return fabs(esk_triple_dot(from, b->normals[2 * axis]));
	double square = INFINITY;
	for (int side = -1; side <= 1; side += 2) {
		double e_side[3], f_side[3];
		for (int r = 0; r < 3; r++) {
			e_side[r] = from[r] + side * f[r];
			f_side[r] = from[r] + side * e[r];
		}
		square = fmin(square, fmin(segment_square(e_side, e), segment_square(f_side, f)));
	}
	return sqrt(square);
}

double esk_boundary_distance(const esk_boundary *boundary, const double point[3], uint32_t *face)
{
	return esk_nearest_find(boundary->tree, point, boundary->reach, face_distance, boundary, face);
}

/* The image of the columns other than c spans the planes of constant index c. */
void esk_boundary_index(const esk_boundary *boundary, const double point[3], double index[3])
{
	const eskel_affine *a = &boundary->cloud->affine;
	for (int c = 0; c < 3; c++) {
		double column[3], from[3];
		for (int r = 0; r < 3; r++) {
			column[r] = a->m[r][c];
			from[r] = point[r] - a->m[r][3];
		}
		const double *normal = boundary->normals[2 * c + 1];
		index[c] = esk_triple_dot(from, normal) / esk_triple_dot(column, normal);
	}
}

/* The voxel that a point is in; false outside of the grid. */
static bool voxel_of(const esk_boundary *b, const double point[3], int voxel[3])
{
	double index[3];
	esk_boundary_index(b, point, index);
	for (int c = 0; c < 3; c++) {
		const double at = floor(index[c] + 0.5);
		if (!(at >= 0 && at < b->cloud->extent[c]))
			return false;
		voxel[c] = (int)at;
	}
	return true;
}

bool esk_boundary_holds(const esk_boundary *boundary, const double point[3])
{
	int index[3];
	if (!voxel_of(boundary, point, index))
		return false;
	const eskel_run *runs = boundary->cloud->runs;
	const int64_t row = row_at(index[1], index[2]);
	size_t first = 0, last = boundary->cloud->run_count; /* the first run that does not end before the voxel */
	while (first < last) {
		const size_t middle = first + (last - first) / 2;
		const int64_t there = row_of(&runs[middle]);
		if (there < row || (there == row && runs[middle].x_last < index[0]))
			first = middle + 1;
		else
			last = middle;
	}
	return first < boundary->cloud->run_count && row_of(&runs[first]) == row && runs[first].x_first <= index[0];
}

size_t esk_boundary_sample(const esk_boundary *boundary, size_t most, uint32_t *faces)
{
	const size_t count = most < boundary->count ? most : boundary->count;
	const double step = boundary->area / (double)count;
	double passed = 0;
	size_t taken = 0;
	/* Along the tree, which keeps neighbours together, a face where every half-odd multiple of the step is passed. */
	for (size_t place = 0; place < boundary->count; place++) {
		const uint32_t face = boundary->tree->items[place];
		passed += boundary->areas[boundary->directions[face] / 2];
		if (taken < count && (count == boundary->count || passed > ((double)taken + 0.5) * step))
			faces[taken++] = face;
	}
	return taken;
}
