#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "rotation.h"
#include "skeletons.h"
#include "synthetic.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

static double determinant(const double m[3][3])
{
	return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
	       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* sum w_i a_i . R b_i = the sum of products of entries of R and the correlation: what the fit makes greatest. */
static double gain(const double rotation[3][3], const double correlation[3][3])
{
	double sum = 0;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			sum += rotation[r][c] * correlation[r][c];
	return sum;
}

/* Kabsch: the greatest gain of a proper rotation is s_1 + s_2 + s_3 sign(det), by singular values. */
static double greatest_gain(const double correlation[3][3])
{
	double copy[3][3], s[3], u[9], vt[9], superb[2];
	memcpy(copy, correlation, sizeof copy);
	assert_int_equal(LAPACKE_dgesvd(LAPACK_ROW_MAJOR, 'N', 'N', 3, 3, &copy[0][0], 3, s, u, 3, vt, 3, superb), 0);
	return s[0] + s[1] + copysign(s[2], determinant(correlation));
}

/* In one of the lanes, by turns; 0 in the others. */
static void fit(const double correlation[3][3], double rotation[3][3])
{
	static int lane;
	esk_lanes in[3][3] = {{{0}}}, out[3][3];
	lane = (lane + 1) % ESK_LANES;
	for (int e = 0; e < 9; e++)
		in[e / 3][e % 3][lane] = correlation[e / 3][e % 3];
	esk_rotation_fit((const esk_lanes(*)[3])in, out);
	for (int e = 0; e < 9; e++)
		rotation[e / 3][e % 3] = out[e / 3][e % 3][lane];
}

static void assert_fit_is_best(const double correlation[3][3])
{
	double rotation[3][3];
	fit(correlation, rotation);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			double dot = 0;
			for (int i = 0; i < 3; i++)
				dot += rotation[r][i] * rotation[c][i];
			if (fabs(dot - (r == c)) > 1e-14)
				fail_msg("rows %d and %d have the product %.17g", r, c, dot);
		}
	double found = determinant((const double(*)[3])rotation);
	if (fabs(found - 1) > 1e-14)
		fail_msg("the determinant is %.17g, expected 1", found);
	double best = greatest_gain(correlation);
	found = gain((const double(*)[3])rotation, correlation);
	if (!(fabs(found - best) <= 1e-14 * fabs(best) + 1e-300))
		fail_msg("the gain is %.17g, the greatest %.17g", found, best);
}

static void random_correlation(uint64_t *random, double correlation[3][3])
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			correlation[r][c] = 2 * synthetic_uniform(random) - 1;
}

static void a_fit_equals_the_singular_value_solution(void **state)
{
	(void)state;
	uint64_t random = 1;
	for (int i = 0; i < 1000; i++) {
		double correlation[3][3];
		random_correlation(&random, correlation);
		assert_fit_is_best((const double(*)[3])correlation);
	}
}

static void turned_points_are_turned_back(void **state)
{
	(void)state;
	uint64_t random = 2;
	for (int i = 0; i < 100; i++) {
		double expected[3][3], found[3][3], correlation[3][3] = {{0}};
		skeletons_rotation(&random, expected);
		for (int p = 0; p < 5; p++) {
			double b[3], a[3];
			for (int r = 0; r < 3; r++)
				b[r] = synthetic_uniform(&random) - 0.5;
			for (int r = 0; r < 3; r++) {
				a[r] = expected[r][0] * b[0] + expected[r][1] * b[1] + expected[r][2] * b[2];
				for (int c = 0; c < 3; c++)
					correlation[r][c] += a[r] * b[c];
			}
		}
		fit((const double(*)[3])correlation, found);
		for (int e = 0; e < 9; e++)
			if (fabs(found[e / 3][e % 3] - expected[e / 3][e % 3]) > 1e-11)
				fail_msg("entry %d is %.17g, expected %.17g", e, found[e / 3][e % 3],
					expected[e / 3][e % 3]);
	}
}

static void flat_collinear_mirrored_and_isotropic_points_have_a_best_rotation(void **state)
{
	(void)state;
	static const double special[][3][3] = {
		{{1, 0, 0}, {0, 0, 0}, {0, 0, 0}},
		{{0, 2, 0}, {0, 0, 0}, {0, 0, 0}},
		{{1, 2, 3}, {2, 4, 6}, {3, 6, 9}},
		{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}},
		{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
		{{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
		{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}},
		{{1, 0, 0}, {0, 1e-9, 0}, {0, 0, 1e-9}},
		{{1, 0, 0}, {0, -1 + 1e-12, 0}, {0, 0, 1e-12}},
	};
	for (size_t i = 0; i < sizeof special / sizeof special[0]; i++)
		assert_fit_is_best(special[i]);
}

static void no_correlation_gives_the_identity(void **state)
{
	(void)state;
	const double none[3][3] = {{0}}, identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	double rotation[3][3];
	fit(none, rotation);
	assert_memory_equal(rotation, identity, sizeof identity);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_fit_equals_the_singular_value_solution),
		cmocka_unit_test(turned_points_are_turned_back),
		cmocka_unit_test(flat_collinear_mirrored_and_isotropic_points_have_a_best_rotation),
		cmocka_unit_test(no_correlation_gives_the_identity),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
