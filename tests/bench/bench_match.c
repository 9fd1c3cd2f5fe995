/* Time of a matching: bench_match [seconds per figure, default 0.3]
 *
 * "solve" is the assignment alone, on costs between classes of synthetic shapes; "with costs" is all of D_k, from stored
 * features on; "uniform" is the assignment of uniformly random costs, which has more augmenting paths to find. */
#include "assignment.h"
#include "distance.h"
#include "measure.h"
#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { shapes = 64 };

/* Sums over classes, so that nothing is left out as unused. */
static double checksum;

static double time_with_costs(const esk_query *queries, uint32_t k, double seconds)
{
	double start = measure_milliseconds();
	size_t done = 0;
	for (; measure_milliseconds() - start < 1e3 * seconds; done += shapes)
		for (uint32_t n = 0; n < shapes; n++)
			checksum += esk_query_level(&queries[n], queries[(n * 7 + 5) % shapes].shape, k);
	return 1e3 * (measure_milliseconds() - start) / (double)done;
}

static double time_solve(const float *costs, uint32_t k, double seconds)
{
	double start = measure_milliseconds();
	size_t done = 0;
	uint32_t column_of_row[ESKEL_LEVELS_MAX];
	for (; measure_milliseconds() - start < 1e3 * seconds; done += shapes)
		for (uint32_t n = 0; n < shapes; n++)
			checksum += esk_assignment_solve(k, costs + n * k * k, column_of_row);
	return 1e3 * (measure_milliseconds() - start) / (double)done;
}

static void fill_class_costs(const esk_query *queries, uint32_t k, float *costs)
{
	for (uint32_t n = 0; n < shapes; n++) {
		const float *a = queries[n].rows[k - 1], *b = queries[(n * 7 + 5) % shapes].rows[k - 1];
		for (uint32_t i = 0; i < k; i++)
			for (uint32_t j = 0; j < k; j++) {
				float cost = 0;
				for (uint32_t c = 0; c < ESKEL_SIGNATURE_NUMBERS; c++)
					cost += fabsf(a[c * k + i] - b[c * k + j]);
				*costs++ = cost;
			}
	}
}

int main(int count, char **arguments)
{
	static const uint32_t levels[] = {4, 10, 16, 32, 64};
	const double seconds = count > 1 ? atof(arguments[1]) : 0.3;
	static esk_query queries[shapes];
	static float costs[shapes * ESKEL_LEVELS_MAX * ESKEL_LEVELS_MAX];
	esk_shape *made[shapes] = {NULL};
	uint64_t random = 1;
	for (uint32_t n = 0; n < shapes; n++) {
		eskel_signature *signature = synthetic_signature(n / 4, n, 0.3, ESKEL_LEVELS_MAX);
		if (esk_shape_new(signature, &made[n]) != ESKEL_OK ||
			esk_query_init(&queries[n], made[n], NULL) != ESKEL_OK)
			return 1;
		eskel_signature_free(signature);
	}
	puts("microseconds    k   solve  with costs  uniform");
	for (size_t l = 0; l < sizeof levels / sizeof *levels; l++) {
		const uint32_t k = levels[l];
		fill_class_costs(queries, k, costs);
		double solve = time_solve(costs, k, seconds), whole = time_with_costs(queries, k, seconds);
		for (size_t n = 0; n < (size_t)shapes * k * k; n++)
			costs[n] = (float)synthetic_uniform(&random);
		double uniform = time_solve(costs, k, seconds);
		printf("             %4u %7.3f     %7.3f  %7.3f\n", k, solve, whole, uniform);
	}
	for (uint32_t n = 0; n < shapes; n++) {
		esk_query_clear(&queries[n]);
		esk_shape_release(made[n]);
	}
	printf("peak memory %.1f MB, checksum %g\n", measure_peak_megabytes(), checksum);
	return 0;
}
