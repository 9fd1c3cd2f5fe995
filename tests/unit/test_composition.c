#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "composition.h"
#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PARTS = 5 };

static double uniform(uint64_t *state, double least, double most)
{
	return least + (most - least) * synthetic_uniform(state);
}

/* Overlapping, of any kind: modes up to the given size. */
static void random_primitives(uint64_t *state, double modes, double exponents, eskel_primitive *primitives)
{
	for (int p = 0; p < PARTS; p++) {
		double step[ESK_PARAMETERS_ALL] = {0};
		primitives[p] = (eskel_primitive){.kind = ESKEL_PRIMITIVE_DEFORMED,
			.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
			.radii = {5, 5, 5},
			.exponents = {1, 1},
			.alpha = 1};
		for (int t = 0; t < ESK_PARAMETERS_ALL; t++)
			step[t] = t < 3   ? uniform(state, -6, 6)
				  : t < 6 ? uniform(state, -2, 2)
					  : modes * uniform(state, -1, 1);
		for (int t = 6; t < 9; t++)
			step[t] = uniform(state, -0.6, 0.6);
		step[ESK_ALPHA] = uniform(state, -0.5, 2);
		step[ESK_EXPONENTS] = exponents * uniform(state, -1, 1);
		step[ESK_EXPONENTS + 1] = exponents * uniform(state, -1, 1);
		esk_primitive_step(&primitives[p], step, ESK_PARAMETERS_ALL, &primitives[p]);
		assert_true(esk_primitive_is_valid(&primitives[p]));
	}
}

static void random_points(uint64_t *state, size_t count, double (*points)[3])
{
	for (size_t n = 0; n < count; n++)
		for (int i = 0; i < 3; i++)
			points[n][i] = uniform(state, -10, 10);
}

/* The definition, from the potentials of each alone. */
static double composed(const eskel_primitive *primitives, eskel_compose compose, const double point[3])
{
	double potentials[PARTS], least = INFINITY, sum = 0;
	for (int p = 0; p < PARTS; p++) {
		esk_composition one;
		esk_composition_make(&primitives[p], 1, ESKEL_COMPOSE_UNION, &one);
		esk_composition_values(&one, 1, (const double(*)[3])point, &potentials[p]);
		if (compose == ESKEL_COMPOSE_BLEND)
			potentials[p] *= primitives[p].alpha;
		least = fmin(least, potentials[p]);
	}
	for (int p = 0; p < PARTS; p++)
		sum += exp(least - potentials[p]);
	return compose == ESKEL_COMPOSE_BLEND ? least - log(sum) : least;
}

static void compositions_are_what_their_definition_says(void **unused)
{
	(void)unused;
	uint64_t state = 1;
	for (int n = 0; n < 40; n++) {
		eskel_primitive primitives[PARTS];
		esk_composition made;
		double points[19][3], values[19];
		eskel_compose compose = n % 2 ? ESKEL_COMPOSE_UNION : ESKEL_COMPOSE_BLEND;
		random_primitives(&state, n % 4 < 2 ? 0.3 : 0, n % 8 < 4 ? 0.7 : 0, primitives);
		random_points(&state, 19, points);
		esk_composition_make(primitives, PARTS, compose, &made);
		esk_composition_values(&made, 19, (const double(*)[3])points, values);
		for (int p = 0; p < 19; p++) {
			double expected = composed(primitives, compose, points[p]);
			if (!(fabs(values[p] - expected) <= 1e-13 * (1 + fabs(expected))))
				fail_msg("the value is %.17g, expected %.17g", values[p], expected);
		}
	}
}

static void a_point_has_the_same_bits_in_any_company(void **unused)
{
	(void)unused;
	uint64_t state = 2;
	eskel_primitive primitives[PARTS];
	esk_composition made;
	double points[19][3], values[19], again[19], gradients[19][3], gradient[3];
	random_primitives(&state, 0.3, 0.7, primitives);
	random_points(&state, 19, points);
	for (int i = 0; i < 3; i++)
		points[7][i] = 60; /* far off: others' terms must not depend on it */
	esk_composition_make(primitives, PARTS, ESKEL_COMPOSE_BLEND, &made);
	esk_composition_values(&made, 19, (const double(*)[3])points, values);
	esk_composition_gradients(&made, 19, (const double(*)[3])points, again, gradients);
	assert_memory_equal(values, again, sizeof values);
	for (int p = 0; p < 19; p++) {
		double alone;
		esk_composition_values(&made, 1, (const double(*)[3]) & points[p], &alone);
		assert_memory_equal(&alone, &values[p], sizeof alone);
		alone = esk_composition_gradient(&made, points[p], gradient);
		assert_memory_equal(&alone, &values[p], sizeof alone);
		assert_memory_equal(gradient, gradients[p], sizeof gradient);
	}
}

