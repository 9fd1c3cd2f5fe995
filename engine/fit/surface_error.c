/* Errors of a surface against a cloud (section 3.7; eskel_surface.h says what each is).
 *
 * The first-order distance of the paper flatters where the gradient is small, as between two primitives, so distances are
 * also measured at the true surface. That needs it as points: a mesh with a step of about a voxel. From the vertex that is
 * nearest to a point, the foot of the perpendicular is found by steps that go onto the surface (Newton) and along it (half of
 * what the point is off the normal); should they lead away, the vertex stays. */
#include "affine.h"
#include "boundary.h"
#include "elementary.h"
#include "error.h"
#include "memory.h"
#include "polygonise.h"
#include "surface.h"
#include "surface_error.h"
#include "team.h"
#include "triple.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	FACES_MOST = 10000,
	PIECE = 128, /* samples, or voxels of a row, at once */
	FOOT_STEPS = 20,
};
static const double tiny_step = 1e-3; /* voxels: the foot is found */
/* The mesh's step: a voxel, but no fewer than 8 and no more than 64 on the side of a cube of the volume. */
static const double cells_least = 8, cells_most = 64;

typedef struct {
	double distance, weight;
} sample;

typedef struct {
	const esk_boundary *boundary;
	const eskel_surface *surface;
	const eskel_mesh *mesh;
	esk_nearest *vertices;
	uint32_t *faces;
	size_t face_count;
	double length;                 /* mm: first-order distances saturate at it */
	double *deltas;                /* at faces */
	sample *to_surface;            /* from faces */
	sample *to_boundary;           /* from vertices */
	double (*places)[3];           /* of vertices */
	int64_t least[3], greatest[3]; /* the box of voxel indices with cloud and mesh */
	uint64_t *inside, *common;     /* voxels, by slice of the box */
} work;

static double distance_to_vertex(const void *context, uint32_t vertex, const double point[3])
{
	const double *v = ((const double(*)[3])context)[vertex];
	return sqrt((v[0] - point[0]) * (v[0] - point[0]) + (v[1] - point[1]) * (v[1] - point[1]) +
		    (v[2] - point[2]) * (v[2] - point[2]));
}

/* The feet of points, from where they are at first; found is whether the last step was tiny. */
typedef struct {
	size_t count;
	double points[PIECE][3], feet[PIECE][3];
	bool found[PIECE];
} feet;

/* A step onto the surface and along it; how long it is. */
static double take_step(const double point[3], double value, const double gradient[3], double longest, double foot[3])
{
	double square = 0, along = 0, moved = 0;
	for (int r = 0; r < 3; r++)
		square += gradient[r] * gradient[r];
	if (!(square > 0))
		return INFINITY;
	for (int r = 0; r < 3; r++)
		along += (point[r] - foot[r]) * gradient[r] / square;
	const double limit = longest / sqrt(square);
	const double onto = fmin(fmax(value / square, -limit), limit);
	for (int r = 0; r < 3; r++) {
		const double step = (point[r] - foot[r] - along * gradient[r]) / 2 - onto * gradient[r];
		foot[r] += step;
		moved += step * step;
	}
	return sqrt(moved);
}

static void find_feet(const work *w, feet *f)
{
	double values[PIECE], gradients[PIECE][3];
	const double spacing = w->boundary->spacing;
	for (int step = 0; step < FOOT_STEPS; step++) {
		esk_composition_gradients(
			&w->surface->composition, f->count, (const double(*)[3])f->feet, values, gradients);
		for (size_t i = 0; i < f->count; i++)
			if (!f->found[i])
				f->found[i] = take_step(f->points[i], values[i], gradients[i], spacing, f->feet[i]) <
					      tiny_step * spacing;
	}
}

static void measure_faces(void *context, size_t piece)
{
	work *w = context;
	const size_t first = piece * PIECE;
	double values[PIECE], gradients[PIECE][3], bounds[PIECE];
	feet f = {.count = w->face_count - first < PIECE ? w->face_count - first : PIECE};
	for (size_t i = 0; i < f.count; i++) {
		uint32_t vertex;
		memcpy(f.points[i], w->boundary->points[w->faces[first + i]], sizeof f.points[i]);
		bounds[i] = esk_nearest_find(w->vertices, f.points[i], 0, distance_to_vertex, w->places, &vertex);
		memcpy(f.feet[i], w->places[vertex], sizeof f.feet[i]);
	}
	esk_composition_gradients(&w->surface->composition, f.count, (const double(*)[3])f.points, values, gradients);
	find_feet(w, &f);
	for (size_t i = 0; i < f.count; i++) {
		const double x = gradients[i][0], y = gradients[i][1], z = gradients[i][2], far = values[i] / w->length;
		const double to_foot = distance_to_vertex(f.feet, (uint32_t)i, f.points[i]);
		const uint8_t direction = w->boundary->directions[w->faces[first + i]];
		w->deltas[first + i] = fabs(values[i]) / sqrt(x * x + y * y + z * z + far * far + 1e-300);
		w->to_surface[first + i].distance = f.found[i] ? fmin(bounds[i], to_foot) : bounds[i];
		w->to_surface[first + i].weight =
			w->face_count == w->boundary->count ? w->boundary->areas[direction / 2] : 1;
	}
}

