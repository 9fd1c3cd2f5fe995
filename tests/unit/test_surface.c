#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "deformations.h"
#include "form.h"
#include "shapes.h"
#include "skeletons.h"
#include "surface.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double uniform(uint64_t *state, double least, double most)
{
	return least + (most - least) * synthetic_uniform(state);
}

static void assert_close(double found, double expected, double tolerance)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%.17g, expected %.17g within %g", found, expected, tolerance);
}

/* The ellipsoid of radii (a, b, c) about a point, not turned. */
static eskel_primitive upright(eskel_primitive_kind kind, double a, double b, double c)
{
	return (eskel_primitive){.kind = kind,
		.centre = {1, -2, 3},
		.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
		.radii = {a, b, c},
		.exponents = {1, 1},
		.alpha = 1};
}

static eskel_surface *surface_of(const eskel_primitive *primitives, uint32_t count, eskel_compose compose)
{
	eskel_surface *surface = NULL;
	assert_int_equal(eskel_surface_compose(primitives, count, compose, &surface), ESKEL_OK);
	return surface;
}

/* At centre + (x, y, z). */
static double value_at(const eskel_primitive *primitive, double x, double y, double z)
{
	eskel_surface *surface = surface_of(primitive, 1, ESKEL_COMPOSE_BLEND);
	const double point[3] = {primitive->centre[0] + x, primitive->centre[1] + y, primitive->centre[2] + z};
	double value = eskel_surface_value(surface, point);
	eskel_surface_free(surface);
	return value;
}

/* One class: a ball of the given radius. */
static eskel_skeleton *ball_skeleton(double radius)
{
	const double v = radius * radius / 5;
	const skeletons_blob blob = {1000, {10, 20, -5}, {{v, 0, 0}, {0, v, 0}, {0, 0, v}}};
	return skeletons_new(&blob, 1, 1, 1);
}

static eskel_surface *plain_surface(
	const eskel_skeleton *skeleton, uint32_t level, const eskel_surface_options *options)
{
	eskel_surface *surface = NULL;
	assert_int_equal(eskel_surface_new(skeleton, level, options, &surface), ESKEL_OK);
	return surface;
}

/* ------------------------------------------------------------------------------------ ellipsoids */

static void the_surface_of_a_ball_is_its_sphere(void **unused)
{
	(void)unused;
	uint64_t state = 1;
	eskel_skeleton *skeleton = ball_skeleton(7);
	eskel_surface *surface = plain_surface(skeleton, 1, NULL);
	assert_int_equal(eskel_surface_count(surface), 1);
	for (int n = 0; n < 100; n++) {
		double offset[3], point[3], squares = 0, normal[3];
		for (int i = 0; i < 3; i++) {
			offset[i] = uniform(&state, -9, 9);
			point[i] = skeleton->nodes[0].centre[i] + offset[i];
			squares += offset[i] * offset[i];
		}
		const double r = sqrt(squares), distance = eskel_surface_distance(surface, point, normal);
		assert_close(eskel_surface_value(surface, point), squares / 49 - 1, 1e-13);
		assert_int_equal(eskel_surface_contains(surface, point), r < 7);
		if (fabs(r - 7) < 0.7)
			assert_close(distance, r - 7, 0.06 * fabs(r - 7));
		assert_true(fabs(distance) <= fmax(7, r));
		for (int i = 0; i < 3; i++)
			assert_close(normal[i], offset[i] / r, 1e-12);
	}
	eskel_surface_free(surface);
	eskel_skeleton_free(skeleton);
}

static void distance_is_finite_where_the_gradient_vanishes(void **unused)
{
	(void)unused;
	eskel_skeleton *skeleton = ball_skeleton(7);
	eskel_surface *surface = plain_surface(skeleton, 1, NULL);
	double normal[3] = {9, 9, 9};
	assert_close(eskel_surface_distance(surface, skeleton->nodes[0].centre, normal), -7, 1e-12);
	for (int i = 0; i < 3; i++)
		assert_true(normal[i] == 0);
	eskel_surface_free(surface);
	eskel_skeleton_free(skeleton);
}

