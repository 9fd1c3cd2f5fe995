/* Unions of ellipsoids as triangles of their own, against closed forms, the potential, and triangles compared one by one. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "random.h"
#include "skeletons.h"
#include "triple.h"
#include "union_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static eskel_primitive ellipsoid(double x, double y, double z, double a, double b, double c)
{
	return (eskel_primitive){.centre = {x, y, z},
		.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
		.radii = {a, b, c},
		.exponents = {1, 1},
		.alpha = 1};
}

static eskel_surface *compose(const eskel_primitive *primitives, uint32_t count)
{
	eskel_surface *surface = NULL;
	assert_int_equal(eskel_surface_compose(primitives, count, ESKEL_COMPOSE_UNION, &surface), ESKEL_OK);
	return surface;
}

/* ---- triangles compared one by one */

typedef double point[3];

static double side(const point a, const point b, const point c, const point d)
{
	point u, v, w, across;
	esk_triple_subtract(b, a, u);
	esk_triple_subtract(c, a, v);
	esk_triple_subtract(d, a, w);
	esk_triple_cross(u, v, across);
	return esk_triple_dot(across, w);
}

static bool passes(const point p, const point q, point t[3])
{
	const double from = side(t[0], t[1], t[2], p), to = side(t[0], t[1], t[2], q);
	if ((from > 0) == (to > 0))
		return false;
	const double x = side(p, q, t[0], t[1]), y = side(p, q, t[1], t[2]), z = side(p, q, t[2], t[0]);
	return (x > 0 && y > 0 && z > 0) || (x < 0 && y < 0 && z < 0);
}

static void corners_of(const eskel_mesh *mesh, size_t t, point corners[3])
{
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			corners[k][i] = mesh->vertices[mesh->triangles[t][k]][i];
}

/* Whether an edge of one that has no end in the other goes through it. */
static bool cross(const eskel_mesh *mesh, size_t s, size_t t)
{
	point a[3], b[3];
	const uint32_t *x = mesh->triangles[s], *y = mesh->triangles[t];
	bool common[3] = {false, false, false};
	for (int k = 0; k < 3; k++)
		common[k] = x[k] == y[0] || x[k] == y[1] || x[k] == y[2];
	if (common[0] + common[1] + common[2] > 1)
		return false;
	corners_of(mesh, s, a);
	corners_of(mesh, t, b);
	for (int k = 0; k < 3; k++)
		if (!common[k] && !common[(k + 1) % 3] && passes(a[k], a[(k + 1) % 3], b))
			return true;
	return false;
}

typedef struct {
	float least[3], greatest[3];
	size_t triangle;
} box;

static int compare_boxes(const void *a, const void *b)
{
	const box *x = a, *y = b;
	return (x->least[0] > y->least[0]) - (x->least[0] < y->least[0]);
}

static size_t count_crossings(const eskel_mesh *mesh)
{
	box *boxes = calloc(mesh->triangle_count, sizeof *boxes);
	size_t found = 0;
	assert_non_null(boxes);
	for (size_t t = 0; t < mesh->triangle_count; t++) {
		boxes[t].triangle = t;
		for (int i = 0; i < 3; i++) {
			const float a = mesh->vertices[mesh->triangles[t][0]][i],
				    b = mesh->vertices[mesh->triangles[t][1]][i],
				    c = mesh->vertices[mesh->triangles[t][2]][i];
			boxes[t].least[i] = fminf(a, fminf(b, c));
			boxes[t].greatest[i] = fmaxf(a, fmaxf(b, c));
		}
	}
	qsort(boxes, mesh->triangle_count, sizeof *boxes, compare_boxes);
	for (size_t i = 0; i < mesh->triangle_count; i++)
		for (size_t j = i + 1; j < mesh->triangle_count && boxes[j].least[0] <= boxes[i].greatest[0]; j++) {
			const box *a = &boxes[i], *b = &boxes[j];
			if (a->least[1] > b->greatest[1] || b->least[1] > a->greatest[1] ||
				a->least[2] > b->greatest[2] || b->least[2] > a->greatest[2])
				continue;
			found += cross(mesh, a->triangle, b->triangle) || cross(mesh, b->triangle, a->triangle);
		}
	free(boxes);
	return found;
}

