#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eigen.h"
#include "synthetic.h"

#include <math.h>
#include <string.h>

/* rotation^T diag(values) rotation: its axes are the rows of rotation. */
static void compose(const double values[3], const double rotation[3][3], double matrix[3][3])
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			matrix[r][c] = 0;
			for (int i = 0; i < 3; i++)
				matrix[r][c] += values[i] * rotation[i][r] * rotation[i][c];
		}
}

static void rotation_about(const double axis[3], double angle, double rotation[3][3])
{
	double n = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
	const double a[3] = {axis[0] / n, axis[1] / n, axis[2] / n};
	const double cross[3][3] = {{0, -a[2], a[1]}, {a[2], 0, -a[0]}, {-a[1], a[0], 0}};
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			rotation[r][c] =
				(r == c) * cos(angle) + (1 - cos(angle)) * a[r] * a[c] + sin(angle) * cross[r][c];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void assert_frame(const esk_eigen *eigen)
{
	const double(*a)[3] = (const double(*)[3])eigen->axes;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			if (fabs(dot(a[i], a[j]) - (i == j)) > 1e-14)
				fail_msg("axes %d and %d have the product %.17g", i, j, dot(a[i], a[j]));
	double handed = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
			a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
			a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
	if (handed < 0.99)
		fail_msg("the axes have the determinant %.17g", handed);
	for (int i = 0; i < 2; i++) {
		int greatest = 0;
		for (int c = 1; c < 3; c++)
			if (fabs(a[i][c]) > fabs(a[i][greatest]))
				greatest = c;
		assert_true(a[i][greatest] > 0);
	}
}

static void assert_axis(const double found[3], double x, double y, double z)
{
	const double expected[3] = {x, y, z};
	double cosine = fabs(dot(found, expected)) / sqrt(dot(expected, expected));
	if (cosine < 1 - 1e-12)
		fail_msg("the axis is %g %g %g, expected %g %g %g", found[0], found[1], found[2], x, y, z);
}

static esk_eigen solve(const double matrix[3][3])
{
	esk_eigen eigen;
	assert_int_equal(esk_eigen_symmetric(matrix, &eigen), ESKEL_OK);
	assert_frame(&eigen);
	return eigen;
}

/* The oracle is the cyclic Jacobi method. This is the rotation of rows and columns p and q that annihilates a[p][q]; the rows of v follow. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
	double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
	double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
	double c = 1 / sqrt(t * t + 1), s = t * c;
	int r = 3 - p - q; /* the third index */
	a[p][p] -= t * a[p][q];
	a[q][q] += t * a[p][q];
	a[p][q] = a[q][p] = 0;
	double rp = a[r][p], rq = a[r][q];
	a[r][p] = a[p][r] = c * rp - s * rq;
	a[r][q] = a[q][r] = s * rp + c * rq;
	for (int i = 0; i < 3; i++) {
		double vp = v[p][i], vq = v[q][i];
		v[p][i] = c * vp - s * vq;
		v[q][i] = s * vp + c * vq;
	}
}

/* An entry that cannot change either diagonal entry any more is 0. */
static bool is_negligible(const double a[3][3], int p, int q)
{
	double tiny = fabs(a[p][q]) * 0x1p-10;
	return fabs(a[p][p]) + tiny == fabs(a[p][p]) && fabs(a[q][q]) + tiny == fabs(a[q][q]);
}

/* a becomes diagonal, the rows of v its axes. */
static bool diagonalise(double a[3][3], double v[3][3])
{
	for (int sweep = 0; sweep < 40; sweep++) {
		bool rotated = false;
		for (int p = 0; p < 2; p++)
			for (int q = p + 1; q < 3; q++) {
				if (is_negligible((const double(*)[3])a, p, q)) {
					a[p][q] = a[q][p] = 0;
					continue;
				}
				rotate(a, v, p, q);
				rotated = true;
			}
		if (!rotated)
			return true;
	}
	return false;
}

