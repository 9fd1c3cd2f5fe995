#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "algebraic.h"
#include "synthetic.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double uniform(uint64_t *state, double least, double most)
{
	return least + (most - least) * synthetic_uniform(state);
}

static const eskel_primitive ball = {.kind = ESKEL_PRIMITIVE_ELLIPSOID,
	.axes = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
	.radii = {1, 1, 1},
	.exponents = {1, 1},
	.alpha = 1};

static const eskel_primitive egg = {.kind = ESKEL_PRIMITIVE_ELLIPSOID,
	.centre = {5, -7, 11},
	.axes = {{0, 0.6, 0.8}, {0, -0.8, 0.6}, {1, 0, 0}},
	.radii = {3, 4, 9},
	.exponents = {1, 1},
	.alpha = 1};

/* From the frame of a primitive, in radii. */
static void to_world(const eskel_primitive *p, const double unit[3], double world[3])
{
	for (int i = 0; i < 3; i++) {
		world[i] = p->centre[i];
		for (int k = 0; k < 3; k++)
			world[i] += p->axes[k][i] * p->radii[k] * unit[k];
	}
}

static double evaluate(const esk_algebraic *algebraic, const double point[3], double gradient[3])
{
	esk_lanes lanes[3] = {{0}}, values, gradients[3];
	for (int i = 0; i < 3; i++)
		lanes[i][3] = point[i];
	esk_algebraic_gradients(algebraic, (const esk_lanes *)lanes, values, gradients);
	for (int i = 0; i < 3; i++)
		gradient[i] = gradients[i][3];
	return values[3];
}

static void random_direction(uint64_t *state, double direction[3])
{
	double squares;
	do {
		squares = 0;
		for (int i = 0; i < 3; i++) {
			direction[i] = uniform(state, -1, 1);
			squares += direction[i] * direction[i];
		}
	} while (squares > 1 || squares < 0.01);
	for (int i = 0; i < 3; i++)
		direction[i] /= sqrt(squares);
}

/* Points where x^n + y^n + z^n = 1 in the frame. */
static void superquadric_points(uint64_t *state, const eskel_primitive *p, int n, size_t count, double (*points)[3])
{
	for (size_t i = 0; i < count; i++) {
		double direction[3];
		random_direction(state, direction);
		const double sum = pow(direction[0], n) + pow(direction[1], n) + pow(direction[2], n);
		for (int c = 0; c < 3; c++)
			direction[c] /= pow(sum, 1.0 / n);
		to_world(p, direction, points[i]);
	}
}

enum { POINTS = 500 };

static eskel_status fit(const eskel_primitive *primitive, unsigned degree, const double (*points)[3], size_t count,
	esk_algebraic *fitted)
{
	return esk_algebraic_fit(primitive, degree, &(esk_algebraic_points){.count = count, .points = points}, fitted);
}

/* The greatest distance, in radii, of the fitted surface from other points of x^n + y^n + z^n = 1. */
static double error_of(unsigned degree, int n)
{
	static double points[POINTS][3];
	uint64_t state = degree + (unsigned)n;
	esk_algebraic fitted;
	double greatest = 0, shortest = 3;
	superquadric_points(&state, &egg, n, POINTS, points);
	assert_int_equal(fit(&egg, degree, (const double(*)[3])points, POINTS, &fitted), ESKEL_OK);
	superquadric_points(&state, &egg, n, POINTS, points);
	for (size_t i = 0; i < POINTS; i++) {
		double g[3], value = evaluate(&fitted, points[i], g);
		greatest = fmax(greatest, fabs(value) / sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / shortest);
	}
	return greatest;
}

static void surfaces_of_their_own_degree_are_found(void **unused)
{
	(void)unused;
	assert_true(error_of(2, 2) < 1e-6);
	assert_true(error_of(4, 2) < 1e-6);
	assert_true(error_of(6, 2) < 1e-6);
	assert_true(error_of(4, 4) < 0.01);
	assert_true(error_of(6, 6) < 0.03);
}

