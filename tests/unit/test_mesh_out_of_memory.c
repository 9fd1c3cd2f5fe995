/* Lets the nth allocation fail, for n = 1, 2, 3 ..., in all that makes a mesh: as test_out_of_memory.c.
 * What meshoptimizer itself allocates is not among them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "failing_allocations.h"
#include "fields.h"
#include "polygonise.h"

#include <stdlib.h>

static eskel_status polygonise(eskel_mesh **mesh)
{
	const torus t = {10, 3};
	const esk_field field = fields_torus(&t);
	const double seed[1][3] = {{10, 0, 0}};
	const esk_polygonise_options options = {.step = 0.7,
		.least = {-14, -14, -4},
		.greatest = {14, 14, 4},
		.seeds = (const double(*)[3])seed,
		.seed_count = 1,
		.scan = true};
	eskel_error error = {ESKEL_OK, ""};
	const eskel_status status = esk_polygonise(&field, &options, mesh, &error);
	assert_int_equal(status, error.status);
	return status;
}

static eskel_status refuse(eskel_mesh **mesh)
{
	const ellipsoids one = {1, {{{0, 0, 0}, {10, 10, 10}}}};
	const esk_field field = fields_blend(&one);
	const esk_polygonise_options options = {.step = 0.5,
		.least = {-12, -12, -12},
		.greatest = {12, 12, 12},
		.seeds = &one.items[0].centre,
		.seed_count = 1,
		.triangles_max = 1000};
	eskel_error error = {ESKEL_OK, ""};
	const eskel_status status = esk_polygonise(&field, &options, mesh, &error);
	assert_int_equal(status, error.status);
	return status == ESKEL_TOO_LARGE ? ESKEL_OK : status;
}

static eskel_status simplify(eskel_mesh **mesh)
{
	eskel_mesh *fine = NULL;
	double error;
	eskel_status status = polygonise(&fine);
	if (status == ESKEL_OK)
		status = eskel_mesh_reorder(fine);
	if (status == ESKEL_OK)
		status = eskel_mesh_simplify(fine, &(eskel_simplify_options){.triangles = 500}, mesh, &error);
	eskel_mesh_free(fine);
	return status;
}

/* Of four, with corners. */
static eskel_status unite(eskel_mesh **mesh)
{
	eskel_primitive primitives[4];
	for (int i = 0; i < 4; i++)
		primitives[i] = (eskel_primitive){.centre = {i % 2 * 5, i / 2 * 6, 0},
			.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
			.radii = {5, 6, 7 + i},
			.exponents = {1, 1},
			.alpha = 1};
	eskel_surface *surface = NULL;
	eskel_status status = eskel_surface_compose(primitives, 4, ESKEL_COMPOSE_UNION, &surface);
	if (status == ESKEL_OK)
		status = eskel_surface_mesh(surface, 1, 0, mesh, NULL);
	eskel_surface_free(surface);
	return status;
}

static eskel_status make_voxels(eskel_mesh **mesh)
{
	eskel_run runs[] = {{0, 3, 0, 0}, {2, 5, 1, 0}, {1, 2, 1, 1}};
	const eskel_cloud cloud = {.affine = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
		.voxels = 10,
		.weight = 10,
		.extent = {6, 2, 2},
		.run_count = 3,
		.runs = runs};
	return eskel_cloud_mesh(&cloud, mesh, NULL);
}

static void every_failed_allocation_is_reported_and_leaks_nothing(void **state)
{
	(void)state;
	eskel_status (*const makers[])(eskel_mesh **) = {polygonise, refuse, simplify, unite, make_voxels};
	for (size_t m = 0; m < sizeof makers / sizeof *makers; m++) {
		int failures = 0;
		for (bool failed = true; failed && failures < 1000; failures++) {
			eskel_mesh *mesh = NULL;
			failing_allocations_begin(failures);
			const eskel_status status = makers[m](&mesh);
			failed = failing_allocations_end();
			assert_int_equal(status, failed ? ESKEL_NO_MEMORY : ESKEL_OK);
			assert_true(!failed || mesh == NULL);
			eskel_mesh_free(mesh);
		}
		assert_in_range(failures, 10, 999);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_failed_allocation_is_reported_and_leaks_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