/* ---- what every mesh must be */

/* How many surfaces a point lies on, and the mean of their normals. */
static int add_normals(const double at[3], const eskel_primitive *primitives, uint32_t count, double sum[3])
{
	int surfaces = 0;
	for (uint32_t i = 0; i < count; i++) {
		eskel_surface *one = compose(&primitives[i], 1);
		double normal[3];
		if (fabs(eskel_surface_distance(one, at, normal)) < 1e-4) {
			surfaces++;
			for (int k = 0; k < 3; k++)
				sum[k] += normal[k];
		}
		eskel_surface_free(one);
	}
	return surfaces;
}

/* Vertices are on the surface, with its normal; the mean of several on creases. */
static void check_vertices(const eskel_mesh *mesh, const eskel_primitive *primitives, uint32_t count)
{
	eskel_surface *surface = compose(primitives, count);
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const double at[3] = {mesh->vertices[v][0], mesh->vertices[v][1], mesh->vertices[v][2]};
		double sum[3] = {0, 0, 0}, dot = 0;
		assert_true(fabs(eskel_surface_distance(surface, at, NULL)) < 1e-4);
		if (v % 16 == 0) {
			assert_in_range(add_normals(at, primitives, count, sum), 1, 3);
			for (int i = 0; i < 3; i++)
				dot += sum[i] * mesh->normals[v][i];
			assert_true(dot > 0.9999 * esk_triple_length(sum));
		}
	}
	eskel_surface_free(surface);
}

static void check(const eskel_mesh *mesh, const eskel_primitive *primitives, uint32_t count, eskel_mesh_check_result *r)
{
	assert_int_equal(eskel_mesh_check(mesh, r), ESKEL_OK);
	assert_true(r->is_manifold);
	assert_int_equal(count_crossings(mesh), 0);
	check_vertices(mesh, primitives, count);
}

static eskel_mesh *make(const eskel_primitive *primitives, uint32_t count, double step, size_t components)
{
	eskel_mesh *mesh = NULL;
	eskel_mesh_check_result r;
	assert_int_equal(esk_union_mesh(primitives, count, step, SIZE_MAX, &mesh), ESKEL_OK);
	check(mesh, primitives, count, &r);
	assert_int_equal(r.components, components);
	return mesh;
}

/* ---- closed forms */

static void an_ellipsoid_of_any_shape_has_its_volume(void **state)
{
	(void)state;
	static const double radii[][3] = {
		{10, 10, 10}, {3, 3, 30}, {30, 3, 30}, {2, 40, 10}, {0.5, 0.5, 40}, {0.5, 40, 40}, {1, 1, 1}};
	for (size_t i = 0; i < sizeof radii / sizeof *radii; i++) {
		const double *r = radii[i];
		const eskel_primitive one = ellipsoid(5, -3, 2, r[0], r[1], r[2]);
		eskel_mesh *mesh = make(&one, 1, 1, 1);
		assert_true(fabs(eskel_mesh_volume(mesh) / (4 * pi / 3 * r[0] * r[1] * r[2]) - 1) < 0.2);
		eskel_mesh_free(mesh);
	}
}

/* The error falls with the square of the step, as it does on a smooth surface: creases are sharp. */
static void two_spheres_have_the_volume_of_their_lens_less(void **state)
{
	(void)state;
	const double r = 10, apart = 12, height = r - apart / 2;
	const double expected = 8 * pi / 3 * r * r * r - 2 * pi * height * height * (r - height / 3);
	double errors[2];
	for (int i = 0; i < 2; i++) {
		const eskel_primitive two[] = {
			ellipsoid(0, 0, 0, r, r, r), ellipsoid(apart / 3, apart * 2 / 3, apart * 2 / 3, r, r, r)};
		eskel_mesh *mesh = make(two, 2, i ? 0.5 : 1, 1);
		errors[i] = 1 - eskel_mesh_volume(mesh) / expected;
		eskel_mesh_free(mesh);
	}
	assert_true(errors[0] > 0 && errors[0] < 5e-3);
	assert_true(errors[1] > 0 && errors[1] < errors[0] / 3.5);
}

