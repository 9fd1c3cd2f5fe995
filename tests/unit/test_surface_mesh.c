/* Meshes of composed surfaces. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"

#include <math.h>

static eskel_primitive ellipsoid(double x, double a, double b, double c)
{
	return (eskel_primitive){.centre = {x, 0, 0},
		.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
		.radii = {a, b, c},
		.exponents = {1, 1},
		.alpha = 1};
}

static eskel_surface *compose(const eskel_primitive *primitives, uint32_t count, eskel_compose kind)
{
	eskel_surface *surface = NULL;
	assert_int_equal(eskel_surface_compose(primitives, count, kind, &surface), ESKEL_OK);
	return surface;
}

static eskel_mesh *mesh_of(const eskel_surface *surface, double step, size_t pieces)
{
	eskel_mesh *mesh = NULL;
	eskel_error error = {0};
	eskel_mesh_check_result check;
	if (eskel_surface_mesh(surface, step, 0, &mesh, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	assert_int_equal(eskel_mesh_check(mesh, &check), ESKEL_OK);
	assert_true(check.is_manifold);
	assert_int_equal(check.components, pieces);
	for (size_t i = 0; i < mesh->vertex_count; i++) {
		const double point[3] = {mesh->vertices[i][0], mesh->vertices[i][1], mesh->vertices[i][2]};
		assert_true(fabs(eskel_surface_distance(surface, point, NULL)) < 1e-2 * step);
	}
	return mesh;
}

static void an_ellipsoid_has_its_volume(void **state)
{
	(void)state;
	const eskel_primitive one = ellipsoid(5, 4, 6, 20);
	eskel_surface *surface = compose(&one, 1, ESKEL_COMPOSE_BLEND);
	eskel_mesh *mesh = mesh_of(surface, 0.5, 1);
	const double expected = 4 * acos(-1) / 3 * 4 * 6 * 20;
	assert_true(fabs(eskel_mesh_volume(mesh) / expected - 1) < 0.01);
	eskel_mesh_free(mesh);
	eskel_surface_free(surface);
}

static void pieces_apart_are_all_there(void **state)
{
	(void)state;
	const eskel_primitive three[] = {ellipsoid(0, 5, 5, 5), ellipsoid(100, 5, 5, 5), ellipsoid(105, 5, 5, 5)};
	for (eskel_compose kind = ESKEL_COMPOSE_BLEND; kind <= ESKEL_COMPOSE_UNION; kind++) {
		eskel_surface *surface = compose(three, 3, kind);
		eskel_mesh_free(mesh_of(surface, 0.7, 2));
		eskel_surface_free(surface);
	}
}

/* The farther a blend reaches beyond its ellipsoids, the smaller alpha is: the box must know. */
static void a_blend_far_beyond_its_ellipsoids_is_whole(void **state)
{
	(void)state;
	eskel_primitive two[] = {ellipsoid(0, 1, 1, 1), ellipsoid(1, 1, 1, 1)};
	two[0].alpha = two[1].alpha = 0.01;
	eskel_surface *surface = compose(two, 2, ESKEL_COMPOSE_BLEND);
	eskel_mesh_free(mesh_of(surface, 0.5, 1));
	eskel_surface_free(surface);
}

static void a_deformed_superquadric_is_whole(void **state)
{
	(void)state;
	eskel_primitive one = ellipsoid(0, 3, 4, 15);
	one.kind = ESKEL_PRIMITIVE_DEFORMED;
	one.exponents[0] = 0.3;
	one.exponents[1] = 1.6;
	one.modes[ESKEL_MODE_TAPER_X] = 0.8;
	one.modes[ESKEL_MODE_BEND_Y] = 1;
	one.modes[ESKEL_MODE_TWIST] = -1;
	eskel_surface *surface = compose(&one, 1, ESKEL_COMPOSE_BLEND);
	eskel_mesh_free(mesh_of(surface, 0.25, 1));
	eskel_surface_free(surface);
}

static void what_cannot_be_meshed_is_refused(void **state)
{
	(void)state;
	const eskel_primitive one = ellipsoid(0.3, 4, 6, 20);
	eskel_surface *surface = compose(&one, 1, ESKEL_COMPOSE_BLEND);
	eskel_mesh *mesh = NULL;
	eskel_error error;
	assert_int_equal(eskel_surface_mesh(surface, 0, 0, &mesh, &error), ESKEL_INVALID);
	assert_int_equal(eskel_surface_mesh(surface, NAN, 0, &mesh, NULL), ESKEL_INVALID);
	assert_int_equal(eskel_surface_mesh(surface, 0.1, 1000, &mesh, &error), ESKEL_TOO_LARGE);
	assert_null(mesh);
	eskel_surface_free(surface);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_ellipsoid_has_its_volume),
		cmocka_unit_test(pieces_apart_are_all_there),
		cmocka_unit_test(a_blend_far_beyond_its_ellipsoids_is_whole),
		cmocka_unit_test(a_deformed_superquadric_is_whole),
		cmocka_unit_test(what_cannot_be_meshed_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