static void measure_vertices(void *context, size_t piece)
{
	work *w = context;
	for (size_t i = piece * PIECE; i < (piece + 1) * PIECE && i < w->mesh->vertex_count; i++)
		w->to_boundary[i].distance = esk_boundary_distance(w->boundary, w->places[i], NULL);
}

/* A third of the area of its triangles each. */
static void weigh_vertices(work *w)
{
	for (size_t i = 0; i < w->mesh->vertex_count; i++)
		w->to_boundary[i].weight = 0;
	for (size_t t = 0; t < w->mesh->triangle_count; t++) {
		const uint32_t *v = w->mesh->triangles[t];
		double e[3], f[3], across[3];
		esk_triple_subtract(w->places[v[1]], w->places[v[0]], e);
		esk_triple_subtract(w->places[v[2]], w->places[v[0]], f);
		esk_triple_cross(e, f, across);
		for (int c = 0; c < 3; c++)
			w->to_boundary[v[c]].weight += esk_triple_length(across) / 6;
	}
}

static void count_piece(work *w, const double (*points)[3], size_t count, size_t slice)
{
	double values[PIECE];
	eskel_surface_values(w->surface, count, points, values);
	for (size_t i = 0; i < count; i++)
		if (values[i] < 0) {
			w->inside[slice]++;
			w->common[slice] += esk_boundary_holds(w->boundary, points[i]);
		}
}

static void count_slice(void *context, size_t slice)
{
	work *w = context;
	double points[PIECE][3];
	w->inside[slice] = w->common[slice] = 0;
	for (int64_t y = w->least[1]; y <= w->greatest[1]; y++) {
		size_t count = 0;
		for (int64_t x = w->least[0]; x <= w->greatest[0]; x++) {
			const double index[3] = {(double)x, (double)y, (double)(w->least[2] + (int64_t)slice)};
			esk_affine_apply(&w->boundary->cloud->affine, index, points[count]);
			if (++count == PIECE || x == w->greatest[0]) {
				count_piece(w, (const double(*)[3])points, count, slice);
				count = 0;
			}
		}
	}
}

static void bound_voxels(work *w)
{
	for (int c = 0; c < 3; c++) {
		w->least[c] = 0;
		w->greatest[c] = w->boundary->cloud->extent[c] - 1;
	}
	for (size_t i = 0; i < w->mesh->vertex_count; i++) {
		double index[3];
		esk_boundary_index(w->boundary, w->places[i], index);
		for (int c = 0; c < 3; c++) {
			const int64_t below = (int64_t)floor(index[c]), above = (int64_t)ceil(index[c]);
			w->least[c] = below < w->least[c] ? below : w->least[c];
			w->greatest[c] = above > w->greatest[c] ? above : w->greatest[c];
		}
	}
}

static double cloud_side(const esk_boundary *boundary)
{
	return esk_elementary_cbrt(eskel_cloud_volume(boundary->cloud));
}

static bool holds_seeds(const esk_polygonise_options *box)
{
	bool all = true;
	for (size_t i = 0; i < box->seed_count; i++)
		for (int r = 0; r < 3; r++)
			all = all && box->seeds[i][r] >= box->least[r] && box->seeds[i][r] <= box->greatest[r];
	return all;
}

/* In a box that is thrice as wide as the cloud's, and by two sides more: the cloud may be flat. */
static eskel_status make_mesh(const eskel_surface *surface, const esk_boundary *boundary, eskel_mesh **mesh)
{
	const double side = cloud_side(boundary);
	double seeds[ESKEL_LEVELS_MAX][3];
	esk_polygonise_options options = {
		.seeds = (const double(*)[3])seeds, .seed_count = eskel_surface_count(surface)};
	options.step = fmin(fmax(boundary->spacing, side / cells_most), side / cells_least);
	for (int r = 0; r < 3; r++) {
		double least = INFINITY, greatest = -INFINITY;
		for (size_t i = 0; i < boundary->count; i++) {
			least = fmin(least, boundary->points[i][r]);
			greatest = fmax(greatest, boundary->points[i][r]);
		}
		for (uint32_t i = 0; i < options.seed_count; i++)
			seeds[i][r] = eskel_surface_primitive(surface, i)->centre[r];
		options.least[r] = least - (greatest - least) - side;
		options.greatest[r] = greatest + (greatest - least) + side;
	}
	/* Centres are inside of the surface. */
	if (!holds_seeds(&options))
		return ESKEL_TOO_LARGE;
	const esk_field field = esk_composition_field(&surface->composition);
	return esk_polygonise(&field, &options, mesh, NULL);
}