static void a_crease_is_the_circle_where_spheres_meet(void **state)
{
	(void)state;
	const eskel_primitive two[] = {ellipsoid(-6, 0, 0, 10, 10, 10), ellipsoid(6, 0, 0, 10, 10, 10)};
	eskel_mesh *mesh = make(two, 2, 1, 1);
	size_t on = 0;
	double length = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const float *p = mesh->vertices[v];
		assert_true(hypotf(p[1], p[2]) < 10 + 1e-5f);
		on += fabsf(p[0]) < 1e-5f && fabsf(hypotf(p[1], p[2]) - 8) < 1e-5f;
		assert_true(fabsf(p[0]) > 1e-5f || fabsf(mesh->normals[v][0]) < 1e-5f);
	}
	for (size_t t = 0; t < mesh->triangle_count; t++)
		for (int k = 0; k < 3; k++) {
			const float *p = mesh->vertices[mesh->triangles[t][k]],
				    *q = mesh->vertices[mesh->triangles[t][(k + 1) % 3]];
			if (fabsf(p[0]) < 1e-5f && fabsf(q[0]) < 1e-5f)
				length += hypotf(p[1] - q[1], p[2] - q[2]) / 2; /* of both sides */
		}
	assert_in_range(on, 45, 55);
	assert_true(fabs(length - 2 * 50 * 8 * sin(pi / 50)) < 0.1);
	eskel_mesh_free(mesh);
}

/* By a grid of points. */
static double sum_volume(
	const eskel_primitive *primitives, uint32_t count, double least, double greatest, int side_count)
{
	eskel_surface *surface = compose(primitives, count);
	const double side_length = (greatest - least) / side_count;
	size_t inside = 0;
	for (int z = 0; z < side_count; z++)
		for (int y = 0; y < side_count; y++)
			for (int x = 0; x < side_count; x++) {
				const double at[3] = {least + (x + 0.5) * side_length, least + (y + 0.5) * side_length,
					least + (z + 0.5) * side_length};
				inside += eskel_surface_contains(surface, at);
			}
	eskel_surface_free(surface);
	return (double)inside * side_length * side_length * side_length;
}

static void three_spheres_meet_in_two_corners(void **state)
{
	(void)state;
	const eskel_primitive three[] = {ellipsoid(5, 0, 0, 8, 8, 8), ellipsoid(-2.5, 5 * sqrt(0.75), 0, 8, 8, 8),
		ellipsoid(-2.5, -5 * sqrt(0.75), 0, 8, 8, 8)};
	eskel_mesh *mesh = make(three, 3, 0.5, 1);
	size_t corners = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const float *p = mesh->vertices[v];
		corners += hypotf(p[0], p[1]) < 1e-5f && fabsf(fabsf(p[2]) - sqrtf(39)) < 1e-5f;
	}
	assert_int_equal(corners, 2);
	const double expected = sum_volume(three, 3, -14, 14, 150);
	assert_true(fabs(eskel_mesh_volume(mesh) / expected - 1) < 3e-3);
	eskel_mesh_free(mesh);
}

/* ---- positions that are special */

static void what_lies_in_another_one_is_left_out(void **state)
{
	(void)state;
	const eskel_primitive four[] = {ellipsoid(1, 0, 0, 3, 3, 3), ellipsoid(0, 0, 0, 5, 5, 5),
		ellipsoid(0, 0, 0, 5, 5, 5), ellipsoid(2, 0, 0, 3, 3, 3)};
	eskel_mesh *mesh = make(four, 4, 0.7, 1), *one = make(&four[1], 1, 0.7, 1);
	assert_int_equal(mesh->triangle_count, one->triangle_count);
	assert_memory_equal(mesh->vertices, one->vertices, one->vertex_count * sizeof *one->vertices);
	eskel_mesh_free(mesh);
	eskel_mesh_free(one);
}

