/* Whether a mesh is closed, oriented and a manifold.
 *
 * Half-edges are sorted by their lower and upper vertex, so that those of an edge stand together. Where every edge has two
 * triangles, the triangles around a vertex form cycles; it is crowded when they form more than one: corners are joined over
 * edges (union-find), and a vertex with corners in two sets is crowded. */
#include "eskel.h"
#include "memory.h"
#include "triple.h"

#include <math.h>
#include <stdlib.h>

typedef struct {
	uint32_t lower, upper;
	uint32_t triangle;
	uint8_t corner; /* of the triangle, where the half-edge starts */
	bool ascending; /* it runs from lower to upper */
} half_edge;

static int compare_half_edges(const void *a, const void *b)
{
	const half_edge *x = a, *y = b;
	if (x->lower != y->lower)
		return x->lower < y->lower ? -1 : 1;
	return (x->upper > y->upper) - (x->upper < y->upper);
}

static uint32_t root_of(uint32_t *parents, uint32_t node)
{
	while (parents[node] != node) {
		parents[node] = parents[parents[node]];
		node = parents[node];
	}
	return node;
}

static void join(uint32_t *parents, uint32_t a, uint32_t b)
{
	a = root_of(parents, a);
	b = root_of(parents, b);
	parents[a < b ? b : a] = a < b ? a : b;
}

static eskel_status check_triangles(const eskel_mesh *mesh)
{
	if (mesh->triangle_count > UINT32_MAX / 3)
		return ESKEL_TOO_LARGE;
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		const uint32_t *v = mesh->triangles[t];
		for (int c = 0; c < 3; c++)
			if (v[c] >= mesh->vertex_count || v[c] == v[(c + 1) % 3])
				return ESKEL_INVALID;
	}
	return ESKEL_OK;
}

static void list_half_edges(const eskel_mesh *mesh, half_edge *edges)
{
	for (size_t t = 0; t < mesh->triangle_count; t++)
		for (uint8_t c = 0; c < 3; c++) {
			const uint32_t from = mesh->triangles[t][c], to = mesh->triangles[t][(c + 1) % 3];
			const bool ascending = from < to;
			edges[3 * t + c] =
				(half_edge){ascending ? from : to, ascending ? to : from, (uint32_t)t, c, ascending};
		}
}

/* The corner of a half-edge's triangle at its lower or upper vertex. */
static uint32_t corner_at(const half_edge *e, bool lower)
{
	return 3 * e->triangle + (e->corner + (uint32_t)(lower != e->ascending)) % 3;
}

/* Joins the corners of the triangles along each edge. */
static void count_edges(const half_edge *edges, size_t count, uint32_t *corners, eskel_mesh_check_result *r)
{
	for (size_t first = 0, next; first < count; first = next) {
		for (next = first + 1; next < count && compare_half_edges(&edges[first], &edges[next]) == 0; next++) {
			join(corners, corner_at(&edges[first], true), corner_at(&edges[next], true));
			join(corners, corner_at(&edges[first], false), corner_at(&edges[next], false));
		}
		r->boundary_edges += next - first == 1;
		r->crowded_edges += next - first > 2;
		r->turned_edges += next - first == 2 && edges[first].ascending == edges[first + 1].ascending;
		r->euler--;
	}
}

/* fans[vertex]: the first set of corners seen there, + 1. */
static void count_vertices(const eskel_mesh *mesh, uint32_t *corners, uint32_t *fans, eskel_mesh_check_result *r)
{
	for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
		uint32_t *fan = &fans[mesh->triangles[c / 3][c % 3]];
		const uint32_t root = root_of(corners, (uint32_t)c) + 1;
		if (*fan == 0) {
			*fan = root;
			r->euler++;
		} else if (*fan != root && *fan != UINT32_MAX) {
			*fan = UINT32_MAX;
			r->crowded_vertices++;
		}
	}
}

/* parents: room for as many as there are vertices. Every join of two sets leaves one less. */
static void count_components(
	const eskel_mesh *mesh, uint32_t *parents, const uint32_t *fans, eskel_mesh_check_result *r)
{
	for (size_t v = 0; v < mesh->vertex_count; v++)
		parents[v] = (uint32_t)v;
	for (size_t t = 0; t < mesh->triangle_count; t++)
		for (int c = 1; c < 3; c++)
			join(parents, mesh->triangles[t][0], mesh->triangles[t][c]);
	for (size_t v = 0; v < mesh->vertex_count; v++)
		r->components += fans[v] && parents[v] == v;
}

static double angle_at(const eskel_mesh *mesh, const uint32_t *t, int corner)
{
	const float *p = mesh->vertices[t[corner]], *q = mesh->vertices[t[(corner + 1) % 3]],
		    *s = mesh->vertices[t[(corner + 2) % 3]];
	double u[3], v[3], across[3];
	for (int i = 0; i < 3; i++) {
		u[i] = (double)q[i] - p[i];
		v[i] = (double)s[i] - p[i];
	}
	esk_triple_cross(u, v, across);
	return atan2(esk_triple_length(across), esk_triple_dot(u, v)) * (180 / 3.14159265358979323846);
}

static double least_angle(const eskel_mesh *mesh)
{
	double least = 180;
	for (size_t t = 0; t < mesh->triangle_count; t++)
		for (int c = 0; c < 3; c++) {
			const double angle = angle_at(mesh, mesh->triangles[t], c);
			least = angle < least ? angle : least;
		}
	return least;
}

eskel_status eskel_mesh_check(const eskel_mesh *mesh, eskel_mesh_check_result *result)
{
	eskel_status status = check_triangles(mesh);
	if (status != ESKEL_OK)
		return status;
	const size_t count = 3 * mesh->triangle_count;
	half_edge *edges = esk_memory_array(count, sizeof *edges);
	uint32_t *corners = esk_memory_array(count, sizeof *corners);
	uint32_t *fans = esk_memory_zeroed_array(mesh->vertex_count, sizeof *fans);
	uint32_t *parents = esk_memory_array(mesh->vertex_count, sizeof *parents);
	if (edges && corners && fans && parents) {
		eskel_mesh_check_result r = {.euler = (int64_t)mesh->triangle_count, .least_angle = least_angle(mesh)};
		for (size_t c = 0; c < count; c++)
			corners[c] = (uint32_t)c;
		list_half_edges(mesh, edges);
		qsort(edges, count, sizeof *edges, compare_half_edges);
		count_edges(edges, count, corners, &r);
		count_vertices(mesh, corners, fans, &r);
		count_components(mesh, parents, fans, &r);
		r.is_manifold = !(r.boundary_edges | r.crowded_edges | r.crowded_vertices | r.turned_edges);
		*result = r;
	} else {
		status = ESKEL_NO_MEMORY;
	}
	free(edges);
	free(corners);
	free(fans);
	free(parents);
	return status;
}
