/* Time of a search: bench_search [shapes, default 100000] [queries, default 40]
 *
 * A library of synthetic shapes in clusters of twenty; queries are further members of a cluster. */
#include "eskel.h"
#include "measure.h"
#include "synthetic.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double noise = 0.15;
enum { members = 20 };

static eskel_library *fill(size_t shapes)
{
	eskel_library *library = NULL;
	if (eskel_library_new(&library) != ESKEL_OK)
		exit(1);
	double adding = 0, before = measure_peak_megabytes();
	for (size_t n = 0; n < shapes; n++) {
		eskel_signature *signature = synthetic_signature(n / members, n, noise, 16);
		double start = measure_milliseconds();
		if (eskel_library_add(library, (int64_t)n, signature) != ESKEL_OK)
			exit(1);
		adding += measure_milliseconds() - start;
		eskel_signature_free(signature);
	}
	printf("%zu shapes added in %.2f s, %.0f bytes each\n", shapes, adding / 1e3,
		(measure_peak_megabytes() - before) * 1048576 / (double)shapes);
	return library;
}

typedef struct {
	double spent, slowest; /* ms */
	double compared, kept[3];
} total;

static eskel_search_result *search(
	const eskel_library *library, const eskel_signature *query, const eskel_search_options *options, total *t)
{
	eskel_search_result *result = NULL;
	double start = measure_milliseconds();
	if (eskel_library_search(library, query, options, &result) != ESKEL_OK)
		exit(1);
	double spent = measure_milliseconds() - start;
	t->spent += spent;
	t->slowest = spent > t->slowest ? spent : t->slowest;
	t->compared += (double)result->compared;
	for (int step = 0; step < 3; step++)
		t->kept[step] += (double)result->kept[step];
	return result;
}

static void print_row(const char *mode, const total *t, int queries)
{
	printf("  %-6s %9.3f %9.3f %10.0f %9.0f %9.0f %9.0f\n", mode, t->spent / queries, t->slowest,
		t->kept[0] / queries, t->kept[1] / queries, t->kept[2] / queries, t->compared / queries);
}

static void measure(const eskel_library *library, size_t shapes, int queries, eskel_signature_kind signature,
	eskel_distance_kind kind)
{
	total pruned = {0}, exact = {0};
	int same_nearest = 0, same_five = 0;
	printf("%s signature, %s\n", signature == ESKEL_SIGNATURE_LOG ? "log" : "paper",
		kind == ESKEL_DISTANCE_SUM ? "sum over levels" : "level 10");
	for (int q = 0; q < queries; q++) {
		size_t cluster = (size_t)q * 7919 % (shapes / members + 1);
		eskel_signature *query = synthetic_signature(cluster, shapes + (size_t)q, noise, 16);
		eskel_search_options options = {
			.distance = {.signature = signature, .distance = kind}, .mode = ESKEL_SEARCH_PRUNED};
		eskel_search_result *found = search(library, query, &options, &pruned);
		options.mode = ESKEL_SEARCH_EXACT;
		eskel_search_result *best = search(library, query, &options, &exact);
		same_nearest += found->neighbours[0].key == best->neighbours[0].key;
		for (size_t i = 0; i < best->count; i++)
			for (size_t j = 0; j < found->count; j++)
				same_five += best->neighbours[i].key == found->neighbours[j].key;
		eskel_search_result_free(found);
		eskel_search_result_free(best);
		eskel_signature_free(query);
	}
	print_row("pruned", &pruned, queries);
	print_row("exact", &exact, queries);
	printf("  recall of pruned: nearest %.3f, five nearest %.3f\n", (double)same_nearest / queries,
		(double)same_five / (5 * queries));
}

int main(int count, char **arguments)
{
	const size_t shapes = count > 1 ? strtoull(arguments[1], NULL, 10) : 100000;
	const int queries = count > 2 ? atoi(arguments[2]) : 40;
	if (shapes < 10 || queries < 1) {
		fputs("usage: bench_search [shapes, at least 10] [queries]\n", stderr);
		return 2;
	}
	eskel_library *library = fill(shapes);
	puts("            mean ms   slowest     kept 1    kept 2    kept 3  compared");
	for (int signature = 0; signature < 2; signature++)
		for (int kind = 0; kind < 2; kind++)
			measure(library, shapes, queries, (eskel_signature_kind)signature, (eskel_distance_kind)kind);
	printf("peak memory %.0f MB\n", measure_peak_megabytes());
	eskel_library_free(library);
	return 0;
}