/* The share of a box's points inside, times its volume. */
static double volume_of(const eskel_surface *surface, const double centre[3], double half)
{
	enum { SIDE = 60 };
	size_t inside = 0;
	for (int i = 0; i < SIDE; i++)
		for (int j = 0; j < SIDE; j++)
			for (int k = 0; k < SIDE; k++) {
				const double at[3] = {(2 * i + 1.0 - SIDE) / SIDE, (2 * j + 1.0 - SIDE) / SIDE,
					(2 * k + 1.0 - SIDE) / SIDE};
				const double point[3] = {
					centre[0] + half * at[0], centre[1] + half * at[1], centre[2] + half * at[2]};
				inside += eskel_surface_contains(surface, point);
			}
	return (double)inside / (SIDE * SIDE * SIDE) * 8 * half * half * half;
}

static void gamma_sqrt_5_gives_a_solid_ellipsoid_its_volume(void **unused)
{
	(void)unused;
	uint64_t state = 2;
	double rotation[3][3];
	skeletons_blob blob = {1000, {3, -4, 5}, {{16.0 / 5, 0, 0}, {0, 36.0 / 5, 0}, {0, 0, 81.0 / 5}}};
	skeletons_rotation(&state, rotation);
	skeletons_move((const double(*)[3])rotation, (const double[3]){1, 2, 3}, &blob, 1);
	eskel_skeleton *skeleton = skeletons_new(&blob, 1, 1, 1);
	eskel_surface *surface = plain_surface(skeleton, 1, NULL);
	const double expected = 4.0 / 3 * 3.14159265358979 * 4 * 6 * 9, *centre = skeleton->nodes[0].centre;
	assert_close(volume_of(surface, centre, 10), expected, 0.01 * expected);
	eskel_surface_free(surface);
	surface = plain_surface(skeleton, 1, &(eskel_surface_options){.gamma = 2});
	assert_close(volume_of(surface, centre, 10), expected * 8 / pow(5, 1.5), 0.01 * expected);
	const eskel_primitive *primitive = eskel_surface_primitive(surface, 0);
	assert_close(primitive->radii[2], 2 * 9 / sqrt(5), 1e-9); /* z along the longest axis */
	assert_null(eskel_surface_primitive(surface, 1));
	eskel_surface_free(surface);
	eskel_skeleton_free(skeleton);
}

static void gamma_is_by_default_2_in_a_blend_and_sqrt_5_in_a_union(void **unused)
{
	(void)unused;
	skeletons_blob blobs[4];
	skeletons_scatter(3, blobs, 4);
	eskel_skeleton *skeleton = skeletons_new(blobs, 4, 4, 1);
	const eskel_node *node = eskel_skeleton_node(skeleton, 3, 1);
	for (int n = 0; n < 2; n++) {
		eskel_compose compose = n ? ESKEL_COMPOSE_UNION : ESKEL_COMPOSE_BLEND;
		eskel_surface *surface = plain_surface(skeleton, 3, &(eskel_surface_options){.compose = compose});
		assert_int_equal(eskel_surface_composition(surface), compose);
		assert_close(eskel_surface_primitive(surface, 1)->radii[2],
			(n ? sqrt(5) : 2) * sqrt(node->eigenvalues[0]), 1e-12);
		eskel_surface_free(surface);
	}
	eskel_skeleton_free(skeleton);
}

static void rotating_the_skeleton_rotates_the_surface(void **unused)
{
	(void)unused;
	uint64_t state = 4;
	for (int n = 0; n < 10; n++) {
		skeletons_blob blobs[6], moved[6];
		double rotation[3][3], offset[3] = {100, -50, 20};
		skeletons_scatter((uint64_t)n, blobs, 6);
		memcpy(moved, blobs, sizeof moved);
		skeletons_rotation(&state, rotation);
		skeletons_move((const double(*)[3])rotation, offset, moved, 6);
		eskel_skeleton *a = skeletons_new(blobs, 6, 6, 1), *b = skeletons_new(moved, 6, 6, 1);
		const eskel_surface_options options = {.compose = n % 2 ? ESKEL_COMPOSE_UNION : ESKEL_COMPOSE_BLEND};
		eskel_surface *of_a = plain_surface(a, 6, &options), *of_b = plain_surface(b, 6, &options);
		for (int p = 0; p < 50; p++) {
			const double point[3] = {
				uniform(&state, 0, 60), uniform(&state, 0, 40), uniform(&state, 0, 25)};
			double turned[3], value = eskel_surface_value(of_a, point);
			for (int r = 0; r < 3; r++)
				turned[r] = rotation[r][0] * point[0] + rotation[r][1] * point[1] +
					    rotation[r][2] * point[2] + offset[r];
			assert_close(eskel_surface_value(of_b, turned), value, 1e-9 * (1 + fabs(value)));
		}
		eskel_surface_free(of_a);
		eskel_surface_free(of_b);
		eskel_skeleton_free(a);
		eskel_skeleton_free(b);
	}
}

