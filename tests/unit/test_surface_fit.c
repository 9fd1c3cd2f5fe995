#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "joint_fit.h"
#include "normal_equations.h"
#include "shapes.h"
#include "surface.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
	eskel_cloud *cloud;
	eskel_skeleton *skeleton;
	esk_boundary *boundary;
	esk_fit_points *points;
} fixture;

static fixture make_fixture(eskel_cloud *cloud, uint32_t levels, size_t points)
{
	fixture f = {.cloud = cloud};
	const eskel_skeleton_options options = {.levels = levels};
	assert_int_equal(eskel_skeleton_new(cloud, &options, &f.skeleton, NULL), ESKEL_OK);
	assert_int_equal(esk_boundary_new(cloud, &f.boundary, NULL), ESKEL_OK);
	assert_int_equal(esk_fit_points_new(f.boundary, points, &f.points), ESKEL_OK);
	return f;
}

static void clear_fixture(fixture *f)
{
	esk_fit_points_free(f->points);
	esk_boundary_free(f->boundary);
	eskel_skeleton_free(f->skeleton);
	eskel_cloud_free(f->cloud);
}

/* The hamate's formula at about 5,000 voxels. */
static eskel_cloud *small_hamate(const eskel_affine *affine)
{
	shapes_solid solid = shapes_hamate;
	solid.scale = 0.6;
	return shapes_cloud(&solid, affine);
}

/* A level's ellipsoids with every parameter moved a little. */
static void deform(const eskel_surface *plain, eskel_primitive *primitives)
{
	uint64_t seed = 17;
	for (uint32_t i = 0; i < eskel_surface_count(plain); i++) {
		double step[ESK_PARAMETERS_ALL];
		for (size_t p = 0; p < ESK_PARAMETERS_ALL; p++)
			step[p] = 0.2 * (synthetic_uniform(&seed) - 0.5);
		esk_primitive_step(eskel_surface_primitive(plain, i), step, ESK_PARAMETERS_ALL, &primitives[i]);
	}
}

static const double length = 2; /* mm, at which residuals saturate */

enum { CLASSES = 3, ALL = CLASSES * ESK_PARAMETERS_ALL };

static double measure_stepped(
	esk_normal_equations *e, const eskel_primitive *primitives, size_t parameter, double by, esk_composition *c)
{
	eskel_primitive moved[CLASSES];
	double step[ESK_PARAMETERS_ALL] = {0};
	memcpy(moved, primitives, sizeof moved);
	step[parameter % ESK_PARAMETERS_ALL] = by;
	esk_primitive_step(&moved[parameter / ESK_PARAMETERS_ALL], step, ESK_PARAMETERS_ALL,
		&moved[parameter / ESK_PARAMETERS_ALL]);
	esk_composition_make(moved, CLASSES, ESKEL_COMPOSE_BLEND, c);
	return esk_normal_equations_measure(e, c, length);
}

/* Column p of the Jacobian, by differences of residuals. */
static void differentiate(const fixture *f, esk_normal_equations *e, const eskel_primitive *primitives, size_t p,
	double *column, esk_composition *c)
{
	const double by = 1e-5;
	const size_t count = f->points->group_count * ESK_LANES;
	for (int side = -1; side <= 1; side += 2) {
		measure_stepped(e, primitives, p, side * by, c);
		for (size_t i = 0; i < count; i++) {
			const double r = esk_normal_equations_residuals(e, i / ESK_LANES)[i % ESK_LANES];
			const double weight = sqrt(f->points->groups[i / ESK_LANES].weights[i % ESK_LANES]);
			column[i] = (side < 0 ? 0 : column[i]) + side * weight * r / (2 * by);
		}
	}
}