static void assert_close(double found, double expected, double scale, const char *what, int part, int parameter)
{
	if (!(fabs(found - expected) <= 2e-5 * (fabs(expected) + scale)))
		fail_msg("%s by parameter %d of class %d is %.10g, differences say %.10g", what, parameter, part, found,
			expected);
}

static double change_of(const eskel_primitive *primitives, int part, int parameter, eskel_compose compose,
	const double point[3], double gradient_change[3])
{
	const double h = 1e-5;
	double values[2], gradients[2][3];
	for (int s = 0; s < 2; s++) {
		eskel_primitive moved[PARTS];
		esk_composition made;
		double step[ESK_PARAMETERS_ALL] = {0};
		memcpy(moved, primitives, sizeof moved);
		step[parameter] = s ? h : -h;
		esk_primitive_step(&moved[part], step, ESK_PARAMETERS_ALL, &moved[part]);
		esk_composition_make(moved, PARTS, compose, &made);
		values[s] = esk_composition_gradient(&made, point, gradients[s]);
	}
	for (int i = 0; i < 3; i++)
		gradient_change[i] = (gradients[1][i] - gradients[0][i]) / (2 * h);
	return (values[1] - values[0]) / (2 * h);
}

static void derivatives_of_a_blend_are_those_of_its_value_and_gradient(void **unused)
{
	(void)unused;
	static esk_derivatives derivatives[PARTS];
	uint64_t state = 3;
	for (int n = 0; n < 12; n++) {
		eskel_primitive primitives[PARTS];
		esk_composition made;
		esk_lanes point[3], values, gradients[3];
		bool is_near[PARTS];
		double points[ESK_LANES][3];
		eskel_compose compose = n % 3 == 2 ? ESKEL_COMPOSE_UNION : ESKEL_COMPOSE_BLEND;
		random_primitives(&state, 0.2, 0.4, primitives);
		random_points(&state, ESK_LANES, points);
		for (int l = 0; l < ESK_LANES; l++)
			for (int i = 0; i < 3; i++)
				point[i][l] = points[l][i] * 0.6;
		esk_composition_make(primitives, PARTS, compose, &made);
		esk_composition_derive(&made, (const esk_lanes *)point, ESK_PARAMETERS_ALL, 0, values, gradients,
			is_near, derivatives);
		for (int l = 0; l < ESK_LANES; l++)
			for (int p = 0; p < PARTS; p++) {
				const double at[3] = {point[0][l], point[1][l], point[2][l]};
				for (int t = 0; t < ESK_PARAMETERS_ALL; t++) {
					double slope[3];
					double by = change_of(primitives, p, t, compose, at, slope);
					if (t == ESK_ALPHA && compose == ESKEL_COMPOSE_UNION)
						assert_true(by == 0);
					assert_true(is_near[p]);
					assert_close(derivatives[p].value_by[t][l], by, 1 + fabs(values[l]),
						"the value", p, t);
					for (int i = 0; i < 3; i++)
						assert_close(derivatives[p].gradient_by[t][i][l], slope[i],
							10 + fabs(values[l]), "the gradient", p, t);
				}
			}
	}
}

static void classes_far_from_all_points_are_not_derived_by(void **unused)
{
	(void)unused;
	static esk_derivatives derivatives[2];
	eskel_primitive primitives[2] = {
		{.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .radii = {1, 1, 1}, .exponents = {1, 1}, .alpha = 1}};
	esk_composition made;
	esk_lanes point[3] = {{0}}, values, gradients[3];
	bool is_near[2];
	primitives[1] = primitives[0];
	primitives[1].centre[0] = 9;
	esk_composition_make(primitives, 2, ESKEL_COMPOSE_BLEND, &made);
	esk_composition_derive(
		&made, (const esk_lanes *)point, ESK_PARAMETERS_SMOOTH, 1e-9, values, gradients, is_near, derivatives);
	assert_true(is_near[0]);
	assert_false(is_near[1]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(compositions_are_what_their_definition_says),
		cmocka_unit_test(a_point_has_the_same_bits_in_any_company),
		cmocka_unit_test(derivatives_of_a_blend_are_those_of_its_value_and_gradient),
		cmocka_unit_test(classes_far_from_all_points_are_not_derived_by),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