static void random_matrices_have_the_values_and_axes_that_jacobi_rotations_find(void **state)
{
	(void)state;
	uint64_t random = 1;
	for (int n = 0; n < 2000; n++) {
		double b[3][3], matrix[3][3], a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
		const double stretch = pow(10, 6 * synthetic_uniform(&random) - 3);
		for (int i = 0; i < 9; i++)
			b[i / 3][i % 3] = (i / 3 == 0 ? stretch : 1) * (synthetic_uniform(&random) - 0.5);
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				a[r][c] = matrix[r][c] = b[0][r] * b[0][c] + b[1][r] * b[1][c] + b[2][r] * b[2][c];
		assert_true(diagonalise(a, v));
		esk_eigen eigen = solve((const double(*)[3])matrix);
		for (int i = 0; i < 3; i++) {
			int same = 0; /* Jacobi's values are in no order */
			double gap = INFINITY;
			for (int j = 1; j < 3; j++)
				if (fabs(a[j][j] - eigen.values[i]) < fabs(a[same][same] - eigen.values[i]))
					same = j;
			for (int j = 0; j < 3; j++)
				if (j != i)
					gap = fmin(gap, fabs(eigen.values[i] - eigen.values[j]));
			if (fabs(eigen.values[i] - a[same][same]) > 1e-13 * eigen.values[0])
				fail_msg("value %d is %.17g, Jacobi finds %.17g", i, eigen.values[i], a[same][same]);
			if (gap > 1e-3 * eigen.values[0])
				assert_axis(eigen.axes[i], v[same][0], v[same][1], v[same][2]);
		}
	}
}

static void known_rotations_are_found(void **state)
{
	(void)state;
	const double values[3] = {9, 4, 1}, axis[3] = {1, -2, 3};
	for (int degrees = 0; degrees < 360; degrees += 15) {
		double rotation[3][3], matrix[3][3];
		rotation_about(axis, degrees * 3.14159265358979323846 / 180, rotation);
		compose(values, (const double(*)[3])rotation, matrix);
		esk_eigen eigen = solve((const double(*)[3])matrix);
		for (int i = 0; i < 3; i++) {
			assert_true(fabs(eigen.values[i] - values[i]) < 1e-13);
			assert_axis(eigen.axes[i], rotation[i][0], rotation[i][1], rotation[i][2]);
		}
		assert_false(esk_eigen_is_degenerate(&eigen));
	}
}

static void a_diagonal_matrix_has_coordinate_axes_in_descending_order(void **state)
{
	(void)state;
	const double matrix[3][3] = {{1, 0, 0}, {0, 9, 0}, {0, 0, 4}};
	esk_eigen eigen = solve(matrix);
	assert_true(eigen.values[0] == 9 && eigen.values[1] == 4 && eigen.values[2] == 1);
	assert_true(eigen.axes[0][1] == 1 && eigen.axes[1][2] == 1 && eigen.axes[2][0] == 1);
}

static void a_ball_has_the_coordinate_axes_and_is_degenerate(void **state)
{
	(void)state;
	const double matrix[3][3] = {{5, 1e-9, 0}, {1e-9, 5 + 1e-8, -1e-9}, {0, -1e-9, 5}};
	esk_eigen eigen = solve(matrix);
	assert_true(esk_eigen_is_degenerate(&eigen));
	for (int i = 0; i < 3; i++)
		assert_true(eigen.axes[i][i] == 1);
}

static void a_tilted_disc_has_a_documented_axis_in_its_plane(void **state)
{
	(void)state;
	const double values[3] = {4, 4, 1}, axis[3] = {0, 1, 0};
	double rotation[3][3], matrix[3][3];
	rotation_about(axis, 0.3, rotation);
	compose(values, (const double(*)[3])rotation, matrix);
	esk_eigen eigen = solve((const double(*)[3])matrix);
	assert_true(esk_eigen_is_degenerate(&eigen));
	assert_axis(eigen.axes[2], rotation[2][0], rotation[2][1], rotation[2][2]);
	assert_axis(eigen.axes[0], cos(0.3), 0, rotation[2][0] > 0 ? -sin(0.3) : sin(0.3)); /* x projected */
}