/* By several, but by no single one. */
static void what_lies_in_others_together_is_left_out(void **state)
{
	(void)state;
	const eskel_primitive three[] = {
		ellipsoid(0, 0, 0, 5, 1, 1), ellipsoid(-3, 0, 0, 4, 4, 4), ellipsoid(3, 0, 0, 4, 4, 4)};
	eskel_mesh *mesh = make(three, 3, 0.7, 1), *two = make(&three[1], 2, 0.7, 1);
	assert_int_equal(mesh->triangle_count, two->triangle_count);
	eskel_mesh_free(mesh);
	eskel_mesh_free(two);
}

static void pieces_apart_and_touching_are_all_there(void **state)
{
	(void)state;
	const eskel_primitive four[] = {ellipsoid(0, 0, 0, 5, 5, 5), ellipsoid(10, 0, 0, 5, 5, 5),
		ellipsoid(40, 0, 0, 5, 5, 5), ellipsoid(43, 0, 0, 5, 5, 5)};
	eskel_mesh_free(make(four, 4, 0.7, 3));
}

/* Two curves; and a torus, of four rods. */
static void ellipsoids_that_pass_through_one_another_are_cut_twice(void **state)
{
	(void)state;
	const eskel_primitive two[] = {ellipsoid(0, 0, 0, 10, 10, 2), ellipsoid(0, 0, 0, 2, 2, 10)};
	eskel_mesh_free(make(two, 2, 0.5, 1));
	const eskel_primitive rods[] = {ellipsoid(0, 10, 0, 14, 2, 2), ellipsoid(0, -10, 0, 14, 2, 2),
		ellipsoid(10, 0, 0, 2, 14, 2.2), ellipsoid(-10, 0, 0, 2, 14, 2.2)};
	eskel_mesh *mesh = make(rods, 4, 0.5, 1);
	eskel_mesh_check_result r;
	assert_int_equal(eskel_mesh_check(mesh, &r), ESKEL_OK);
	assert_int_equal(r.euler, 0);
	eskel_mesh_free(mesh);
}

/* A cap smaller than the step, and surfaces that are nearly the same. */
static void what_is_smaller_than_the_step_is_there(void **state)
{
	(void)state;
	const eskel_primitive cap[] = {ellipsoid(0, 0, 0, 10, 10, 10), ellipsoid(8.1, 0, 0, 2, 2, 2)};
	eskel_mesh *mesh = make(cap, 2, 2, 1);
	float farthest = 0;
	for (size_t v = 0; v < mesh->vertex_count; v++)
		farthest = fmaxf(farthest, mesh->vertices[v][0]);
	assert_true(farthest > 10.05f && farthest < 10.1001f);
	eskel_mesh_free(mesh);
	const eskel_primitive same[] = {ellipsoid(0, 0, 0, 5, 5, 5), ellipsoid(1e-3, 0, 0, 5, 5, 5)};
	eskel_mesh_free(make(same, 2, 0.7, 1));
}

/* Edges grow with the step up to the size of an ellipsoid, and shrink down to what is allowed. */
static void any_step_is_answered(void **state)
{
	(void)state;
	const eskel_primitive two[] = {ellipsoid(0, 0, 0, 5, 5, 5), ellipsoid(3, 0, 0, 5, 5, 6)};
	eskel_mesh *mesh = make(two, 2, 1e9, 1);
	assert_in_range(mesh->triangle_count, 20, 400);
	eskel_mesh_free(mesh);
	mesh = NULL;
	assert_int_equal(esk_union_mesh(two, 2, 1e-3, 1000000, &mesh), ESKEL_TOO_LARGE);
	assert_int_equal(esk_union_mesh(two, 2, 1e-300, SIZE_MAX, &mesh), ESKEL_TOO_LARGE);
	assert_int_equal(esk_union_mesh(two, 2, 0.5, 500, &mesh), ESKEL_TOO_LARGE);
	assert_null(mesh);
}

/* ---- many at once */

