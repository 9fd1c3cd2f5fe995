/* Time of a search: bench_search SHAPES [QUERIES, default 40]
 *
 * A library of synthetic shapes in clusters of twenty; queries are further members of a cluster. The paper's distance at
 * level 10 is also searched as textbooks would, shape by shape; both must find the same distance. */
#include "eskel.h"
#include "measure.h"
#include "peers/textbook_assignment.h"
#include "synthetic.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { MEMBERS = 20, LEVELS = 16, LEVEL = 10, NUMBERS = 4, TEXTBOOK_QUERIES = 3 };
static const double noise = 0.15;

typedef float rows_of_shape[LEVEL][NUMBERS];

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "bench_search: %s\n", what);
	exit(1);
}

static void copy_rows(const eskel_signature *signature, rows_of_shape rows)
{
	for (int i = 0; i < LEVEL; i++)
		for (int j = 0; j < NUMBERS; j++)
			rows[i][j] = (float)signature->rows[ESKEL_NODES(LEVEL - 1) + (size_t)i][j];
}

static eskel_library *fill(size_t shapes, rows_of_shape *rows)
{
	eskel_library *library = NULL;
	require(!eskel_library_new(&library), "no library");
	for (size_t n = 0; n < shapes; n++) {
		eskel_signature *signature = synthetic_signature(n / MEMBERS, n, noise, LEVELS);
		require(!eskel_library_add(library, (int64_t)n, signature), "a shape was not added");
		copy_rows(signature, rows[n]);
		eskel_signature_free(signature);
	}
	return library;
}

static eskel_signature *make_query(size_t shapes, int number)
{
	return synthetic_signature(
		(size_t)number * 7919 % (shapes / MEMBERS + 1), shapes + (size_t)number, noise, LEVELS);
}

/* ---- ours */

typedef struct {
	double spent, compared, same_nearest, same_five;
} total;

static eskel_search_result *search(
	const eskel_library *library, const eskel_signature *query, const eskel_search_options *options, total *t)
{
	eskel_search_result *result = NULL;
	const double start = measure_milliseconds();
	require(!eskel_library_search(library, query, options, &result), "no result");
	t->spent += measure_milliseconds() - start;
	t->compared += (double)result->compared;
	return result;
}

static void count_found(const eskel_search_result *found, const eskel_search_result *best, total *t)
{
	t->same_nearest += found->neighbours[0].key == best->neighbours[0].key;
	for (size_t i = 0; i < best->count; i++)
		for (size_t j = 0; j < found->count; j++)
			t->same_five += best->neighbours[i].key == found->neighbours[j].key;
}

static void measure(const eskel_library *library, eskel_signature **queries, int count, const char *figure,
	const eskel_distance_options *distance)
{
	total pruned = {0}, exact = {0};
	for (int q = 0; q < count; q++) {
		eskel_search_options options = {.distance = *distance, .mode = ESKEL_SEARCH_EXACT};
		eskel_search_result *best = search(library, queries[q], &options, &exact);
		options.mode = ESKEL_SEARCH_PRUNED;
		eskel_search_result *found = search(library, queries[q], &options, &pruned);
		count_found(found, best, &pruned);
		eskel_search_result_free(found);
		eskel_search_result_free(best);
	}
	measure_print(figure, "eskel exact", exact.spent / count, "ms");
	measure_print(figure, "eskel exact", exact.compared / count, "compared");
	measure_print(figure, "eskel pruned", pruned.spent / count, "ms");
	measure_print(figure, "eskel pruned", pruned.compared / count, "compared");
	measure_print(figure, "eskel pruned", 100 * pruned.same_nearest / count, "% nearest found");
	measure_print(figure, "eskel pruned", 100 * pruned.same_five / (5 * count), "% of five found");
}

/* ---- two threads at once */

enum { THREADS = 2 };

typedef struct {
	const eskel_library *library;
	const eskel_distance_options *distance;
	eskel_search_mode mode;
	eskel_signature **queries;
	int count;
} share;

static void *search_all(void *context)
{
	const share *s = context;
	const eskel_search_options options = {.distance = *s->distance, .mode = s->mode};
	total ignored = {0};
	for (int q = 0; q < s->count; q++)
		eskel_search_result_free(search(s->library, s->queries[q], &options, &ignored));
	return NULL;
}

/* Prints the time a search takes off the clock while each thread searches for all queries. */
static void measure_threads(const eskel_library *library, eskel_signature **queries, int count, const char *figure,
	const eskel_distance_options *distance, eskel_search_mode mode, const char *program)
{
	pthread_t threads[THREADS];
	share all = {library, distance, mode, queries, count};
	const double start = measure_milliseconds();
	for (int t = 0; t < THREADS; t++)
		require(!pthread_create(&threads[t], NULL, search_all, &all), "no thread");
	for (int t = 0; t < THREADS; t++)
		pthread_join(threads[t], NULL);
	measure_print(figure, program, (measure_milliseconds() - start) / (THREADS * count), "ms");
}

