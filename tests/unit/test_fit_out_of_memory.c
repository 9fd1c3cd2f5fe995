/* Lets the nth allocation of a fit fail, for n = 1, 2, 3 ... until there are no more. Each time the status must be
 * ESKEL_NO_MEMORY, the output untouched and, as a sanitizer sees, nothing leaked. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "failing_allocations.h"
#include "shapes.h"

#include <stdlib.h>

static void every_failed_allocation_of_a_fit_is_reported(void **state)
{
	(void)state;
	const shapes_rod rod = {{5, 5, 5}, {12, 7, 6}, 4, 3};
	const shapes_solid solid = {&rod, 1, 1, {16, 12, 11}};
	eskel_cloud *cloud = shapes_cloud(&solid, &shapes_identity);
	eskel_skeleton *skeleton = NULL;
	assert_int_equal(eskel_skeleton_new(cloud, &(eskel_skeleton_options){.levels = 2}, &skeleton, NULL), ESKEL_OK);
	for (int method = ESKEL_FIT_JOINT; method <= ESKEL_FIT_LEAST_SQUARES; method++) {
		const eskel_fit_options options = {.method = (eskel_fit_method)method,
			.freedom = ESKEL_FIT_ELLIPSOID,
			.boundary_points = 40,
			.hops = 1,
			.tabu_steps = 5};
		int failures = 0;
		for (bool failed = true; failed && failures < 1000; failures++) {
			eskel_error error = {0};
			eskel_reconstruction *r = NULL;
			failing_allocations_begin(failures);
			const eskel_status status = eskel_surface_fit(cloud, skeleton, 2, &options, &r, &error);
			failed = failing_allocations_end();
			assert_int_equal(status != ESKEL_OK, r == NULL);
			if (status && (!failed || status != ESKEL_NO_MEMORY || error.status != ESKEL_NO_MEMORY))
				fail_msg("allocation %d: %s (%s)", failures, eskel_status_text(status), error.text);
			eskel_reconstruction_free(r);
		}
		assert_in_range(failures, 40, 999);
	}
	eskel_skeleton_free(skeleton);
	eskel_cloud_free(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(every_failed_allocation_of_a_fit_is_reported)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
