#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "fields.h"
#include "mesh.h"
#include "polygonise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const torus ring = {10, 3};

static eskel_mesh *make_torus(void)
{
	const esk_field field = fields_torus(&ring);
	const double seed[1][3] = {{10, 0, 0}};
	const esk_polygonise_options options = {.step = 0.5,
		.least = {-14, -14, -4},
		.greatest = {14, 14, 4},
		.seeds = (const double(*)[3])seed,
		.seed_count = 1};
	eskel_mesh *mesh = NULL;
	assert_int_equal(esk_polygonise(&field, &options, &mesh, NULL), ESKEL_OK);
	return mesh;
}

static void a_simplified_mesh_is_a_manifold_near_to_the_surface(void **state)
{
	(void)state;
	eskel_mesh *mesh = make_torus();
	size_t last = mesh->triangle_count;
	for (double most = 0.01; most < 2; most *= 4) {
		eskel_mesh *simple = NULL;
		double error = -1;
		const eskel_simplify_options options = {.error = most};
		assert_int_equal(eskel_mesh_simplify(mesh, &options, &simple, &error), ESKEL_OK);
		eskel_mesh_check_result r;
		assert_int_equal(eskel_mesh_check(simple, &r), ESKEL_OK);
		assert_true(r.is_manifold);
		assert_int_equal(r.euler, 0);
		assert_true(error >= 0 && error <= most * 1.001);
		assert_true(simple->triangle_count < last);
		last = simple->triangle_count;
		const double volume = eskel_mesh_volume(mesh);
		assert_true(fabs(eskel_mesh_volume(simple) - volume) <= 2 * most * eskel_mesh_area(mesh));
		eskel_mesh_free(simple);
	}
	eskel_mesh_free(mesh);
}

static void a_number_of_triangles_is_reached(void **state)
{
	(void)state;
	eskel_mesh *mesh = make_torus(), *simple = NULL;
	double error;
	assert_int_equal(
		eskel_mesh_simplify(mesh, &(eskel_simplify_options){.triangles = 1000}, &simple, &error), ESKEL_OK);
	assert_in_range(simple->triangle_count, 900, 1000);
	eskel_mesh_free(simple);
	simple = NULL;
	assert_int_equal(
		eskel_mesh_simplify(mesh, &(eskel_simplify_options){.error = -1}, &simple, &error), ESKEL_INVALID);
	assert_null(simple);
	eskel_mesh_free(mesh);
}

/* Nothing can be taken from it, and it is as closed as any. */
static void a_mesh_without_triangles_stays_so(void **state)
{
	(void)state;
	eskel_mesh *empty = esk_mesh_new(0, 0), *simple = NULL;
	double error = -1;
	assert_non_null(empty);
	const eskel_simplify_options options = {.triangles = 10};
	assert_int_equal(eskel_mesh_simplify(empty, &options, &simple, &error), ESKEL_OK);
	assert_int_equal(simple->triangle_count, 0);
	assert_true(error == 0);
	eskel_mesh_free(simple);
	eskel_mesh_free(empty);
}

static void a_reordered_mesh_is_the_same(void **state)
{
	(void)state;
	eskel_mesh *mesh = make_torus();
	const double volume = eskel_mesh_volume(mesh), area = eskel_mesh_area(mesh);
	const size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
	assert_int_equal(eskel_mesh_reorder(mesh), ESKEL_OK);
	eskel_mesh_check_result r;
	assert_int_equal(eskel_mesh_check(mesh, &r), ESKEL_OK);
	assert_true(r.is_manifold && r.euler == 0);
	assert_int_equal(mesh->vertex_count, vertices);
	assert_int_equal(mesh->triangle_count, triangles);
	assert_true(fabs(eskel_mesh_volume(mesh) - volume) < 1e-6 * volume);
	assert_true(fabs(eskel_mesh_area(mesh) - area) < 1e-6 * area);
	/* The first triangles need the first vertices. */
	assert_true(mesh->triangles[0][0] == 0 && mesh->triangles[0][1] == 1 && mesh->triangles[0][2] == 2);
	eskel_mesh_free(mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_simplified_mesh_is_a_manifold_near_to_the_surface),
		cmocka_unit_test(a_number_of_triangles_is_reached),
		cmocka_unit_test(a_mesh_without_triangles_stays_so),
		cmocka_unit_test(a_reordered_mesh_is_the_same),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
