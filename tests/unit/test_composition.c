#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "blend.h"
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

static void random_strip(uint64_t *state, esk_strip points[3])
{
	for (int i = 0; i < 3; i++)
		for (int l = 0; l < ESK_STRIP; l++)
			points[i][l] = uniform(state, -10, 10);
}

static void assert_strip(const esk_form *form, const esk_strip points[3])
{
	esk_strip_place place;
	esk_strip values, gradients[3];
	esk_strip_locate(form, points, &place);
	esk_strip_gradients(form, &place, values, gradients);
	for (int first = 0; first < ESK_STRIP; first += ESK_LANES) {
		esk_lanes point[3], value, gradient[3];
		for (int i = 0; i < 3; i++)
			memcpy(point[i], &points[i][first], sizeof point[i]);
		esk_form_gradients(form, 1, (const esk_lanes(*)[3])point, &value, &gradient);
		assert_memory_equal(value, &values[first], sizeof value);
		for (int i = 0; i < 3; i++)
			assert_memory_equal(gradient[i], &gradients[i][first], sizeof gradient[i]);
		for (int l = 0; l < ESK_LANES; l++)
			assert_true(place.floor[first + l] <= value[l] + 1e-12 * (1 + fabs(value[l])));
	}
}

static void strips_have_the_bits_of_blocks(void **unused)
{
	(void)unused;
	uint64_t state = 5;
	for (int n = 0; n < 40; n++) {
		eskel_primitive primitives[PARTS];
		esk_strip points[3];
		random_primitives(&state, n % 4 ? 0.3 : 0, n % 2 ? 0.7 : 0, primitives);
		random_strip(&state, points);
		for (int p = 0; p < PARTS; p++) {
			esk_form form;
			if (n % 3 == 0)
				memset(primitives[p].modes + ESKEL_MODE_CUP_XX, 0,
					(ESKEL_MODE_COUNT - ESKEL_MODE_CUP_XX) * sizeof *primitives[p].modes);
			esk_form_make(&primitives[p], &form);
			assert_strip(&form, (const esk_strip *)points);
		}
	}
}

static void a_blend_at_a_strip_is_the_composition(void **unused)
{
	(void)unused;
	uint64_t state = 6;
	for (int n = 0; n < 20; n++) {
		eskel_primitive primitives[PARTS];
		esk_composition made;
		esk_strip points[3], values, gradients[3], weights[PARTS];
		const uint32_t count = n % 4 == 0 ? 1 : PARTS;
		random_primitives(&state, 0.3, 0.7, primitives);
		if (n % 2)
			primitives[2].centre[1] = 300; /* too far off to count */
		random_strip(&state, points);
		esk_composition_make(primitives, count, ESKEL_COMPOSE_BLEND, &made);
		esk_blend_evaluate(&made, (const esk_strip *)points, values, gradients, weights);
		for (int l = 0; l < ESK_STRIP; l++) {
			const double point[3] = {points[0][l], points[1][l], points[2][l]};
			double gradient[3], sum = 0;
			const double value = esk_composition_gradient(&made, point, gradient);
			assert_true(fabs(values[l] - value) <= 1e-13 * (1 + fabs(value)));
			for (int i = 0; i < 3; i++)
				assert_true(fabs(gradients[i][l] - gradient[i]) <= 1e-12 * (1 + fabs(gradient[i])));
			for (uint32_t p = 0; p < count; p++)
				sum += weights[p][l];
			assert_true(fabs(sum - 1) <= 1e-14);
			if (n % 2)
				assert_true(weights[2][l] == 0);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(compositions_are_what_their_definition_says),
		cmocka_unit_test(a_point_has_the_same_bits_in_any_company),
		cmocka_unit_test(strips_have_the_bits_of_blocks),
		cmocka_unit_test(a_blend_at_a_strip_is_the_composition),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
