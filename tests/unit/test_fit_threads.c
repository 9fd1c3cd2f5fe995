/* A fit has the same bits for any number of threads. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "shapes.h"

#include <stdlib.h>

static void assert_same_surfaces(const eskel_surface *a, const eskel_surface *b)
{
	uint8_t *bytes[2] = {NULL, NULL};
	size_t sizes[2];
	assert_int_equal(eskel_surface_encode(a, &bytes[0], &sizes[0]), ESKEL_OK);
	assert_int_equal(eskel_surface_encode(b, &bytes[1], &sizes[1]), ESKEL_OK);
	assert_int_equal(sizes[0], sizes[1]);
	assert_memory_equal(bytes[0], bytes[1], sizes[0]);
	free(bytes[0]);
	free(bytes[1]);
}

static void fits_are_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	const eskel_fit_method methods[] = {
		ESKEL_FIT_JOINT, ESKEL_FIT_TABU, ESKEL_FIT_HOPPING, ESKEL_FIT_LEAST_SQUARES};
	const eskel_skeleton_options levels = {.levels = 4};
	shapes_solid solid = shapes_hamate;
	eskel_skeleton *skeleton = NULL;
	solid.scale = 0.6;
	eskel_cloud *cloud = shapes_cloud(&solid, &shapes_identity);
	assert_int_equal(eskel_skeleton_new(cloud, &levels, &skeleton, NULL), ESKEL_OK);
	for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
		eskel_fit_options options = {
			.method = methods[m], .boundary_points = 300, .hops = 1, .tabu_steps = 50, .threads = 1};
		eskel_reconstruction *one = NULL, *three = NULL;
		assert_int_equal(eskel_surface_fit(cloud, skeleton, 4, &options, &one, NULL), ESKEL_OK);
		options.threads = 3;
		assert_int_equal(eskel_surface_fit(cloud, skeleton, 4, &options, &three, NULL), ESKEL_OK);
		assert_same_surfaces(one->surface, three->surface);
		assert_memory_equal(&one->after, &three->after, sizeof one->after);
		eskel_reconstruction_free(one);
		eskel_reconstruction_free(three);
	}
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(fits_are_the_same_for_any_number_of_threads)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