static void the_normal_equations_are_those_of_differences(void **state)
{
	(void)state;
	fixture f = make_fixture(small_hamate(&shapes_identity), CLASSES, 200);
	const eskel_surface_options deformed = {.primitive = ESKEL_PRIMITIVE_DEFORMED};
	eskel_surface *plain = NULL;
	esk_normal_equations *e = NULL;
	static esk_composition c;
	static double matrix[ALL * ALL], vector[ALL];
	eskel_primitive primitives[CLASSES];
	const size_t count = f.points->group_count * ESK_LANES;
	double *columns = calloc(ALL * count, sizeof *columns);
	assert_non_null(columns);
	assert_int_equal(eskel_surface_new(f.skeleton, CLASSES, &deformed, &plain), ESKEL_OK);
	deform(plain, primitives);
	assert_int_equal(esk_normal_equations_new(f.points, CLASSES, ESK_PARAMETERS_ALL, NULL, &e), ESKEL_OK);
	for (size_t p = 0; p < ALL; p++)
		differentiate(&f, e, primitives, p, columns + p * count, &c);
	measure_stepped(e, primitives, 0, 0, &c);
	esk_normal_equations_derive(e, ESK_PARAMETERS_ALL, matrix, vector);
	for (size_t p = 0; p < ALL; p++) {
		double sum = 0, squares[2] = {0};
		for (size_t i = 0; i < count; i++) {
			const double weight = f.points->groups[i / ESK_LANES].weights[i % ESK_LANES];
			const double r = sqrt(weight) * esk_normal_equations_residuals(e, i / ESK_LANES)[i % ESK_LANES];
			sum += columns[p * count + i] * r;
			squares[0] += columns[p * count + i] * columns[p * count + i];
			squares[1] += r * r;
		}
		if (fabs(vector[p] - sum) > 2e-3 * sqrt(squares[0] * squares[1]) + 1e-9)
			fail_msg("parameter %zu: %g, by differences %g", p, vector[p], sum);
	}
	for (size_t p = 0; p < ALL; p++)
		for (size_t q = p; q < ALL; q++) {
			double sum = 0, squares[2] = {0};
			for (size_t i = 0; i < count; i++) {
				sum += columns[p * count + i] * columns[q * count + i];
				squares[0] += columns[p * count + i] * columns[p * count + i];
				squares[1] += columns[q * count + i] * columns[q * count + i];
			}
			/* Hinges that close within the difference, and classes of little weight, are left out. */
			if (fabs(matrix[p * ALL + q] - sum) > 2e-3 * sqrt(squares[0] * squares[1]) + 1e-9)
				fail_msg("parameters %zu and %zu: %g, by differences %g", p, q, matrix[p * ALL + q],
					sum);
		}
	esk_normal_equations_free(e);
	eskel_surface_free(plain);
	free(columns);
	clear_fixture(&f);
}

static eskel_cloud *cloud_of_surface(const eskel_surface *surface, unsigned side)
{
	eskel_cloud *cloud = NULL;
	size_t count = 0;
	eskel_run *runs = calloc((size_t)side * side * side, sizeof *runs);
	assert_non_null(runs);
	for (unsigned i = 0; i < side * side * side; i++) {
		const unsigned x = i % side, y = i / side % side, z = i / side / side;
		const double point[3] = {x, y, z};
		if (eskel_surface_contains(surface, point))
			runs[count++] = (eskel_run){(uint16_t)x, (uint16_t)x, (uint16_t)y, (uint16_t)z};
	}
	assert_int_equal(eskel_cloud_new(runs, NULL, count, &shapes_identity, &cloud, NULL), ESKEL_OK);
	free(runs);
	return cloud;
}

static void a_superquadric_is_found_again(void **state)
{
	(void)state;
	eskel_primitive made = {.kind = ESKEL_PRIMITIVE_DEFORMED,
		.centre = {24, 24, 30},
		.axes = {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}},
		.radii = {9, 14, 24},
		.exponents = {0.5, 0.7},
		.alpha = 1};
	made.modes[ESKEL_MODE_TAPER_X] = 0.4;
	made.modes[ESKEL_MODE_BEND_Y] = 0.2;
	eskel_surface *surface = NULL;
	assert_int_equal(eskel_surface_compose(&made, 1, ESKEL_COMPOSE_BLEND, &surface), ESKEL_OK);
	fixture f = make_fixture(cloud_of_surface(surface, 60), 1, 100);
	const eskel_fit_options options = {.freedom = ESKEL_FIT_DEFORMED_SIMPLY, .boundary_points = 4000};
	eskel_reconstruction *r = NULL;
	assert_int_equal(eskel_surface_fit(f.cloud, f.skeleton, 1, &options, &r, NULL), ESKEL_OK);
	const eskel_primitive *found = eskel_surface_primitive(r->surface, 0);
	/* x and y may have changed places, and signs. */
	double radii[2] = {fmin(found->radii[0], found->radii[1]), fmax(found->radii[0], found->radii[1])};
	for (int i = 0; i < 2; i++)
		if (fabs(radii[i] - made.radii[i]) > 0.3 || fabs(found->exponents[i] - made.exponents[i]) > 0.05)
			fail_msg("radius %g for %g, exponent %g for %g", radii[i], made.radii[i], found->exponents[i],
				made.exponents[i]);
	assert_true(fabs(found->radii[2] - 24) < 0.4);
	if (r->after.mean_error > 0.21 || r->after.dice < 0.985)
		fail_msg("e_me %g mm, Dice %g", r->after.mean_error, r->after.dice);
	eskel_reconstruction_free(r);
	eskel_surface_free(surface);
	clear_fixture(&f);
}