static void gradients_are_those_of_the_values(void **unused)
{
	(void)unused;
	uint64_t state = 1;
	for (unsigned degree = 2; degree <= 6; degree += 2) {
		esk_algebraic a = {.degree = degree};
		esk_algebraic_place(&egg, &a);
		for (size_t t = 0; t < esk_algebraic_term_count(degree); t++)
			a.coefficients[t] = uniform(&state, -1, 1);
		for (int n = 0; n < 20; n++) {
			double unit[3] = {uniform(&state, -1, 1), uniform(&state, -1, 1), uniform(&state, -1, 1)};
			double point[3], gradient[3], none[3], expected = 0;
			size_t t = 0;
			for (int i = (int)degree; i >= 0; i--)
				for (int j = (int)degree - i; j >= 0; j--)
					for (int k = (int)degree - i - j; k >= 0; k--)
						expected += a.coefficients[t++] * pow(unit[0], i) * pow(unit[1], j) *
							    pow(unit[2], k);
			to_world(&egg, unit, point);
			const double value = evaluate(&a, point, gradient);
			assert_true(fabs(value - expected) < 1e-12);
			for (int i = 0; i < 3; i++) {
				const double h = 1e-5, at = point[i];
				point[i] = at + h;
				double difference = evaluate(&a, point, none);
				point[i] = at - h;
				difference = (difference - evaluate(&a, point, none)) / (2 * h);
				point[i] = at;
				assert_true(fabs(gradient[i] - difference) < 1e-8);
			}
		}
	}
}

/* Coefficient of x^i y^j z^k. */
static double *term(esk_algebraic *a, int i, int j, int k)
{
	size_t t = 0;
	for (int p = (int)a->degree; p >= 0; p--)
		for (int q = (int)a->degree - p; q >= 0; q--)
			for (int r = (int)a->degree - p - q; r >= 0; r--, t++)
				if (p == i && q == j && r == k)
					return &a->coefficients[t];
	fail();
	return NULL;
}

static void boundedness_is_proven_or_refuted(void **unused)
{
	(void)unused;
	for (unsigned degree = 2; degree <= 6; degree += 2) {
		const int d = (int)degree;
		esk_algebraic a = {.degree = degree};
		*term(&a, 0, 0, 0) = -1;
		assert_false(esk_algebraic_is_bounded(&a));
		*term(&a, d, 0, 0) = *term(&a, 0, d, 0) = 1;
		assert_false(esk_algebraic_is_bounded(&a)); /* a cylinder */
		*term(&a, 0, 0, d) = -0.01;
		assert_false(esk_algebraic_is_bounded(&a));
		*term(&a, 0, 0, d) = 1;
		assert_true(esk_algebraic_is_bounded(&a));
		*term(&a, 0, 0, d) = pow(2.9, -d);
		assert_true(esk_algebraic_is_bounded(&a));
		*term(&a, 0, 0, d) = pow(3.1, -d); /* longer than the box */
		assert_false(esk_algebraic_is_bounded(&a));
		*term(&a, 0, 0, d) = 1;
		*term(&a, 0, 0, 0) = 1; /* the centre is outside */
		assert_false(esk_algebraic_is_bounded(&a));
		*term(&a, 0, 0, 0) = NAN;
		assert_false(esk_algebraic_is_bounded(&a));
	}
	esk_algebraic a = {.degree = 4};
	*term(&a, 0, 0, 0) = -1;
	*term(&a, 4, 0, 0) = *term(&a, 0, 4, 0) = *term(&a, 0, 0, 4) = 1;
	*term(&a, 2, 2, 0) = -1.99; /* positive, if barely, but x = y = 3.16 is on the surface */
	assert_false(esk_algebraic_is_bounded(&a));
	*term(&a, 2, 2, 0) = -1;
	assert_true(esk_algebraic_is_bounded(&a));
	*term(&a, 2, 2, 0) = -2.1;
	assert_false(esk_algebraic_is_bounded(&a));
}