static void a_tilted_rod_has_its_own_axis_and_a_documented_second_one(void **state)
{
	(void)state;
	const double values[3] = {4, 1, 1}, axis[3] = {0, 0, 1};
	double rotation[3][3], matrix[3][3];
	rotation_about(axis, 0.4, rotation);
	compose(values, (const double(*)[3])rotation, matrix);
	esk_eigen eigen = solve((const double(*)[3])matrix);
	assert_false(esk_eigen_is_degenerate(&eigen));
	assert_axis(eigen.axes[0], rotation[0][0], rotation[0][1], rotation[0][2]);
	/* x is too near the rod, y is projected */
	assert_axis(eigen.axes[1], rotation[1][0], rotation[1][1], rotation[1][2]);
}

static void equal_but_for_a_float_s_rounding_is_degenerate_and_more_is_not(void **state)
{
	(void)state;
	double matrix[3][3] = {{1, 0, 0}, {0, 1 + 0x1p-22, 0}, {0, 0, 0.5}};
	esk_eigen eigen = solve((const double(*)[3])matrix);
	assert_true(esk_eigen_is_degenerate(&eigen));
	matrix[1][1] = 1 + 2e-6;
	eigen = solve((const double(*)[3])matrix);
	assert_false(esk_eigen_is_degenerate(&eigen));
}

static void a_flat_matrix_has_an_eigenvalue_of_exactly_0_at_any_tilt(void **state)
{
	(void)state;
	const double values[3] = {9, 4, 0}, axis[3] = {1, 2, -1};
	for (int i = 0; i < 50; i++) {
		double rotation[3][3], matrix[3][3];
		rotation_about(axis, 0.1 * i, rotation);
		compose(values, (const double(*)[3])rotation, matrix);
		esk_eigen eigen = solve((const double(*)[3])matrix);
		if (eigen.values[2] != 0)
			fail_msg("at %d the least eigenvalue is %g", i, eigen.values[2]);
	}
}

static void the_zero_matrix_is_a_degenerate_point(void **state)
{
	(void)state;
	const double matrix[3][3] = {{0}};
	esk_eigen eigen = solve(matrix);
	assert_true(esk_eigen_is_degenerate(&eigen));
	assert_true(eigen.values[0] == 0 && eigen.axes[0][0] == 1);
}

static void a_mirrored_matrix_has_mirrored_axes(void **state)
{
	(void)state;
	const double matrix[3][3] = {{5, 1, 0.5}, {1, 4, -0.25}, {0.5, -0.25, 3}};
	const double mirrored[3][3] = {{5, -1, -0.5}, {-1, 4, -0.25}, {-0.5, -0.25, 3}};
	esk_eigen a = solve(matrix), b = solve(mirrored);
	for (int i = 0; i < 3; i++) {
		assert_true(a.values[i] == b.values[i]);
		assert_axis(b.axes[i], -a.axes[i][0], a.axes[i][1], a.axes[i][2]);
	}
}

static void a_matrix_that_is_not_finite_is_refused_untouched(void **state)
{
	(void)state;
	double matrix[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	esk_eigen eigen = {.values = {7}};
	matrix[0][2] = NAN;
	assert_int_equal(esk_eigen_symmetric((const double(*)[3])matrix, &eigen), ESKEL_NUMERIC);
	matrix[0][2] = INFINITY;
	assert_int_equal(esk_eigen_symmetric((const double(*)[3])matrix, &eigen), ESKEL_NUMERIC);
	assert_true(eigen.values[0] == 7);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(random_matrices_have_the_values_and_axes_that_jacobi_rotations_find),
		cmocka_unit_test(known_rotations_are_found),
		cmocka_unit_test(a_diagonal_matrix_has_coordinate_axes_in_descending_order),
		cmocka_unit_test(a_ball_has_the_coordinate_axes_and_is_degenerate),
		cmocka_unit_test(a_tilted_disc_has_a_documented_axis_in_its_plane),
		cmocka_unit_test(a_tilted_rod_has_its_own_axis_and_a_documented_second_one),
		cmocka_unit_test(equal_but_for_a_float_s_rounding_is_degenerate_and_more_is_not),
		cmocka_unit_test(a_flat_matrix_has_an_eigenvalue_of_exactly_0_at_any_tilt),
		cmocka_unit_test(the_zero_matrix_is_a_degenerate_point),
		cmocka_unit_test(a_mirrored_matrix_has_mirrored_axes),
		cmocka_unit_test(a_matrix_that_is_not_finite_is_refused_untouched),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