static eskel_reconstruction *fit(const fixture *f, uint32_t level, const eskel_fit_options *options)
{
	eskel_reconstruction *r = NULL;
	eskel_error error = {0};
	if (eskel_surface_fit(f->cloud, f->skeleton, level, options, &r, &error))
		fail_msg("%s", error.text);
	return r;
}

static void every_method_gains_and_the_joint_fit_most(void **state)
{
	(void)state;
	fixture f = make_fixture(small_hamate(&shapes_identity), 5, 100);
	const eskel_fit_options joint = {.boundary_points = 600},
				tabu = {.method = ESKEL_FIT_TABU, .boundary_points = 600};
	eskel_reconstruction *a = fit(&f, 5, &joint), *b = fit(&f, 5, &tabu);
	print_message("e_me %.3f, joint %.3f, tabu %.3f; Dice %.3f, %.3f, %.3f\n", a->before.mean_error,
		a->after.mean_error, b->after.mean_error, a->before.dice, a->after.dice, b->after.dice);
	assert_true(a->after.mean_error < a->before.mean_error / 2 && a->after.dice > a->before.dice);
	assert_true(a->after.mean_error < b->after.mean_error);
	eskel_reconstruction_free(a);
	eskel_reconstruction_free(b);
	clear_fixture(&f);
}

static void fits_of_mirrored_and_moved_shapes_are_as_good(void **state)
{
	(void)state;
	const eskel_affine affines[] = {shapes_identity, {{{-1, 0, 0, 500}, {0, 1, 0, -300}, {0, 0, 1, 7}}},
		{{{0.6, -0.8, 0, 0}, {0.8, 0.6, 0, 0}, {0, 0, 1, 0}}}};
	double errors[3];
	for (int i = 0; i < 3; i++) {
		fixture f = make_fixture(small_hamate(&affines[i]), 4, 100);
		eskel_reconstruction *r = fit(&f, 4, NULL);
		errors[i] = r->after.mean_error;
		eskel_reconstruction_free(r);
		clear_fixture(&f);
	}
	for (int i = 1; i < 3; i++)
		if (fabs(errors[i] / errors[0] - 1) > 0.1)
			fail_msg("e_me %g mm, and %g mm moved", errors[0], errors[i]);
}

static void hopping_is_never_worse(void **state)
{
	(void)state;
	fixture f = make_fixture(small_hamate(&shapes_identity), 2, 300);
	eskel_surface *plain = NULL;
	assert_int_equal(eskel_surface_new(f.skeleton, 2,
				 &(eskel_surface_options){.primitive = ESKEL_PRIMITIVE_DEFORMED}, &plain),
		ESKEL_OK);
	esk_normal_equations *e = NULL;
	assert_int_equal(esk_normal_equations_new(f.points, 2, ESK_PARAMETERS_ALL, NULL, &e), ESKEL_OK);
	double costs[2];
	for (int hops = 0; hops < 2; hops++) {
		const eskel_fit_options options = {
			.method = hops ? ESKEL_FIT_HOPPING : ESKEL_FIT_JOINT, .hops = 4, .boundary_points = 300};
		eskel_reconstruction *r = fit(&f, 2, &options);
		costs[hops] = esk_normal_equations_measure(e, &r->surface->composition, f.points->length);
		eskel_reconstruction_free(r);
	}
	/* The pull to the start, which counts in what is kept, is not in these. */
	assert_true(costs[1] <= costs[0] + 1e-2 * f.boundary->spacing * f.boundary->spacing);
	esk_normal_equations_free(e);
	eskel_surface_free(plain);
	clear_fixture(&f);
}

static const eskel_fit_options least_squares = {.method = ESKEL_FIT_LEAST_SQUARES};

/* P is r^4 - 1, or anything else of the degree that vanishes where that does: at the boundary, in the mean, to a fraction of a
 * voxel. */