/* ---- as textbooks would */

static double compare_as_textbooks(rows_of_shape a, rows_of_shape b)
{
	float costs[LEVEL * LEVEL];
	for (int i = 0; i < LEVEL; i++)
		for (int j = 0; j < LEVEL; j++) {
			float cost = 0;
			for (int n = 0; n < NUMBERS; n++)
				cost += fabsf(a[i][n] - b[j][n]);
			costs[i * LEVEL + j] = cost;
		}
	return textbook_assignment(LEVEL, costs);
}

static void measure_textbook(const eskel_library *library, rows_of_shape *rows, size_t shapes, const char *figure,
	const eskel_distance_options *distance)
{
	double spent = 0;
	for (int q = 0; q < TEXTBOOK_QUERIES; q++) {
		eskel_signature *query = make_query(shapes, q);
		eskel_search_result *best = NULL;
		rows_of_shape query_rows;
		copy_rows(query, query_rows);
		double least = INFINITY;
		const double start = measure_milliseconds();
		for (size_t n = 0; n < shapes; n++)
			least = fmin(least, compare_as_textbooks(query_rows, rows[n]));
		spent += measure_milliseconds() - start;
		require(!eskel_library_search(library, query, &(eskel_search_options){.distance = *distance}, &best) &&
				fabs(best->neighbours[0].distance - least) < 1e-4 * least,
			"the textbook's nearest is as near as another");
		eskel_search_result_free(best);
		eskel_signature_free(query);
	}
	measure_print(figure, "textbook in C, exhaustive", spent / TEXTBOOK_QUERIES, "ms");
}

static const struct {
	const char *name;
	eskel_distance_options distance;
} kinds[] = {
	{"log-sum", {.signature = ESKEL_SIGNATURE_LOG, .distance = ESKEL_DISTANCE_SUM}},
	{"log-level", {.signature = ESKEL_SIGNATURE_LOG, .distance = ESKEL_DISTANCE_LEVEL, .level = LEVEL}},
	{"root-sum", {.metric = ESKEL_METRIC_ROOT}},
	{"root-level", {.metric = ESKEL_METRIC_ROOT, .distance = ESKEL_DISTANCE_LEVEL, .level = LEVEL}},
	{"paper-sum", {.signature = ESKEL_SIGNATURE_PAPER, .distance = ESKEL_DISTANCE_SUM}},
	{"paper-level", {.signature = ESKEL_SIGNATURE_PAPER, .distance = ESKEL_DISTANCE_LEVEL, .level = LEVEL}},
};

int main(int count, char **arguments)
{
	const size_t shapes = count > 1 ? strtoull(arguments[1], NULL, 10) : 0;
	const int query_count = count > 2 ? atoi(arguments[2]) : 40;
	require(shapes >= 10 && query_count >= 1, "usage: bench_search SHAPES (at least 10) [QUERIES]");
	rows_of_shape *rows = malloc(shapes * sizeof *rows);
	eskel_signature **queries = malloc((size_t)query_count * sizeof *queries);
	require(rows && queries, "memory ran out");
	memset(rows, 0, shapes * sizeof *rows); /* so that it is not counted to the library */
	for (int q = 0; q < query_count; q++)
		queries[q] = make_query(shapes, q);
	const double before = measure_peak_megabytes();
	eskel_library *library = fill(shapes, rows);
	const double megabytes = measure_peak_megabytes() - before;
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
		const eskel_distance_options *distance = &kinds[i].distance;
		char figure[64];
		/* Beyond, an exact search takes seconds: it grows with the library. */
		if (distance->metric == ESKEL_METRIC_ROOT && shapes > 10000)
			continue;
		snprintf(figure, sizeof figure, "search-%s/shapes=%zu", kinds[i].name, shapes);
		measure(library, queries, query_count, figure, distance);
		measure_print(figure, "eskel exact", megabytes, "MB");
		measure_threads(
			library, queries, query_count, figure, distance, ESKEL_SEARCH_EXACT, "eskel exact, 2 threads");
		measure_threads(library, queries, query_count, figure, distance, ESKEL_SEARCH_PRUNED,
			"eskel pruned, 2 threads");
		if (!strcmp(kinds[i].name, "paper-level"))
			measure_textbook(library, rows, shapes, figure, distance);
	}
	eskel_library_free(library);
	for (int q = 0; q < query_count; q++)
		eskel_signature_free(queries[q]);
	free(queries);
	free(rows);
	return 0;
}