/* Points on one side, on a plane, on a line, a single one, far away, noise: the surface is bounded all the same. */
static void whatever_the_points_the_surface_is_bounded(void **unused)
{
	(void)unused;
	uint64_t state = 2;
	for (int n = 0; n < 60; n++) {
		static double points[POINTS][3];
		esk_algebraic fitted;
		const size_t count = n % 5 == 4 ? 1 : (size_t)(3 + n * 7);
		for (size_t i = 0; i < count; i++) {
			double unit[3];
			random_direction(&state, unit);
			for (int c = 0; c < 3; c++)
				unit[c] =
					n % 5 == 3 ? uniform(&state, -1.5, 1.5) : unit[c] + uniform(&state, -0.2, 0.2);
			if (n % 5 == 0)
				unit[0] = fabs(unit[0]);
			if (n % 5 == 1)
				unit[2] = 0.3;
			if (n % 5 == 2)
				unit[0] = unit[1] = 0.5;
			if (n % 10 == 4)
				unit[0] += 40;
			to_world(&egg, unit, points[i]);
		}
		const unsigned degree = 2 + 2 * (unsigned)(n % 3);
		assert_int_equal(fit(&egg, degree, (const double(*)[3])points, count, &fitted), ESKEL_OK);
		assert_true(esk_algebraic_is_bounded(&fitted));
		for (int i = 0; i < 200; i++) {
			double unit[3], point[3], gradient[3];
			random_direction(&state, unit);
			const double far = uniform(&state, 3 * sqrt(3), 50);
			for (int c = 0; c < 3; c++)
				unit[c] *= far;
			to_world(&egg, unit, point);
			assert_true(evaluate(&fitted, point, gradient) > 0);
		}
	}
}

enum { GRID = 5, SHELLS = 3, ROWS = POINTS + 1 + SHELLS * 6 * GRID * GRID, TERMS = 35 };

static void put_row(const double u[3], double weight, double target, double *row, double *right)
{
	for (int p = 4; p >= 0; p--)
		for (int q = 4 - p; q >= 0; q--)
			for (int r = 4 - p - q; r >= 0; r--)
				*row++ = weight * pow(u[0], p) * pow(u[1], q) * pow(u[2], r);
	*right = weight * target;
}

/* The oracle: rows of points and of the ellipsoid, by LAPACK's singular values. The greatest difference. */
static double difference_from_oracle(const esk_algebraic *fitted, const double (*points)[3], double ellipsoid_weight)
{
	static double rows[ROWS][TERMS], right[ROWS], singular[TERMS];
	int rank;
	size_t row = 0;
	double greatest = 0;
	for (; row < POINTS; row++) {
		const double *u = points[row], r = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
		put_row(u, sqrt(1.0 / POINTS) / (pow(r, 4) + 1), 0, rows[row], &right[row]);
	}
	put_row((const double[3]){0}, 100, -1, rows[row], &right[row]);
	row++;
	for (int i = 0; i < 6 * GRID * GRID * SHELLS; i++, row++) {
		const int face = i % 6, s = i / 6 % SHELLS, g = i / 6 / SHELLS;
		const double radius = (double[]){0.4, 2, 3}[s], power = pow(radius, 4);
		double u[3];
		u[face / 2] = face % 2 ? 1 : -1;
		u[(face / 2 + 1) % 3] = (2.0 * (g % GRID) - 4) / GRID;
		u[(face / 2 + 2) % 3] = (2.0 * (g / GRID) - 4) / GRID;
		const double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
		for (int c = 0; c < 3; c++)
			u[c] *= radius / length;
		put_row(u, sqrt(ellipsoid_weight / (SHELLS * 6.0 * GRID * GRID)) / (power + 1), power - 1, rows[row],
			&right[row]);
	}
	assert_int_equal(
		LAPACKE_dgelsd(LAPACK_ROW_MAJOR, ROWS, TERMS, 1, &rows[0][0], TERMS, right, 1, singular, -1, &rank), 0);
	assert_int_equal(rank, TERMS);
	for (size_t t = 0; t < TERMS; t++)
		greatest = fmax(greatest, fabs(fitted->coefficients[t] + right[t] / right[TERMS - 1]));
	return greatest;
}

static void the_fit_is_the_least_squares_solution_of_one_of_the_weights(void **unused)
{
	(void)unused;
	for (uint64_t seed = 0; seed < 10; seed++) {
		static double points[POINTS][3];
		esk_algebraic fitted;
		uint64_t state = seed;
		double nearest = INFINITY, weight = 1e-4;
		superquadric_points(&state, &ball, 4, POINTS, points);
		for (size_t i = 0; i < POINTS; i++)
			for (int c = 0; c < 3; c++)
				points[i][c] += uniform(&state, -0.02, 0.02) * (double)seed;
		assert_int_equal(fit(&ball, 4, (const double(*)[3])points, POINTS, &fitted), ESKEL_OK);
		for (int i = 0; i < 14; i++, weight *= 4)
			nearest = fmin(nearest, difference_from_oracle(&fitted, (const double(*)[3])points, weight));
		if (!(nearest < 1e-7))
			fail_msg("seed %d is %g off", (int)seed, nearest);
	}
}