static void an_ellipsoid_is_its_own_algebraic_surface(void **state)
{
	(void)state;
	const eskel_primitive egg = {.kind = ESKEL_PRIMITIVE_ELLIPSOID,
		.centre = {24, 24, 30},
		.axes = {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}},
		.radii = {9, 14, 24},
		.exponents = {1, 1},
		.alpha = 1};
	eskel_surface *surface = NULL;
	assert_int_equal(eskel_surface_compose(&egg, 1, ESKEL_COMPOSE_BLEND, &surface), ESKEL_OK);
	fixture f = make_fixture(cloud_of_surface(surface, 60), 1, 100);
	eskel_reconstruction *r = fit(&f, 1, &least_squares);
	unsigned degree = 0;
	assert_int_equal(eskel_surface_primitive(r->surface, 0)->kind, ESKEL_PRIMITIVE_ALGEBRAIC);
	assert_non_null(eskel_surface_polynomial(r->surface, 0, &degree));
	assert_int_equal(degree, 4);
	assert_null(eskel_surface_polynomial(r->surface, 1, &degree));
	assert_null(eskel_surface_polynomial(surface, 0, &degree));
	uint64_t seed = 3;
	for (int i = 0; i < 200; i++) {
		double direction[3], point[3], square = 0;
		for (int c = 0; c < 3; c++) {
			direction[c] = synthetic_uniform(&seed) - 0.5;
			square += direction[c] * direction[c];
		}
		for (int c = 0; c < 3; c++) {
			point[c] = egg.centre[c];
			for (int k = 0; k < 3; k++)
				point[c] += egg.axes[k][c] * egg.radii[k] * direction[k] / sqrt(square);
		}
		const double distance = eskel_surface_distance(r->surface, point, NULL);
		if (fabs(distance) > 0.3)
			fail_msg("%g voxels off the ellipsoid", distance);
	}
	if (r->after.mean_error > 0.2 || r->after.dice < 0.985)
		fail_msg("e_me %g mm, Dice %g", r->after.mean_error, r->after.dice);
	eskel_reconstruction_free(r);
	eskel_surface_free(surface);
	clear_fixture(&f);
}

static void assert_is_drawn(const eskel_reconstruction *r, double volume)
{
	eskel_mesh *mesh = NULL;
	eskel_mesh_check_result check;
	eskel_error error = {0};
	if (eskel_surface_mesh(r->surface, 1, 0, &mesh, &error))
		fail_msg("%s", error.text);
	assert_int_equal(eskel_mesh_check(mesh, &check), ESKEL_OK);
	assert_true(check.is_manifold);
	const double ratio = eskel_mesh_volume(mesh) / volume;
	if (fabs(ratio - r->after.volume_ratio) > 0.03)
		fail_msg("volume ratio %g of the mesh, %g of the voxels", ratio, r->after.volume_ratio);
	eskel_mesh_free(mesh);
}

/* Sheets would be far from the boundary, which is not far from them. */
static void algebraic_surfaces_gain_at_every_level_without_sheets(void **state)
{
	(void)state;
	fixture f = make_fixture(small_hamate(&shapes_identity), 16, 100);
	for (uint32_t level = 1; level <= 16; level *= 2) {
		eskel_reconstruction *r = fit(&f, level, &least_squares);
		const eskel_surface_error *b = &r->before, *a = &r->after;
		print_message("level %u: e_me %.3f, %.3f; both ways %.3f, %.3f; Dice %.3f, %.3f\n", level,
			b->mean_error, a->mean_error, b->mean_distance, a->mean_distance, b->dice, a->dice);
		assert_int_equal(eskel_surface_composition(r->surface), ESKEL_COMPOSE_UNION);
		assert_true(a->mean_error < 0.7 * b->mean_error && a->dice > b->dice);
		assert_true(a->mean_distance < 1.4 * a->mean_error);
		assert_is_drawn(r, f.skeleton->volume);
		eskel_reconstruction_free(r);
	}
	clear_fixture(&f);
}

/* Coefficients are those of the classes' own frames. */
static void the_polynomial_is_the_potential(void **state)
{
	(void)state;
	fixture f = make_fixture(small_hamate(&shapes_identity), 1, 100);
	eskel_reconstruction *r = fit(&f, 1, &least_squares);
	const eskel_primitive *p = eskel_surface_primitive(r->surface, 0);
	unsigned degree;
	const double *next = eskel_surface_polynomial(r->surface, 0, &degree);
	double point[3], expected = 0;
	const double unit[3] = {0.3, -0.7, 1.1};
	for (int c = 0; c < 3; c++) {
		point[c] = p->centre[c];
		for (int k = 0; k < 3; k++)
			point[c] += p->axes[k][c] * p->radii[k] * unit[k];
	}
	for (int i = (int)degree; i >= 0; i--)
		for (int j = (int)degree - i; j >= 0; j--)
			for (int k = (int)degree - i - j; k >= 0; k--)
				expected += *next++ * pow(unit[0], i) * pow(unit[1], j) * pow(unit[2], k);
	assert_true(fabs(eskel_surface_value(r->surface, point) - expected) < 1e-9 * (1 + fabs(expected)));
	eskel_reconstruction_free(r);
	clear_fixture(&f);
}