static void flat_classes_have_the_thickness_of_a_voxel(void **unused)
{
	(void)unused;
	static const uint16_t shapes[3][4][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
		{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, {{0, 0, 0}}};
	static const size_t counts[3] = {4, 4, 1};
	for (int n = 0; n < 3; n++) {
		eskel_cloud *cloud = shapes_voxels(shapes[n], counts[n], &shapes_identity);
		eskel_skeleton *skeleton = NULL;
		assert_int_equal(eskel_skeleton_new(cloud, NULL, &skeleton, NULL), ESKEL_OK);
		for (uint32_t level = 1; level <= skeleton->level_count; level++) {
			eskel_surface *surface = plain_surface(skeleton, level, NULL);
			for (uint32_t c = 0; c < level; c++) {
				const eskel_primitive *p = eskel_surface_primitive(surface, c);
				const double least = (level > 1 ? 2 : sqrt(5)) * sqrt(1 / 12.0);
				assert_true(eskel_surface_contains(surface, p->centre));
				for (int i = 0; i < 3; i++)
					assert_true(p->radii[i] > least - 1e-12);
				assert_close(p->radii[1], fmin(p->radii[0], p->radii[1]), 1e-12);
			}
			eskel_surface_free(surface);
		}
		eskel_skeleton_free(skeleton);
		eskel_cloud_free(cloud);
	}
}

/* ------------------------------------------------------------------------------------ superquadrics, deformations */

static double signed_power(double x, double e)
{
	return copysign(pow(fabs(x), e), x);
}

/* Barr's parametric form, with the paper's names of the exponents. */
static void points_of_the_parametric_form_are_on_the_surface(void **unused)
{
	(void)unused;
	uint64_t state = 5;
	for (int n = 0; n < 200; n++) {
		eskel_primitive p = upright(ESKEL_PRIMITIVE_SUPERQUADRIC, 4, 6, 9);
		p.exponents[0] = uniform(&state, 0.1, 1.9);
		p.exponents[1] = uniform(&state, 0.1, 1.9);
		const double eta = uniform(&state, -1.4, 1.4), omega = uniform(&state, -3.1, 3.1);
		const double across = signed_power(cos(eta), p.exponents[1]);
		const double x = 4 * across * signed_power(cos(omega), p.exponents[0]);
		const double y = 6 * across * signed_power(sin(omega), p.exponents[0]);
		const double z = 9 * signed_power(sin(eta), p.exponents[1]);
		/* creases are rounded within 2^-12 radii */
		assert_close(value_at(&p, x, y, z), 0, 0.01);
		if (fmin(fabs(x) / 4, fmin(fabs(y) / 6, fabs(z) / 9)) > 0.03)
			assert_close(value_at(&p, x, y, z), 0, 1e-4);
		assert_close(value_at(&p, 2 * x, 2 * y, 2 * z), 3, 0.02); /* the square of the distance */
	}
}

static void small_exponents_make_boxes_and_cylinders(void **unused)
{
	(void)unused;
	eskel_primitive box = upright(ESKEL_PRIMITIVE_SUPERQUADRIC, 4, 6, 9), cylinder = box;
	box.exponents[0] = box.exponents[1] = cylinder.exponents[1] = 0.1;
	assert_true(value_at(&box, 4 * 0.92, 6 * 0.92, 9 * 0.92) < 0);
	assert_true(value_at(&box, 4 * 1.01, 0, 0) > 0);
	assert_true(value_at(&cylinder, 4 * 0.65, 6 * 0.65, 9 * 0.95) < 0);
	assert_true(value_at(&cylinder, 4 * 0.72, 6 * 0.72, 0) > 0);
	assert_true(value_at(&cylinder, 0, 0, 9 * 1.01) > 0);
}

static void one_mode_at_a_time_moves_the_outline_as_it_says(void **unused)
{
	(void)unused;
	for (int step = -9; step <= 9; step++) {
		const double h = step / 10.0, width = sqrt(1 - h * h), z = 9 * h;
		eskel_primitive p = upright(ESKEL_PRIMITIVE_DEFORMED, 4, 6, 9);
		p.modes[ESKEL_MODE_TAPER_X] = 0.7;
		assert_close(value_at(&p, 4 * exp(0.7 * h) * width, 0, z), 0, 1e-12);
		assert_close(value_at(&p, 0, 6 * width, z), 0, 1e-12);
		p = upright(ESKEL_PRIMITIVE_DEFORMED, 4, 6, 9);
		p.modes[ESKEL_MODE_BEND_Y] = -0.5;
		assert_close(value_at(&p, 4 * width, -0.5 * 9 * h * h, z), 0, 1e-12);
		assert_close(value_at(&p, 0, 6 * width - 0.5 * 9 * h * h, z), 0, 1e-12);
		p = upright(ESKEL_PRIMITIVE_DEFORMED, 4, 6, 9);
		p.modes[ESKEL_MODE_TWIST] = 1.1;
		assert_close(value_at(&p, 4 * width * cos(1.1 * h), 4 * width * sin(1.1 * h), z), 0, 1e-12);
		p = upright(ESKEL_PRIMITIVE_DEFORMED, 4, 6, 9);
		p.modes[ESKEL_MODE_CUP_XX] = 0.3; /* h is x here */
		assert_close(value_at(&p, 4 * h, 0, 9 * (width + 0.3 * h * h)), 0, 1e-12);
		p = upright(ESKEL_PRIMITIVE_DEFORMED, 4, 6, 9);
		p.modes[ESKEL_MODE_WEDGE_X] = 0.4;
		assert_close(value_at(&p, 4 * h, 0, 9 * width * exp(0.4 * h)), 0, 1e-12);
		p = upright(ESKEL_PRIMITIVE_DEFORMED, 4, 6, 9);
		p.modes[ESKEL_MODE_SKEW] = 0.4;
		assert_close(value_at(&p, 4 * h, 6 * width * exp(0.4 * h), 0), 0, 1e-12);
	}
}

static eskel_primitive random_primitive(uint64_t *state, eskel_primitive_kind kind, double modes, bool extreme)
{
	eskel_primitive p = upright(kind, uniform(state, 1, 9), uniform(state, 1, 9), uniform(state, 1, 9));
	double turn[6] = {uniform(state, -9, 9), uniform(state, -9, 9), uniform(state, -9, 9), uniform(state, -2, 2),
		uniform(state, -2, 2), uniform(state, -2, 2)};
	esk_primitive_step(&p, turn, 6, &p);
	for (int i = 0; i < ESKEL_MODE_COUNT && kind == ESKEL_PRIMITIVE_DEFORMED; i++)
		p.modes[i] = extreme ? (synthetic_random(state) & 1 ? modes : -modes) : uniform(state, -modes, modes);
	for (int i = 0; i < 2 && (kind == ESKEL_PRIMITIVE_DEFORMED || kind == ESKEL_PRIMITIVE_SUPERQUADRIC); i++)
		p.exponents[i] = extreme ? (synthetic_random(state) & 1 ? 0.1 : 1.9) : uniform(state, 0.1, 1.9);
	p.alpha = uniform(state, 0.5, 2);
	return p;
}

/* All modes at once; or one alone, at its limit: all at their limits would throw points 10,000 radii away. */
static void deformations_are_undone_exactly(void **unused)
{
	(void)unused;
	uint64_t state = 6;
	for (int n = 0; n < 300; n++) {
		eskel_primitive p = random_primitive(&state, ESKEL_PRIMITIVE_DEFORMED, n % 2 ? 0.2 : 0, n % 3 == 0);
		esk_form form;
		double unit[3], world[3];
		p.exponents[0] = p.exponents[1] = p.alpha = 1;
		if (n % 2 == 0)
			p.modes[n / 2 % ESKEL_MODE_COUNT] = n % 4 ? ESKEL_MODE_MAX : -ESKEL_MODE_MAX;
		esk_form_make(&p, &form);
		for (int i = 0; i < 3; i++)
			unit[i] = uniform(&state, -1, 1);
		deformations_undo(&form, unit, world);
		const double expected = unit[0] * unit[0] + unit[1] * unit[1] + unit[2] * unit[2] - 1;
		assert_close(value_at(&p, world[0] - p.centre[0], world[1] - p.centre[1], world[2] - p.centre[2]),
			expected, 1e-9);
	}
}

static void steps_keep_the_frame_and_the_last_undoes_the_first(void **unused)
{
	(void)unused;
	uint64_t state = 7;
	eskel_primitive p = random_primitive(&state, ESKEL_PRIMITIVE_DEFORMED, 0.5, false), q = p;
	const eskel_primitive start = p;
	for (int n = 0; n < 1000; n++) {
		double step[ESK_PARAMETERS_ALL] = {0};
		for (int t = 3; t < 9; t++)
			step[t] = uniform(&state, -0.1, 0.1);
		esk_primitive_step(&q, step, ESK_PARAMETERS_ALL, &p);
		assert_true(esk_primitive_is_valid(&p));
		for (int t = 3; t < 9; t++)
			step[t] = -step[t];
		esk_primitive_step(&p, step, ESK_PARAMETERS_ALL, &q);
	}
	for (int i = 0; i < 3; i++) {
		assert_close(q.radii[i], start.radii[i], 1e-10);
		for (int k = 0; k < 3; k++)
			assert_close(q.axes[k][i], start.axes[k][i], 1e-10);
	}
}

static void everything_is_finite_at_the_limits_of_the_parameters(void **unused)
{
	(void)unused;
	uint64_t state = 8;
	for (int n = 0; n < 400; n++) {
		eskel_primitive p = random_primitive(&state, (eskel_primitive_kind)(n % 3), ESKEL_MODE_MAX, true);
		const double far = n % 5 == 0 ? 1e7 : n % 5 == 1 ? 1e-9 : 20;
		if (n % 7 == 0)
			p.radii[n % 3] = n % 2 ? ESKEL_RADIUS_MIN : ESKEL_RADIUS_MAX;
		eskel_surface *surface = surface_of(&p, 1, ESKEL_COMPOSE_BLEND);
		for (int m = 0; m < 50; m++) {
			double gradient[3], point[3];
			for (int i = 0; i < 3; i++) {
				point[i] = p.centre[i];
				for (int k = 0; k < 3; k++)
					if (m >> k & 1)
						point[i] += far * p.axes[k][i] * uniform(&state, -1, 1);
			}
			const double value = eskel_surface_gradient(surface, point, gradient);
			if (!isfinite(value) || !isfinite(gradient[0]) || !isfinite(gradient[1]) ||
				!isfinite(gradient[2]))
				fail_msg("%d: %g, %g %g %g at %g %g %g", n, value, gradient[0], gradient[1],
					gradient[2], point[0], point[1], point[2]);
			assert_true(isfinite(eskel_surface_distance(surface, point, NULL)));
		}
		eskel_surface_free(surface);
	}
}

static void derivatives_are_finite_on_axes_and_at_the_centre(void **unused)
{
	(void)unused;
	static esk_derivatives d;
	uint64_t state = 9;
	for (int n = 0; n < 200; n++) {
		eskel_primitive p = random_primitive(&state, ESKEL_PRIMITIVE_DEFORMED, 1, n % 2);
		esk_form form;
		esk_lanes point[3];
		esk_form_make(&p, &form);
		for (int l = 0; l < ESK_LANES; l++) {
			double world[3];
			const double unit[3] = {l & 1 ? 0.5 : 0, l & 2 ? 0.7 : 0, l & 4 ? -0.4 : 0};
			deformations_undo(&form, unit, world);
			for (int i = 0; i < 3; i++)
				point[i][l] = world[i];
		}
		esk_form_derive(&form, (const esk_lanes *)point, ESK_PARAMETERS_ALL, &d);
		for (int t = 0; t < ESK_PARAMETERS_ALL; t++)
			for (int l = 0; l < ESK_LANES; l++) {
				assert_true(isfinite(d.value_by[t][l]));
				for (int i = 0; i < 3; i++)
					assert_true(isfinite(d.gradient_by[t][i][l]));
			}
	}
}

/* ------------------------------------------------------------------------------------ bytes and refusals */

static eskel_surface *one_of_each_kind(void)
{
	uint64_t state = 10;
	eskel_primitive primitives[4];
	double points[200][3];
	for (int i = 0; i < 4; i++)
		primitives[i] = random_primitive(&state, (eskel_primitive_kind)(i % 3), 0.5, false);
	eskel_surface *surface = surface_of(primitives, 4, ESKEL_COMPOSE_BLEND);
	for (int n = 0; n < 200; n++)
		for (int i = 0; i < 3; i++)
			points[n][i] = primitives[3].centre[i] + uniform(&state, -4, 4);
	assert_int_equal(eskel_surface_set_algebraic(surface, 3, 4, (const double(*)[3])points, 200), ESKEL_OK);
	return surface;
}

static void the_round_trip_is_exact(void **unused)
{
	(void)unused;
	uint64_t state = 11;
	eskel_surface *surface = one_of_each_kind(), *decoded = NULL;
	uint8_t *bytes = NULL, *again = NULL;
	size_t size = 0, size_again = 0;
	assert_int_equal(eskel_surface_encode(surface, &bytes, &size), ESKEL_OK);
	assert_int_equal(size, 3 + 129 + 145 + 313 + 129 + 1 + 8 * 35);
	assert_int_equal(eskel_surface_decode(bytes, size, &decoded, NULL), ESKEL_OK);
	assert_int_equal(eskel_surface_encode(decoded, &again, &size_again), ESKEL_OK);
	assert_int_equal(size_again, size);
	assert_memory_equal(again, bytes, size);
	for (int n = 0; n < 100; n++) {
		const double point[3] = {uniform(&state, -20, 20), uniform(&state, -20, 20), uniform(&state, -20, 20)};
		double a[4], b[4];
		a[3] = eskel_surface_gradient(surface, point, a);
		b[3] = eskel_surface_gradient(decoded, point, b);
		assert_memory_equal(a, b, sizeof a);
	}
	free(bytes);
	free(again);
	eskel_surface_free(surface);
	eskel_surface_free(decoded);
}

static void truncated_bytes_are_refused(void **unused)
{
	(void)unused;
	eskel_surface *surface = one_of_each_kind(), *decoded = NULL;
	uint8_t *bytes = NULL;
	size_t size = 0;
	eskel_error error;
	assert_int_equal(eskel_surface_encode(surface, &bytes, &size), ESKEL_OK);
	for (size_t n = 0; n < size; n++) {
		uint8_t *part = malloc(n + 1); /* so that a sanitizer sees what is read behind it */
		assert_non_null(part);
		memcpy(part + 1, bytes, n);
		assert_int_equal(eskel_surface_decode(part + 1, n, &decoded, &error), ESKEL_TRUNCATED);
		assert_null(decoded);
		free(part);
	}
	free(bytes);
	eskel_surface_free(surface);
}

static void corrupted_bytes_are_refused_or_harmless(void **unused)
{
	(void)unused;
	uint64_t state = 12;
	eskel_surface *surface = one_of_each_kind();
	uint8_t *bytes = NULL;
	size_t size = 0, refused = 0;
	assert_int_equal(eskel_surface_encode(surface, &bytes, &size), ESKEL_OK);
	for (int n = 0; n < 3000; n++) {
		eskel_surface *decoded = NULL;
		const size_t at = synthetic_random(&state) % size;
		const uint8_t before = bytes[at];
		bytes[at] = (uint8_t)synthetic_random(&state);
		if (eskel_surface_decode(bytes, size, &decoded, NULL)) {
			assert_null(decoded);
			refused++;
		} else {
			double gradient[3];
			for (uint32_t c = 0; c < eskel_surface_count(decoded); c++) {
				const double *centre = eskel_surface_primitive(decoded, c)->centre;
				if (fmax(fabs(centre[0]), fmax(fabs(centre[1]), fabs(centre[2]))) < 1e6)
					assert_true(eskel_surface_gradient(decoded, centre, gradient) < INFINITY);
			}
		}
		eskel_surface_free(decoded);
		bytes[at] = before;
	}
	assert_true(refused > 300);
	free(bytes);
	eskel_surface_free(surface);
}

static void points_that_no_polynomial_fits_are_refused(void **unused)
{
	(void)unused;
	const eskel_primitive ball = upright(ESKEL_PRIMITIVE_ELLIPSOID, 4, 4, 4);
	const double far[1][3] = {{1e200, 0, 0}}, nowhere[1][3] = {{0, NAN, 0}}, good[1][3] = {{5, -2, 3}};
	const struct {
		uint32_t class_index;
		unsigned degree;
		const double (*points)[3];
		size_t count;
		eskel_status status;
	} cases[] = {
		{1, 4, good, 1, ESKEL_INVALID},
		{0, 3, good, 1, ESKEL_INVALID},
		{0, 4, good, 0, ESKEL_INVALID},
		{0, 4, nowhere, 1, ESKEL_INVALID},
		{0, 4, far, 1, ESKEL_NUMERIC},
		{0, 4, good, 1, ESKEL_OK},
	};
	eskel_surface *surface = surface_of(&ball, 1, ESKEL_COMPOSE_BLEND);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		assert_int_equal(eskel_surface_primitive(surface, 0)->kind, ESKEL_PRIMITIVE_ELLIPSOID);
		assert_int_equal(eskel_surface_set_algebraic(surface, cases[i].class_index, cases[i].degree,
					 cases[i].points, cases[i].count),
			cases[i].status);
	}
	assert_int_equal(eskel_surface_primitive(surface, 0)->kind, ESKEL_PRIMITIVE_ALGEBRAIC);
	eskel_surface_free(surface);
}

