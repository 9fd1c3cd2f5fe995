#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "fields.h"
#include "lattice.h"
#include "polygonise.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Within a cube about the origin. */
static esk_polygonise_options options_of(double step, double half, const double *seeds, size_t seed_count)
{
	return (esk_polygonise_options){.step = step,
		.least = {-half, -half, -half},
		.greatest = {half, half, half},
		.seeds = (const double(*)[3])seeds,
		.seed_count = seed_count};
}

static eskel_mesh *polygonise(const esk_field *field, const esk_polygonise_options *options)
{
	eskel_mesh *mesh = NULL;
	eskel_error error = {ESKEL_OK, ""};
	if (esk_polygonise(field, options, &mesh, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	return mesh;
}

static void assert_no_vertex_is_spare(const eskel_mesh *mesh)
{
	bool *used = calloc(mesh->vertex_count, sizeof *used);
	assert_non_null(used);
	for (size_t t = 0; t < mesh->triangle_count; t++)
		for (int c = 0; c < 3; c++)
			used[mesh->triangles[t][c]] = true;
	for (size_t v = 0; v < mesh->vertex_count; v++)
		assert_true(used[v]);
	free(used);
}

static eskel_mesh_check_result check(const eskel_mesh *mesh)
{
	eskel_mesh_check_result r;
	assert_int_equal(eskel_mesh_check(mesh, &r), ESKEL_OK);
	if (!r.is_manifold)
		fail_msg("%zu boundary edges, %zu crowded edges, %zu crowded vertices, %zu turned edges",
			r.boundary_edges, r.crowded_edges, r.crowded_vertices, r.turned_edges);
	assert_no_vertex_is_spare(mesh);
	return r;
}

static void assert_near(double value, double expected, double tolerance)
{
	if (!(fabs(value - expected) <= tolerance))
		fail_msg("%.9g, expected %.9g to %.3g", value, expected, tolerance);
}

/* The largest distance of vertices from the surface, to first order, and of normals from its normals. */
static void assert_on_surface(const esk_field *field, const eskel_mesh *mesh, double tolerance)
{
	for (size_t v = 0; v < mesh->vertex_count; v++) {
		const float *p = mesh->vertices[v], *n = mesh->normals[v];
		double g[3];
		const double value = field->gradient(field->context, (const double[3]){p[0], p[1], p[2]}, g);
		const double length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
		assert_near(value / length, 0, tolerance);
		for (int a = 0; a < 3; a++)
			assert_near(n[a], g[a] / length, 1e-3);
	}
}

static void a_torus_converges_in_second_order(void **state)
{
	(void)state;
	const torus t = {10, 3};
	const esk_field field = fields_torus(&t);
	const double seed[3] = {10, 0, 0}, area = 4 * pi * pi * 30, volume = 2 * pi * pi * 90;
	double last[2] = {0, 0};
	for (double step = 1; step > 0.1; step /= 2) {
		const esk_polygonise_options options = options_of(step, 14, seed, 1);
		eskel_mesh *mesh = polygonise(&field, &options);
		const eskel_mesh_check_result r = check(mesh);
		assert_int_equal(r.components, 1);
		assert_int_equal(r.euler, 0);
		assert_true(r.least_angle > 18);
		assert_on_surface(&field, mesh, 2e-3 * step);
		const double errors[2] = {area - eskel_mesh_area(mesh), volume - eskel_mesh_volume(mesh)};
		for (int e = 0; e < 2; e++) {
			if (last[e] != 0)
				assert_near(log2(last[e] / errors[e]), 2, 0.3);
			last[e] = errors[e];
		}
		eskel_mesh_free(mesh);
	}
	assert_near(last[1] / volume, 0, 1e-3);
}

static void slivers_there_are_none_on_smooth_surfaces(void **state)
{
	(void)state;
	uint64_t random = 1;
	for (int trial = 0; trial < 60; trial++) {
		ellipsoids one = {.count = 1};
		for (int a = 0; a < 3; a++) {
			one.items[0].centre[a] = synthetic_uniform(&random);
			one.items[0].radii[a] = 6 + 6 * synthetic_uniform(&random);
		}
		const esk_field field = fields_blend(&one);
		const esk_polygonise_options options = options_of(0.9, 14, one.items[0].centre, 1);
		eskel_mesh *mesh = polygonise(&field, &options);
		const eskel_mesh_check_result r = check(mesh);
		assert_int_equal(r.euler, 2);
		if (r.least_angle < 15)
			fail_msg("%g degrees in trial %d", r.least_angle, trial);
		eskel_mesh_free(mesh);
	}
}

static void every_piece_with_a_seed_is_found_and_scans_find_the_others(void **state)
{
	(void)state;
	const ellipsoids three = {3, {{{-8, 0, 0}, {4, 3, 3}}, {{8, 0, 0}, {3, 3, 3}}, {{0, 9, 2}, {2, 3, 4}}}};
	double seeds[3][3];
	for (int i = 0; i < 3; i++)
		memcpy(seeds[i], three.items[i].centre, sizeof seeds[i]);
	const esk_field field = fields_union(&three);
	esk_polygonise_options options = options_of(0.5, 14, seeds[0], 3);
	for (size_t count = 1; count <= 3; count++) {
		options.seed_count = count;
		eskel_mesh *mesh = polygonise(&field, &options);
		assert_int_equal(check(mesh).components, count);
		eskel_mesh_free(mesh);
	}
	options.scan = true;
	options.seed_count = 0;
	eskel_mesh *mesh = polygonise(&field, &options);
	assert_int_equal(check(mesh).components, 3);
	assert_near(eskel_mesh_volume(mesh) / (4 * pi / 3 * (36 + 27 + 24)), 1, 0.02);
	eskel_mesh_free(mesh);
}

/* |p|^2 - 9 times |p|^2 - 81: a ball with a cavity. */
static double shell_gradient(const void *context, const double p[3], double g[3])
{
	(void)context;
	const double square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
	for (int a = 0; a < 3; a++)
		g[a] = 2 * p[a] * (2 * square - 90);
	return (square - 9) * (square - 81);
}

static void shell_values(const void *context, size_t count, const double (*points)[3], double *values)
{
	double g[3];
	for (size_t i = 0; i < count; i++)
		values[i] = shell_gradient(context, points[i], g);
}

static void cavities_above_a_seed_are_found_with_what_lies_beyond(void **state)
{
	(void)state;
	const esk_field field = {.values = shell_values, .gradient = shell_gradient};
	const double seed[3] = {0.5, 0, -6};
	const esk_polygonise_options options = options_of(0.4, 10, seed, 1);
	eskel_mesh *mesh = polygonise(&field, &options);
	assert_int_equal(check(mesh).components, 2);
	assert_near(eskel_mesh_volume(mesh) / (4 * pi / 3 * (729 - 27)), 1, 0.01);
	assert_on_surface(&field, mesh, 1e-3);
	eskel_mesh_free(mesh);
}

static void the_order_of_seeds_changes_nothing(void **state)
{
	(void)state;
	ellipsoids ten;
	fields_ten(&ten);
	const esk_field field = fields_blend(&ten);
	double seeds[10][3];
	eskel_mesh *meshes[2];
	for (int turn = 0; turn < 2; turn++) {
		for (int i = 0; i < 10; i++)
			memcpy(seeds[i], ten.items[turn ? (7 * i + 3) % 10 : i].centre, sizeof seeds[i]);
		const esk_polygonise_options options = options_of(2, 80, seeds[0], 10);
		meshes[turn] = polygonise(&field, &options);
		check(meshes[turn]);
	}
	const eskel_mesh *a = meshes[0], *b = meshes[1];
	assert_int_equal(a->vertex_count, b->vertex_count);
	assert_int_equal(a->triangle_count, b->triangle_count);
	assert_memory_equal(a->vertices, b->vertices, a->vertex_count * sizeof *a->vertices);
	assert_memory_equal(a->normals, b->normals, a->vertex_count * sizeof *a->normals);
	assert_memory_equal(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles);
	eskel_mesh_free(meshes[0]);
	eskel_mesh_free(meshes[1]);
}

/* Another value at each point, out of few, so that 0 is frequent: nothing that a surface can do is left out. */
static double noise_gradient(const void *context, const double p[3], double g[3])
{
	uint64_t random = *(const uint64_t *)context;
	const uint64_t levels = random % 3 ? 5 : 1000001;
	for (int a = 0; a < 3; a++) {
		random += (uint64_t)lrint(p[a] * 1000 + 100000);
		random = synthetic_random(&random);
		g[a] = 0;
	}
	if (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] > 36)
		return 1;
	return (double)(random % levels) - (double)(levels / 2);
}

static void noise_values(const void *context, size_t count, const double (*points)[3], double *values)
{
	double g[3];
	for (size_t i = 0; i < count; i++)
		values[i] = noise_gradient(context, points[i], g);
}

static void noise_gives_a_closed_manifold_too(void **state)
{
	(void)state;
	const double seed[3] = {0, 0, 0};
	for (uint64_t n = 0; n < 30; n++) {
		const esk_field field = {.context = &n, .values = noise_values, .gradient = noise_gradient};
		const esk_polygonise_options options = options_of(n % 2 ? 0.7 : 2, 10, seed, 1);
		eskel_mesh *mesh = polygonise(&field, &options);
		check(mesh);
		for (size_t v = 0; v < mesh->vertex_count; v++)
			assert_near(
				hypot(hypot(mesh->normals[v][0], mesh->normals[v][1]), mesh->normals[v][2]), 1, 1e-5);
		eskel_mesh_free(mesh);
	}
}

/* A cube whose faces lie in nodes of the lattice, which is about the origin. */
static double box_gradient(const void *context, const double p[3], double g[3])
{
	const double half = *(const double *)context;
	int most = 0;
	for (int a = 1; a < 3; a++)
		if (fabs(p[a]) > fabs(p[most]))
			most = a;
	for (int a = 0; a < 3; a++)
		g[a] = a == most ? (p[a] < 0 ? -1 : 1) : 0;
	return fabs(p[most]) - half;
}

static void box_values(const void *context, size_t count, const double (*points)[3], double *values)
{
	double g[3];
	for (size_t i = 0; i < count; i++)
		values[i] = box_gradient(context, points[i], g);
}

static void a_surface_through_nodes_is_met_exactly(void **state)
{
	(void)state;
	const double seed[3] = {0, 0, 0}, side = 0.5 * cbrt(2);
	for (int n = 1; n < 12; n++) {
		const double half = side * n / 2;
		const esk_field field = {.context = &half, .values = box_values, .gradient = box_gradient};
		const esk_polygonise_options options = options_of(0.5, 5, seed, 1);
		eskel_mesh *mesh = polygonise(&field, &options);
		assert_int_equal(check(mesh).euler, 2);
		for (size_t v = 0; v < mesh->vertex_count; v++) {
			const float *p = mesh->vertices[v];
			assert_near(fmax(fmax(fabsf(p[0]), fabsf(p[1])), fabsf(p[2])), half, 1e-5);
		}
		eskel_mesh_free(mesh);
	}
}

/* Plates thinner than the step come out with holes, or not at all, and closed. */
static void thin_parts_stay_closed(void **state)
{
	(void)state;
	for (double thickness = 2; thickness > 0.05; thickness *= 0.8) {
		const ellipsoids one = {1, {{{0.1, 0.2, 0.3}, {10, 9, thickness}}}};
		const esk_field field = fields_blend(&one);
		const esk_polygonise_options options = options_of(1, 12, one.items[0].centre, 1);
		eskel_mesh *mesh = NULL;
		const eskel_status status = esk_polygonise(&field, &options, &mesh, NULL);
		if (status == ESKEL_OK)
			check(mesh);
		else
			assert_int_equal(status, ESKEL_EMPTY);
		eskel_mesh_free(mesh);
	}
}

static void what_is_too_large_is_refused_with_a_step_that_is_not(void **state)
{
	(void)state;
	const ellipsoids one = {1, {{{0, 0, 0}, {10, 10, 10}}}};
	const esk_field field = fields_blend(&one);
	esk_polygonise_options options = options_of(0.01, 12, one.items[0].centre, 1);
	options.triangles_max = 10000;
	eskel_mesh *mesh = NULL;
	eskel_error error;
	assert_int_equal(esk_polygonise(&field, &options, &mesh, &error), ESKEL_TOO_LARGE);
	assert_null(mesh);
	const char *step = strstr(error.text, "at least ");
	assert_non_null(step);
	options.step = strtod(step + strlen("at least "), NULL);
	mesh = polygonise(&field, &options);
	assert_in_range(mesh->triangle_count, 5000, 10000);
	eskel_mesh_free(mesh);
}

static void options_out_of_range_are_refused(void **state)
{
	(void)state;
	const ellipsoids one = {1, {{{0, 0, 0}, {10, 10, 10}}}};
	const esk_field field = fields_blend(&one);
	const double outside[3] = {20, 0, 0}, nowhere[3] = {NAN, 0, 0};
	const struct {
		double step, half;
		const double *seeds;
		eskel_status status;
	} cases[] = {
		{0, 12, one.items[0].centre, ESKEL_INVALID},
		{NAN, 12, one.items[0].centre, ESKEL_INVALID},
		{1, 0, one.items[0].centre, ESKEL_INVALID},
		{1, NAN, one.items[0].centre, ESKEL_INVALID},
		{1e-6, 12, one.items[0].centre, ESKEL_TOO_LARGE},
		{1, 8, one.items[0].centre, ESKEL_TOO_LARGE},
		{1, 12, outside, ESKEL_INVALID},
		{1, 12, nowhere, ESKEL_INVALID},
		{1, 12, NULL, ESKEL_EMPTY},
	};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		const esk_polygonise_options options =
			options_of(cases[c].step, cases[c].half, cases[c].seeds, cases[c].seeds ? 1 : 0);
		eskel_mesh *mesh = NULL;
		eskel_error error = {ESKEL_OK, ""};
		assert_int_equal(esk_polygonise(&field, &options, &mesh, &error), cases[c].status);
		assert_int_equal(error.status, cases[c].status);
		assert_null(mesh);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_torus_converges_in_second_order),
		cmocka_unit_test(slivers_there_are_none_on_smooth_surfaces),
		cmocka_unit_test(every_piece_with_a_seed_is_found_and_scans_find_the_others),
		cmocka_unit_test(cavities_above_a_seed_are_found_with_what_lies_beyond),
		cmocka_unit_test(the_order_of_seeds_changes_nothing),
		cmocka_unit_test(noise_gives_a_closed_manifold_too),
		cmocka_unit_test(a_surface_through_nodes_is_met_exactly),
		cmocka_unit_test(thin_parts_stay_closed),
		cmocka_unit_test(what_is_too_large_is_refused_with_a_step_that_is_not),
		cmocka_unit_test(options_out_of_range_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