static void fill(uint64_t seed, double spread, eskel_primitive *primitives, uint32_t count)
{
	uint64_t random = seed;
	for (uint32_t i = 0; i < count; i++) {
		double numbers[6];
		for (int k = 0; k < 6; k++)
			numbers[k] = esk_random_uniform(&random);
		primitives[i] = ellipsoid((numbers[0] - 0.5) * spread, (numbers[1] - 0.5) * spread,
			(numbers[2] - 0.5) * spread, 1 + 9 * numbers[3], 1 + 9 * numbers[4], 1 + 9 * numbers[5]);
		skeletons_rotation(&random, primitives[i].axes);
	}
}

/* The volume is that of points on a grid. Where the step is too coarse for what creases do, it is refused: rarely. */
static void random_unions_are_whole(void **state)
{
	(void)state;
	static const uint32_t counts[] = {2, 3, 5, 9, 20, ESKEL_LEVELS_MAX};
	int refused = 0;
	for (uint64_t seed = 1; seed <= 24; seed++) {
		eskel_primitive primitives[ESKEL_LEVELS_MAX];
		const uint32_t count = counts[seed % 6];
		fill(seed, seed % 2 ? 25 : 8, primitives, count);
		eskel_mesh *mesh = NULL, *again = NULL;
		eskel_mesh_check_result r;
		const eskel_status status = esk_union_mesh(primitives, count, 0.8, SIZE_MAX, &mesh);
		refused += status == ESKEL_NUMERIC;
		if (status == ESKEL_NUMERIC)
			continue;
		assert_int_equal(status, ESKEL_OK);
		check(mesh, primitives, count, &r);
		const double expected = sum_volume(primitives, count, -23, 23, 46);
		if (fabs(eskel_mesh_volume(mesh) / expected - 1) > 0.05)
			fail_msg("%u at %d: %g mm^3, expected %g", count, (int)seed, eskel_mesh_volume(mesh), expected);
		assert_int_equal(esk_union_mesh(primitives, count, 0.8, SIZE_MAX, &again), ESKEL_OK);
		assert_memory_equal(mesh->vertices, again->vertices, mesh->vertex_count * sizeof *mesh->vertices);
		eskel_mesh_free(mesh);
		eskel_mesh_free(again);
	}
	printf("%d of 24 refused\n", refused);
	assert_in_range(refused, 0, 4);
}

/* A refused one is marched instead. */
static void every_union_has_a_mesh(void **state)
{
	(void)state;
	int marched = 0;
	for (uint64_t seed = 1; seed <= 25; seed++) {
		eskel_primitive primitives[30];
		fill(seed, 12, primitives, 30);
		eskel_surface *surface = compose(primitives, 30);
		eskel_mesh *mesh = NULL, *direct = NULL;
		marched += esk_union_mesh(primitives, 30, 2, SIZE_MAX, &direct) != ESKEL_OK;
		assert_int_equal(eskel_surface_mesh(surface, 2, 0, &mesh, NULL), ESKEL_OK);
		assert_true(!direct || direct->triangle_count == mesh->triangle_count);
		eskel_mesh_free(mesh);
		eskel_mesh_free(direct);
		eskel_surface_free(surface);
	}
	printf("%d of 25 marched\n", marched);
	assert_in_range(marched, 1, 10);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_ellipsoid_of_any_shape_has_its_volume),
		cmocka_unit_test(two_spheres_have_the_volume_of_their_lens_less),
		cmocka_unit_test(a_crease_is_the_circle_where_spheres_meet),
		cmocka_unit_test(three_spheres_meet_in_two_corners),
		cmocka_unit_test(what_lies_in_another_one_is_left_out),
		cmocka_unit_test(what_lies_in_others_together_is_left_out),
		cmocka_unit_test(pieces_apart_and_touching_are_all_there),
		cmocka_unit_test(ellipsoids_that_pass_through_one_another_are_cut_twice),
		cmocka_unit_test(what_is_smaller_than_the_step_is_there),
		cmocka_unit_test(any_step_is_answered),
		cmocka_unit_test(random_unions_are_whole),
		cmocka_unit_test(every_union_has_a_mesh),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