static void numbers_out_of_range_are_refused(void **unused)
{
	(void)unused;
	eskel_surface *surface = NULL;
	eskel_primitive good = upright(ESKEL_PRIMITIVE_DEFORMED, 4, 6, 9), bad[8];
	for (int i = 0; i < 8; i++)
		bad[i] = good;
	bad[0].radii[1] = 0;
	bad[1].centre[2] = NAN;
	bad[2].exponents[0] = 2;
	bad[3].modes[7] = INFINITY;
	bad[4].alpha = -1;
	bad[5].axes[0][0] = -1; /* left-handed */
	bad[6].kind = ESKEL_PRIMITIVE_SUPERQUADRIC;
	bad[6].modes[0] = 0.5;
	bad[7].kind = ESKEL_PRIMITIVE_ALGEBRAIC;
	for (int i = 0; i < 8; i++)
		assert_int_equal(eskel_surface_compose(&bad[i], 1, ESKEL_COMPOSE_BLEND, &surface), ESKEL_INVALID);
	assert_int_equal(eskel_surface_compose(&good, 0, ESKEL_COMPOSE_BLEND, &surface), ESKEL_INVALID);
	eskel_skeleton *skeleton = ball_skeleton(7);
	assert_int_equal(eskel_surface_new(skeleton, 0, NULL, &surface), ESKEL_INVALID);
	assert_int_equal(eskel_surface_new(skeleton, 2, NULL, &surface), ESKEL_INVALID);
	assert_int_equal(
		eskel_surface_new(skeleton, 1, &(eskel_surface_options){.gamma = -1}, &surface), ESKEL_INVALID);
	assert_null(surface);
	eskel_surface_free(NULL);
	eskel_skeleton_free(skeleton);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_surface_of_a_ball_is_its_sphere),
		cmocka_unit_test(distance_is_finite_where_the_gradient_vanishes),
		cmocka_unit_test(gamma_sqrt_5_gives_a_solid_ellipsoid_its_volume),
		cmocka_unit_test(gamma_is_by_default_2_in_a_blend_and_sqrt_5_in_a_union),
		cmocka_unit_test(rotating_the_skeleton_rotates_the_surface),
		cmocka_unit_test(flat_classes_have_the_thickness_of_a_voxel),
		cmocka_unit_test(points_of_the_parametric_form_are_on_the_surface),
		cmocka_unit_test(small_exponents_make_boxes_and_cylinders),
		cmocka_unit_test(one_mode_at_a_time_moves_the_outline_as_it_says),
		cmocka_unit_test(deformations_are_undone_exactly),
		cmocka_unit_test(steps_keep_the_frame_and_the_last_undoes_the_first),
		cmocka_unit_test(everything_is_finite_at_the_limits_of_the_parameters),
		cmocka_unit_test(derivatives_are_finite_on_axes_and_at_the_centre),
		cmocka_unit_test(the_round_trip_is_exact),
		cmocka_unit_test(truncated_bytes_are_refused),
		cmocka_unit_test(corrupted_bytes_are_refused_or_harmless),
		cmocka_unit_test(points_that_no_polynomial_fits_are_refused),
		cmocka_unit_test(numbers_out_of_range_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