static eskel_status prepare(work *w)
{
	const size_t vertices = w->mesh->vertex_count;
	w->places = esk_memory_array(vertices, sizeof *w->places);
	w->to_boundary = esk_memory_array(vertices, sizeof *w->to_boundary);
	w->faces = esk_memory_array(FACES_MOST, sizeof *w->faces);
	w->deltas = esk_memory_array(FACES_MOST, sizeof *w->deltas);
	w->to_surface = esk_memory_array(FACES_MOST, sizeof *w->to_surface);
	if (!w->places || !w->to_boundary || !w->faces || !w->deltas || !w->to_surface)
		return ESKEL_NO_MEMORY;
	for (size_t i = 0; i < vertices; i++)
		for (int r = 0; r < 3; r++)
			w->places[i][r] = (double)w->mesh->vertices[i][r];
	bound_voxels(w);
	const size_t slices = (size_t)(w->greatest[2] - w->least[2] + 1);
	w->inside = esk_memory_array(slices, sizeof *w->inside);
	w->common = esk_memory_array(slices, sizeof *w->common);
	if (!w->inside || !w->common)
		return ESKEL_NO_MEMORY;
	w->face_count = esk_boundary_sample(w->boundary, FACES_MOST, w->faces);
	weigh_vertices(w);
	return esk_nearest_new((const double(*)[3])w->places, vertices, &w->vertices);
}

static double mean_of(const sample *samples, size_t count)
{
	double sum = 0, weight = 0;
	for (size_t i = 0; i < count; i++) {
		sum += samples[i].weight * samples[i].distance;
		weight += samples[i].weight;
	}
	return sum / weight;
}

static int compare_samples(const void *a, const void *b)
{
	const double x = ((const sample *)a)->distance, y = ((const sample *)b)->distance;
	return (x > y) - (x < y);
}

/* The least distance that 95 percent of the weight do not exceed. Sorts. */
static double percentile_95(sample *samples, size_t count)
{
	double weight = 0, passed = 0;
	qsort(samples, count, sizeof *samples, compare_samples);
	for (size_t i = 0; i < count; i++)
		weight += samples[i].weight;
	for (size_t i = 0; i < count; i++) {
		passed += samples[i].weight;
		if (passed >= 0.95 * weight)
			return samples[i].distance;
	}
	return samples[count - 1].distance;
}

static void sum_up(work *w, eskel_surface_error *errors)
{
	double delta = 0, weight = 0;
	uint64_t inside = 0, common = 0;
	eskel_surface_error e = {0};
	for (size_t i = 0; i < w->face_count; i++) {
		delta += w->to_surface[i].weight * w->deltas[i];
		weight += w->to_surface[i].weight;
		e.greatest_delta = fmax(e.greatest_delta, w->deltas[i]);
	}
	for (int64_t z = 0; z <= w->greatest[2] - w->least[2]; z++) {
		inside += w->inside[z];
		common += w->common[z];
	}
	const double voxels = (double)w->boundary->cloud->voxels;
	e.mean_delta = delta / weight;
	e.mean_error = mean_of(w->to_surface, w->face_count);
	e.mean_distance = (e.mean_error + mean_of(w->to_boundary, w->mesh->vertex_count)) / 2;
	e.hausdorff_95 =
		fmax(percentile_95(w->to_surface, w->face_count), percentile_95(w->to_boundary, w->mesh->vertex_count));
	e.greatest_error = w->to_surface[w->face_count - 1].distance;
	e.dice = 2 * (double)common / ((double)inside + voxels);
	e.volume_ratio = (double)inside / voxels;
	*errors = e;
}

static size_t pieces_of(size_t count)
{
	return (count + PIECE - 1) / PIECE;
}

eskel_status esk_surface_error_measure(
	const eskel_surface *surface, const esk_boundary *boundary, esk_team *team, eskel_surface_error *errors)
{
	eskel_mesh *mesh = NULL;
	eskel_status status = make_mesh(surface, boundary, &mesh);
	if (status)
		return status;
	work w = {.boundary = boundary, .surface = surface, .mesh = mesh, .length = cloud_side(boundary)};
	status = prepare(&w);
	if (!status) {
		esk_team_run(team, pieces_of(w.face_count), measure_faces, &w);
		esk_team_run(team, pieces_of(mesh->vertex_count), measure_vertices, &w);
		esk_team_run(team, (size_t)(w.greatest[2] - w.least[2] + 1), count_slice, &w);
		sum_up(&w, errors);
	}
	free(w.places);
	free(w.to_boundary);
	free(w.faces);
	free(w.deltas);
	free(w.to_surface);
	free(w.inside);
	free(w.common);
	esk_nearest_free(w.vertices);
	eskel_mesh_free(mesh);
	return status;
}

eskel_status eskel_surface_errors(const eskel_surface *surface, const eskel_cloud *cloud, uint32_t threads,
	eskel_surface_error *errors, eskel_error *error)
{
	esk_boundary *boundary = NULL;
	eskel_status status = esk_boundary_new(cloud, &boundary, error);
	if (status)
		return status;
	esk_team *team = esk_team_new(esk_team_threads(threads));
	status = esk_surface_error_measure(surface, boundary, team, errors);
	if (status)
		esk_error_set(
			error, status, "the errors of the surface cannot be measured: %s", eskel_status_text(status));
	esk_team_free(team);
	esk_boundary_free(boundary);
	return status;
}
