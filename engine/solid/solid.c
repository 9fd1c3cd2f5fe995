/* Closed triangle meshes, see solid.h. */
#include "solid.h"

#include "error.h"
#include "memory.h"
#include "radix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t most_vertices = (size_t)3 * ESK_SOLID_MOST_TRIANGLES; /* below 2^24 */

/* Ten kilometres: whatever is farther out is not in millimetres. */
static const double farthest_mm = 1e7;

void esk_solid_clear(esk_solid *solid)
{
	free(solid->vertices);
	free(solid->triangles);
	*solid = (esk_solid){0};
}

eskel_status esk_solid_add_vertex(esk_solid *solid, const double at[3], eskel_error *error)
{
	for (int r = 0; r < 3; r++)
		if (!(fabs(at[r]) <= farthest_mm))
			return esk_error_set(error, ESKEL_MALFORMED,
				"vertex %zu has the coordinate %g, expected a number within %g mm", solid->vertex_count,
				at[r], farthest_mm);
	if (solid->vertex_count == most_vertices)
		return esk_error_set(error, ESKEL_TOO_LARGE, "the mesh has more than %zu vertices", most_vertices);
	void *vertices = solid->vertices;
	if (!esk_memory_reserve(&vertices, &solid->vertex_capacity, solid->vertex_count + 1, sizeof solid->vertices[0]))
		return esk_error_set(
			error, ESKEL_NO_MEMORY, "memory ran out for %zu vertices", solid->vertex_count + 1);
	solid->vertices = vertices;
	esk_solid_vertex *vertex = &solid->vertices[solid->vertex_count];
	for (int r = 0; r < 3; r++)
		vertex->at[r] = (float)at[r] + 0.0f; /* -0 is 0 */
	solid->vertex_count++;
	return ESKEL_OK;
}

eskel_status esk_solid_add_triangle(esk_solid *solid, const uint32_t vertices[3], eskel_error *error)
{
	if (solid->triangle_count == ESK_SOLID_MOST_TRIANGLES)
		return esk_error_set(
			error, ESKEL_TOO_LARGE, "the mesh has more than %u triangles", ESK_SOLID_MOST_TRIANGLES);
	void *triangles = solid->triangles;
	if (!esk_memory_reserve(
		    &triangles, &solid->triangle_capacity, solid->triangle_count + 1, sizeof solid->triangles[0]))
		return esk_error_set(
			error, ESKEL_NO_MEMORY, "memory ran out for %zu triangles", solid->triangle_count + 1);
	solid->triangles = triangles;
	for (int c = 0; c < 3; c++)
		solid->triangles[solid->triangle_count][c] = vertices[c];
	solid->triangle_count++;
	return ESKEL_OK;
}

static eskel_status check_vertices(const esk_solid *solid, eskel_error *error)
{
	if (solid->triangle_count == 0)
		return esk_error_set(error, ESKEL_EMPTY, "the mesh has no triangle");
	for (size_t t = 0; t < solid->triangle_count; t++)
		for (int c = 0; c < 3; c++)
			if (solid->triangles[t][c] >= solid->vertex_count)
				return esk_error_set(error, ESKEL_MALFORMED,
					"triangle %zu names vertex %u, counted from 0, of %zu", t,
					solid->triangles[t][c], solid->vertex_count);
	return ESKEL_OK;
}

/* Numbers in the order of the floats, and back: the sign bit is turned, and in negative ones all others too. */
static uint32_t rank_of(float at)
{
	uint32_t bits;
	memcpy(&bits, &at, sizeof bits);
	return bits >> 31 ? ~bits : bits | (uint32_t)1 << 31;
}

static float float_of(uint32_t rank)
{
	const uint32_t bits = rank >> 31 ? rank ^ (uint32_t)1 << 31 : ~rank;
	float at;
	memcpy(&at, &bits, sizeof at);
	return at;
}

/* Where a vertex is, and its number: x, y, z and number, 32 bits each. */
static void list_places(const esk_solid *solid, uint64_t *places)
{
	for (size_t i = 0; i < solid->vertex_count; i++) {
		const float *at = solid->vertices[i].at;
		places[2 * i] = (uint64_t)rank_of(at[0]) << 32 | rank_of(at[1]);
		places[2 * i + 1] = (uint64_t)rank_of(at[2]) << 32 | i;
	}
}

static bool same_place(const uint64_t *a, const uint64_t *b)
{
	return a[0] == b[0] && a[1] >> 32 == b[1] >> 32;
}

