#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "affine.h"

#include <math.h>
#include <string.h>

static const eskel_affine sheared = {{{0.5, 0.1, 0, 7}, {0, -2, 0.3, -8}, {0, 0.2, 3, 9}}};

static void an_oblique_left_handed_affine_is_accepted(void **state)
{
	(void)state;
	assert_int_equal(eskel_affine_check(&sheared, NULL), ESKEL_OK);
	assert_true(eskel_affine_determinant(&sheared) < 0);
}

static void a_singular_affine_is_refused_with_its_relative_determinant(void **state)
{
	(void)state;
	eskel_affine singular = {{{1, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 0}}};
	eskel_error error;
	assert_int_equal(eskel_affine_check(&singular, &error), ESKEL_BAD_GEOMETRY);
	assert_non_null(strstr(error.text, "|det| is 0 "));
}

static void a_non_finite_entry_is_refused_by_its_place(void **state)
{
	(void)state;
	eskel_affine broken = sheared;
	broken.m[1][3] = NAN;
	eskel_error error;
	assert_int_equal(eskel_affine_check(&broken, &error), ESKEL_BAD_GEOMETRY);
	assert_non_null(strstr(error.text, "row 1, column 3"));
}

static void a_spacing_outside_its_range_is_refused(void **state)
{
	(void)state;
	eskel_affine huge = {{{1, 0, 0, 0}, {0, 20000, 0, 0}, {0, 0, 1, 0}}};
	eskel_error error;
	assert_int_equal(eskel_affine_check(&huge, &error), ESKEL_BAD_GEOMETRY);
	assert_non_null(strstr(error.text, "axis 1 is 20000 mm"));
}

static void congruence_equals_the_covariance_of_mapped_points(void **state)
{
	(void)state;
	/* The four points +-u, +-v have covariance (u u^T + v v^T) / 2 in either space. */
	const double u[3] = {3, -1, 2}, v[3] = {0, 5, 1}, origin[3] = {0, 0, 0};
	double wu[3], wv[3], wo[3], index[3][3], world[3][3];
	esk_affine_apply(&sheared, u, wu);
	esk_affine_apply(&sheared, v, wv);
	esk_affine_apply(&sheared, origin, wo);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			index[r][c] = (u[r] * u[c] + v[r] * v[c]) / 2;
	esk_affine_congruence(&sheared, (const double(*)[3])index, world);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			double expected = ((wu[r] - wo[r]) * (wu[c] - wo[c]) + (wv[r] - wo[r]) * (wv[c] - wo[c])) / 2;
			if (fabs(world[r][c] - expected) > 1e-12 * fabs(expected) + 1e-12)
				fail_msg("entry %d,%d is %.17g, expected %.17g", r, c, world[r][c], expected);
			assert_true(world[r][c] == world[c][r]);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_oblique_left_handed_affine_is_accepted),
		cmocka_unit_test(a_singular_affine_is_refused_with_its_relative_determinant),
		cmocka_unit_test(a_non_finite_entry_is_refused_by_its_place),
		cmocka_unit_test(a_spacing_outside_its_range_is_refused),
		cmocka_unit_test(congruence_equals_the_covariance_of_mapped_points),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