/* A bent finger: what is within thickness of an arc of the unit circle. The nearest point of the arc, and its distance. */
static double nearest_of_arc(const double point[3], double nearest[3])
{
	const double x = point[0] + 0.6, y = point[1] + 0.6, end = 2.4;
	double angle = atan2(y, x);
	if (angle < 0 || angle > end)
		angle = cos(angle) > cos(angle - end) ? 0 : end;
	nearest[0] = cos(angle) - 0.6;
	nearest[1] = sin(angle) - 0.6;
	nearest[2] = 0;
	return sqrt(pow(point[0] - nearest[0], 2) + pow(point[1] - nearest[1], 2) + pow(point[2], 2));
}

static const double thickness = 0.3;

static void random_point(uint64_t *state, double point[3])
{
	for (int c = 0; c < 3; c++)
		point[c] = uniform(state, -2, 2);
}

static double share_of_wrong_sides(const esk_algebraic *fitted)
{
	enum { COUNT = 20000 };
	uint64_t state = 9;
	int wrong = 0;
	for (int i = 0; i < COUNT; i++) {
		double point[3], nearest[3], gradient[3];
		random_point(&state, point);
		wrong += (evaluate(fitted, point, gradient) < 0) != (nearest_of_arc(point, nearest) < thickness);
	}
	return (double)wrong / COUNT;
}

static void points_of_sides_keep_sheets_away(void **unused)
{
	(void)unused;
	enum { SIDES = 2000 };
	static double points[POINTS][3], sides[SIDES][3];
	static bool are_inside[SIDES];
	uint64_t state = 8;
	double nearest[3];
	for (int i = 0; i < POINTS; i++) {
		random_point(&state, points[i]);
		const double distance = nearest_of_arc(points[i], nearest);
		for (int c = 0; c < 3; c++)
			points[i][c] = nearest[c] + thickness / distance * (points[i][c] - nearest[c]);
	}
	for (int i = 0; i < SIDES; i++) {
		random_point(&state, sides[i]);
		are_inside[i] = nearest_of_arc(sides[i], nearest) < thickness;
	}
	esk_algebraic without, with;
	const esk_algebraic_points all = {
		POINTS, (const double(*)[3])points, SIDES, (const double(*)[3])sides, are_inside};
	assert_int_equal(fit(&ball, 6, (const double(*)[3])points, POINTS, &without), ESKEL_OK);
	assert_int_equal(esk_algebraic_fit(&ball, 6, &all, &with), ESKEL_OK);
	const double before = share_of_wrong_sides(&without), after = share_of_wrong_sides(&with);
	print_message("on the wrong side: %.4f, with sides %.4f\n", before, after);
	assert_true(after < 0.01 && 3 * after < before);
	assert_true(esk_algebraic_is_bounded(&with));
}

static void what_cannot_be_fitted_is_refused(void **unused)
{
	(void)unused;
	esk_algebraic fitted;
	const double point[1][3] = {{1, 2, 3}}, bad[1][3] = {{1, NAN, 3}};
	assert_int_equal(fit(&egg, 3, point, 1, &fitted), ESKEL_INVALID);
	assert_int_equal(fit(&egg, 8, point, 1, &fitted), ESKEL_INVALID);
	assert_int_equal(fit(&egg, 4, point, 0, &fitted), ESKEL_INVALID);
	assert_int_equal(fit(&egg, 4, bad, 1, &fitted), ESKEL_INVALID);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(surfaces_of_their_own_degree_are_found),
		cmocka_unit_test(gradients_are_those_of_the_values),
		cmocka_unit_test(boundedness_is_proven_or_refuted),
		cmocka_unit_test(whatever_the_points_the_surface_is_bounded),
		cmocka_unit_test(the_fit_is_the_least_squares_solution_of_one_of_the_weights),
		cmocka_unit_test(points_of_sides_keep_sheets_away),
		cmocka_unit_test(what_cannot_be_fitted_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
