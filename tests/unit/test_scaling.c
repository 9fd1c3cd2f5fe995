#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "distances_oracle.h"
#include "eskel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST = 120 };
static double distances[MOST * MOST], points[MOST][2];

static void points_are_those_of_numpy(void **state)
{
	(void)state;
	static const size_t counts[] = {3, 4, 9, 30, 120};
	enum { MAPS = sizeof counts / sizeof *counts };
	static double found[MAPS][MOST][2];
	uint64_t seed = 17;
	char path[] = "/tmp/eskel-scaling-XXXXXX", line[200];
	FILE *file = fdopen(mkstemp(path), "w");
	assert_non_null(file);
	for (size_t m = 0; m < MAPS; m++) {
		random_distances(&seed, counts[m], 5, distances);
		write_matrix(file, counts[m], distances);
		assert_int_equal(eskel_scaling(distances, counts[m], found[m]), ESKEL_OK);
	}
	fclose(file);
	FILE *oracle = ask_oracle("scaling", path);
	size_t read = 0;
	for (size_t m = 0; m < MAPS; m++) {
		double expected[MOST][2], sign[2] = {0, 0}, largest[2] = {0, 0};
		for (size_t i = 0; i < counts[m] && fgets(line, sizeof line, oracle); i++, read++)
			assert_int_equal(sscanf(line, "%lf %lf", &expected[i][0], &expected[i][1]), 2);
		for (size_t i = 0; read > 0 && i < counts[m]; i++) /* the oracle's largest value is positive */
			for (int axis = 0; axis < 2; axis++)
				if (fabs(found[m][i][axis]) > largest[axis]) {
					largest[axis] = fabs(found[m][i][axis]);
					sign[axis] = found[m][i][axis] < 0 ? -1 : 1;
				}
		for (size_t i = 0; read > 0 && i < counts[m]; i++)
			for (int axis = 0; axis < 2; axis++)
				if (fabs(sign[axis] * found[m][i][axis] - expected[i][axis]) > 1e-9)
					fail_msg("%zu shapes, point %zu: %.15g, NumPy %.15g", counts[m], i,
						found[m][i][axis], expected[i][axis]);
	}
	pclose(oracle);
	remove(path);
	if (read == 0)
		skip();
	assert_int_equal(read, 166);
}

static void check_signs(size_t count)
{
	for (int axis = 0; axis < 2; axis++) {
		double largest = 0;
		size_t i = 0;
		for (size_t n = 0; n < count; n++)
			largest = fmax(largest, fabs(points[n][axis]));
		while (i < count - 1 && fabs(points[i][axis]) < 0.65 * largest)
			i++;
		assert_true(points[i][axis] >= 0);
	}
}

static void points_of_a_plane_keep_their_distances(void **state)
{
	(void)state;
	uint64_t seed = 23;
	for (size_t n = 2; n <= 50; n += 3) {
		random_distances(&seed, n, n % 2 ? 2 : 1, distances);
		assert_int_equal(eskel_scaling(distances, n, points), ESKEL_OK);
		check_signs(n);
		double spread[2] = {0, 0};
		for (size_t i = 0; i < n; i++) {
			spread[0] += points[i][0] * points[i][0];
			spread[1] += points[i][1] * points[i][1];
			assert_true(n % 2 || points[i][1] == 0); /* a line has one coordinate */
			for (size_t j = 0; j < n; j++)
				assert_true(fabs(hypot(points[i][0] - points[j][0], points[i][1] - points[j][1]) -
						    distances[i * n + j]) < 1e-7);
		}
		assert_true(spread[0] >= spread[1]);
	}
}

/* An equilateral triangle and a square have two equal eigenvalues: the first shape decides. */
static void equal_spreads_are_turned_to_the_first_shape(void **state)
{
	(void)state;
	const double triangle[9] = {0, 1, 1, 1, 0, 1, 1, 1, 0};
	assert_int_equal(eskel_scaling(triangle, 3, points), ESKEL_OK);
	assert_true(fabs(points[0][0] - 1 / sqrt(3)) < 1e-12 && fabs(points[0][1]) < 1e-12);
	assert_true(fabs(points[1][0] + 0.5 / sqrt(3)) < 1e-12 && fabs(points[1][1] - 0.5) < 1e-12);
	const double d = sqrt(2), square[16] = {0, 1, d, 1, 1, 0, 1, d, d, 1, 0, 1, 1, d, 1, 0};
	assert_int_equal(eskel_scaling(square, 4, points), ESKEL_OK);
	assert_true(fabs(points[0][0] - d / 2) < 1e-12 && fabs(points[2][0] + d / 2) < 1e-12);
	assert_true(fabs(points[1][1] - d / 2) < 1e-12 && fabs(points[3][1] + d / 2) < 1e-12);
}

static void few_and_equal_shapes_lie_at_the_centre(void **state)
{
	(void)state;
	const double nothing[9] = {0};
	assert_int_equal(eskel_scaling(NULL, 0, NULL), ESKEL_OK);
	for (size_t n = 1; n <= 3; n++) {
		memset(points, 1, sizeof points);
		assert_int_equal(eskel_scaling(nothing, n, points), ESKEL_OK);
		for (size_t i = 0; i < n; i++)
			assert_true(points[i][0] == 0 && points[i][1] == 0);
	}
	const double two[4] = {0, 3, 3, 0};
	assert_int_equal(eskel_scaling(two, 2, points), ESKEL_OK);
	assert_true(fabs(points[0][0] - 1.5) < 1e-12 && fabs(points[1][0] + 1.5) < 1e-12 && points[0][1] == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_are_those_of_numpy),
		cmocka_unit_test(points_of_a_plane_keep_their_distances),
		cmocka_unit_test(equal_spreads_are_turned_to_the_first_shape),
		cmocka_unit_test(few_and_equal_shapes_lie_at_the_centre),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
