/* Time of a matching: bench_match FILE...
 *
 * A file KIND-K holds matrices of K x K costs (bench_inputs.c). "eskel" is the assignment alone; "eskel, costs included"
 * is all of D_K, from stored features on; the textbook's costs must come out the same. */
#include "assignment.h"
#include "distance.h"
#include "measure.h"
#include "peers/textbook_assignment.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MATRICES = 64 };
static const double milliseconds = 200; /* spent on each figure */

/* Sums over classes, so that nothing is left out as unused. */
static double checksum;

static void fail(const char *what)
{
	fprintf(stderr, "bench_match: %s\n", what);
	exit(1);
}

static double solve(uint32_t k, const float *costs)
{
	uint32_t column_of_row[ESKEL_LEVELS_MAX];
	return esk_assignment_solve(k, costs, column_of_row);
}

static double solve_as_textbooks(uint32_t k, const float *costs)
{
	return textbook_assignment((int)k, costs);
}

/* Microseconds. */
static double time_solver(double (*solver)(uint32_t k, const float *costs), uint32_t k, const float *costs)
{
	const double start = measure_milliseconds();
	size_t done = 0;
	for (; measure_milliseconds() - start < milliseconds; done += MATRICES)
		for (uint32_t n = 0; n < MATRICES; n++)
			checksum += solver(k, costs + n * k * k);
	return 1e3 * (measure_milliseconds() - start) / (double)done;
}

static double time_with_costs(const esk_query *queries, uint32_t k)
{
	const double start = measure_milliseconds();
	size_t done = 0;
	for (; measure_milliseconds() - start < milliseconds; done += MATRICES)
		for (uint32_t n = 0; n < MATRICES; n++)
			checksum += esk_query_level(&queries[n], queries[(n * 7 + 5) % MATRICES].shape, k);
	return 1e3 * (measure_milliseconds() - start) / (double)done;
}

static void compare(uint32_t k, const float *costs)
{
	for (uint32_t n = 0; n < MATRICES; n++)
		if (fabs(solve(k, costs + n * k * k) - textbook_assignment((int)k, costs + n * k * k)) > 1e-4)
			fail("the textbook's assignment costs another sum");
}

static void report(const char *path, const esk_query *queries)
{
	static float costs[MATRICES * ESKEL_LEVELS_MAX * ESKEL_LEVELS_MAX];
	const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path, *dash = strchr(name, '-');
	const uint32_t k = dash ? (uint32_t)atoi(dash + 1) : 0;
	FILE *file = fopen(path, "rb");
	if (k < 1 || k > ESKEL_LEVELS_MAX || !file || fread(costs, sizeof *costs * k * k, MATRICES, file) != MATRICES)
		fail(path);
	fclose(file);
	char figure[64];
	snprintf(figure, sizeof figure, "match-%.*s/k=%u", (int)(dash - name), name, k);
	compare(k, costs);
	measure_print(figure, "eskel", time_solver(solve, k, costs), "us");
	measure_print(figure, "eskel", measure_peak_megabytes(), "MB");
	if (!strncmp(name, "classes", 7))
		measure_print(figure, "eskel, costs included", time_with_costs(queries, k), "us");
	measure_print(figure, "textbook in C", time_solver(solve_as_textbooks, k, costs), "us");
}

int main(int argc, char **argv)
{
	static esk_query queries[MATRICES];
	esk_shape *shapes[MATRICES] = {NULL};
	for (uint32_t n = 0; n < MATRICES; n++) {
		eskel_signature *signature = synthetic_signature(n / 4, n, 0.3, ESKEL_LEVELS_MAX);
		if (esk_shape_new(signature, &shapes[n]) || esk_query_init(&queries[n], shapes[n], NULL))
			fail("no shapes");
		eskel_signature_free(signature);
	}
	for (int i = 1; i < argc; i++)
		report(argv[i], queries);
	for (uint32_t n = 0; n < MATRICES; n++) {
		esk_query_clear(&queries[n]);
		esk_shape_release(shapes[n]);
	}
	fprintf(stderr, "checksum %g\n", checksum);
	return 0;
}