static bool stop_at_third(void *context, uint32_t step, uint32_t steps)
{
	uint32_t *calls = context;
	assert_true(step <= steps);
	return ++*calls < 3;
}

static void a_fit_stops_when_told(void **state)
{
	(void)state;
	fixture f = make_fixture(small_hamate(&shapes_identity), 4, 100);
	for (int method = ESKEL_FIT_JOINT; method <= ESKEL_FIT_LEAST_SQUARES; method++) {
		uint32_t calls = 0;
		eskel_reconstruction *r = NULL;
		const eskel_fit_options options = {.method = (eskel_fit_method)method,
			.tabu_steps = 10,
			.boundary_points = 100,
			.progress = stop_at_third,
			.context = &calls};
		assert_int_equal(eskel_surface_fit(f.cloud, f.skeleton, 4, &options, &r, NULL), ESKEL_CANCELLED);
		assert_int_equal(calls, 3);
		assert_null(r);
	}
	clear_fixture(&f);
}

/* Also where a centre is off: it is inside of the surface. */
static void errors_are_measured_of_any_surface_that_is_near(void **state)
{
	(void)state;
	fixture f = make_fixture(small_hamate(&shapes_identity), 2, 100);
	const eskel_fit_options options = {.freedom = ESKEL_FIT_ELLIPSOID, .boundary_points = 300};
	eskel_reconstruction *r = fit(&f, 2, &options);
	eskel_surface_error errors = {0};
	eskel_error error = {0};
	assert_int_equal(eskel_surface_errors(r->surface, f.cloud, 2, &errors, &error), ESKEL_OK);
	assert_memory_equal(&errors, &r->after, sizeof errors);
	eskel_primitive far = *eskel_surface_primitive(r->surface, 0);
	eskel_surface *surface = NULL;
	far.centre[1] += 1000;
	assert_int_equal(eskel_surface_compose(&far, 1, ESKEL_COMPOSE_BLEND, &surface), ESKEL_OK);
	assert_int_equal(eskel_surface_errors(surface, f.cloud, 1, &errors, &error), ESKEL_TOO_LARGE);
	assert_int_equal(error.status, ESKEL_TOO_LARGE);
	assert_memory_equal(&errors, &r->after, sizeof errors);
	eskel_surface_free(surface);
	eskel_reconstruction_free(r);
	clear_fixture(&f);
}

static void odd_clouds_are_fitted_or_refused(void **state)
{
	(void)state;
	static const uint16_t voxels[][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {3, 2, 0}};
	for (size_t count = 1; count <= 6; count++) {
		fixture f = make_fixture(shapes_voxels(voxels, count, &shapes_identity), 3, 20);
		for (uint32_t level = 1; level <= f.skeleton->level_count; level++) {
			const eskel_fit_options *options[] = {NULL, &least_squares};
			for (int o = 0; o < 2; o++) {
				eskel_reconstruction *r = fit(&f, level, options[o]);
				if (!isfinite(r->after.mean_error) || r->after.dice <= 0.5)
					fail_msg("%zu voxels, level %u, options %d: Dice %g", count, level, o,
						r->after.dice);
				eskel_reconstruction_free(r);
			}
		}
		clear_fixture(&f);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_normal_equations_are_those_of_differences),
		cmocka_unit_test(a_superquadric_is_found_again),
		cmocka_unit_test(every_method_gains_and_the_joint_fit_most),
		cmocka_unit_test(fits_of_mirrored_and_moved_shapes_are_as_good),
		cmocka_unit_test(hopping_is_never_worse),
		cmocka_unit_test(an_ellipsoid_is_its_own_algebraic_surface),
		cmocka_unit_test(algebraic_surfaces_gain_at_every_level_without_sheets),
		cmocka_unit_test(the_polynomial_is_the_potential),
		cmocka_unit_test(a_fit_stops_when_told),
		cmocka_unit_test(errors_are_measured_of_any_surface_that_is_near),
		cmocka_unit_test(odd_clouds_are_fitted_or_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