/* One vertex for each place, in their order; names: the new numbers of the old ones. */
static void keep_places(esk_solid *solid, const uint64_t *places, uint32_t *names)
{
	size_t kept = 0;
	for (size_t i = 0; i < solid->vertex_count; i++) {
		const uint64_t *p = places + 2 * i;
		if (i == 0 || !same_place(p - 2, p))
			solid->vertices[kept++] = (esk_solid_vertex){{float_of((uint32_t)(p[0] >> 32)),
				float_of((uint32_t)p[0]), float_of((uint32_t)(p[1] >> 32))}};
		names[(uint32_t)p[1]] = (uint32_t)(kept - 1);
	}
	solid->vertex_count = kept;
}

/* Sorts the vertices by place, keeps one of each, and renames them in the triangles. */
static eskel_status weld(esk_solid *solid, eskel_error *error)
{
	const size_t count = solid->vertex_count;
	uint64_t *places = esk_memory_array(count, 2 * sizeof *places);
	uint32_t *names = esk_memory_array(count, sizeof *names);
	eskel_status status = ESKEL_NO_MEMORY;
	if (!places || !names)
		goto end;
	list_places(solid, places);
	if (!esk_radix_sort(places, count, 2))
		goto end;
	keep_places(solid, places, names);
	for (size_t t = 0; t < solid->triangle_count; t++)
		for (int c = 0; c < 3; c++)
			solid->triangles[t][c] = names[solid->triangles[t][c]];
	status = ESKEL_OK;
end:
	free(places);
	free(names);
	return status == ESKEL_OK ? status : esk_error_set(error, status, "memory ran out for %zu vertices", count);
}

/* An edge between vertices below 2^24, the lower one first, and whether the triangle goes down it. */
static uint64_t edge_key(uint32_t from, uint32_t to)
{
	bool down = from > to;
	return (uint64_t)(down ? to : from) << 32 | (uint64_t)(down ? from : to) << 1 | down;
}

static size_t list_edges(const esk_solid *solid, uint64_t *edges)
{
	size_t count = 0;
	for (size_t t = 0; t < solid->triangle_count; t++)
		for (int c = 0; c < 3; c++) {
			uint32_t from = solid->triangles[t][c], to = solid->triangles[t][(c + 1) % 3];
			if (from != to)
				edges[count++] = edge_key(from, to);
		}
	return count;
}

static eskel_status refuse_open(const esk_solid *solid, size_t open, uint64_t first, eskel_error *error)
{
	const float *a = solid->vertices[first >> 32].at, *b = solid->vertices[(first & UINT32_MAX) >> 1].at;
	return esk_error_set(error, ESKEL_MALFORMED,
		"the mesh is open: %zu edge%s not shared by opposite triangles, the first from (%g, %g, %g) to (%g, "
		"%g, %g) mm",
		open, open == 1 ? " is" : "s are", (double)a[0], (double)a[1], (double)a[2], (double)b[0], (double)b[1],
		(double)b[2]);
}

static eskel_status check_edges(const esk_solid *solid, eskel_error *error)
{
	uint64_t *edges = esk_memory_array(solid->triangle_count, 3 * sizeof *edges), first = 0;
	if (!edges)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu triangles", solid->triangle_count);
	size_t count = list_edges(solid, edges), open = 0;
	if (!esk_radix_sort(edges, count, 1)) {
		free(edges);
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu edges", count);
	}
	for (size_t begin = 0, end; begin < count; begin = end) {
		int64_t balance = 0;
		for (end = begin; end < count && edges[end] >> 1 == edges[begin] >> 1; end++)
			balance += edges[end] & 1 ? -1 : 1;
		if (balance != 0 && open++ == 0)
			first = edges[begin];
	}
	free(edges);
	return open > 0 ? refuse_open(solid, open, first, error) : ESKEL_OK;
}

eskel_status esk_solid_close(esk_solid *solid, bool turn, eskel_error *error)
{
	eskel_status status = check_vertices(solid, error);
	if (status != ESKEL_OK)
		return status;
	for (size_t i = 0; turn && i < solid->vertex_count; i++)
		for (int r = 0; r < 2; r++)
			solid->vertices[i].at[r] = 0.0f - solid->vertices[i].at[r];
	status = weld(solid, error);
	return status == ESKEL_OK ? check_edges(solid, error) : status;
}

/* The sum over the triangles of the signed volumes of the tetrahedra to a common point: of the mesh, so that little
 * cancels. */
double esk_solid_enclosed(const esk_solid *solid)
{
	const float *o = solid->vertices[solid->triangles[0][0]].at;
	double sum = 0;
	for (size_t t = 0; t < solid->triangle_count; t++) {
		double v[3][3];
		for (int c = 0; c < 3; c++)
			for (int r = 0; r < 3; r++)
				v[c][r] = (double)solid->vertices[solid->triangles[t][c]].at[r] - (double)o[r];
		sum += v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
		       v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
		       v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
	}
	return sum / 6;
}
