/* Time of a filter over descriptions in memory and of the search among what it leaves: bench_filter SHAPES [QUERIES, default
 * 40]
 *
 * A library of synthetic shapes in clusters of twenty; queries are further members of a cluster. Filters keep some of every
 * cluster, at random, so that the nearest are farther away than those of all, or whole clusters, the query's among them, as
 * one for its class would. A query's searches run in turn, round after round, and the least of each counts. */
#include "catalogue.h"
#include "measure.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>

enum { MEMBERS = 20, LEVELS = 16, ROUNDS = 5 };
static const double noise = 0.15;

enum { ALL, ALL_BUT_FEW, HALF, HALF_OF_CLUSTERS, TWENTIETH, TWENTIETH_OF_CLUSTERS, THOUSANDTH, CHOICES };
static const char *const names[CHOICES] = {
	"eskel, all shapes",
	"- all but a thousandth",
	"- half, by side",
	"- half, whole clusters, by class",
	"- a twentieth, by attribute",
	"- a twentieth, whole clusters, by attribute",
	"- a thousandth, by subject",
};

static void require(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "bench_filter: %s\n", what);
	exit(1);
}

/* ---- the library */

typedef struct {
	char class[24], subject[24], group[24], tray[24];
	eskel_attribute attributes[2];
	eskel_description description;
} said;

static void describe(size_t cluster, size_t n, said *of)
{
	uint64_t state = n;
	const uint64_t random = synthetic_random(&state);
	snprintf(of->class, sizeof of->class, "%zu", cluster % 2);
	snprintf(of->subject, sizeof of->subject, "%u", (unsigned)(random >> 8) % 1000);
	snprintf(of->group, sizeof of->group, "%zu", cluster % 20);
	snprintf(of->tray, sizeof of->tray, "%u", (unsigned)(random >> 32) % 20);
	of->attributes[0] = (eskel_attribute){.key = (char *)"group", .value = of->group};
	of->attributes[1] = (eskel_attribute){.key = (char *)"tray", .value = of->tray};
	of->description = (eskel_description){.class = of->class,
		.subject = of->subject,
		.side = random % 2 ? ESKEL_SIDE_LEFT : ESKEL_SIDE_RIGHT,
		.age = NAN,
		.attribute_count = 2,
		.attributes = of->attributes};
}

static void fill(size_t shapes, eskel_library *library, esk_catalogue *catalogue)
{
	for (size_t n = 0; n < shapes; n++) {
		const size_t cluster = n / MEMBERS;
		const int64_t key = (int64_t)n + 1;
		said of;
		eskel_signature *signature = synthetic_signature(cluster, n, noise, LEVELS);
		require(!eskel_library_add(library, key, signature), "a shape was not added");
		eskel_signature_free(signature);
		describe(cluster, n, &of);
		esk_catalogue_put(catalogue, key, &of.description);
	}
	require(esk_catalogue_is_whole(catalogue), "memory ran out");
}

/* ---- searches */

/* The filter that leaves what is said of the query, too. */
static eskel_filter choose(int choice, const said *of)
{
	eskel_filter filter = eskel_filter_none();
	if (choice == ALL_BUT_FEW)
		filter.not_subject = of->subject;
	if (choice == HALF)
		filter.side = of->description.side;
	if (choice == HALF_OF_CLUSTERS)
		filter.class = of->class;
	filter.attribute_count = choice == TWENTIETH || choice == TWENTIETH_OF_CLUSTERS;
	filter.attributes = &of->attributes[choice == TWENTIETH];
	if (choice == THOUSANDTH)
		filter.subject = of->subject;
	return filter;
}

typedef struct {
	double spent, filtering, compared;
} cost;

static cost search(const eskel_library *library, esk_catalogue *catalogue, const eskel_signature *query,
	const eskel_filter *filter, eskel_search_mode mode)
{
	eskel_key_block *keys = NULL;
	size_t blocks = 0;
	eskel_search_result *result = NULL;
	const double start = measure_milliseconds();
	if (!eskel_filter_is_none(filter))
		require(esk_catalogue_keys(catalogue, filter, &keys, &blocks), "no keys");
	const double filtered = measure_milliseconds();
	const eskel_search_options options = {.mode = mode, .keys = keys, .key_block_count = blocks};
	require(!eskel_library_search(library, query, &options, &result), "no result");
	const cost found = {measure_milliseconds() - start, filtered - start, (double)result->compared};
	eskel_search_result_free(result);
	free(keys);
	return found;
}

static void add_least(const eskel_library *library, esk_catalogue *catalogue, size_t shapes, size_t number,
	eskel_search_mode mode, cost totals[CHOICES])
{
	const size_t cluster = number * 7919 % (shapes / MEMBERS);
	eskel_signature *query = synthetic_signature(cluster, shapes + number, noise, LEVELS);
	cost least[CHOICES];
	said of;
	describe(cluster, shapes + number, &of);
	for (int round = 0; round < ROUNDS; round++)
		for (int choice = 0; choice < CHOICES; choice++) {
			const eskel_filter filter = choose(choice, &of);
			const cost one = search(library, catalogue, query, &filter, mode);
			if (round == 0 || one.spent < least[choice].spent)
				least[choice] = one;
		}
	for (int choice = 0; choice < CHOICES; choice++) {
		totals[choice].spent += least[choice].spent;
		totals[choice].filtering += least[choice].filtering;
		totals[choice].compared += least[choice].compared;
	}
	eskel_signature_free(query);
}

static void measure(const eskel_library *library, esk_catalogue *catalogue, size_t shapes, size_t queries,
	eskel_search_mode mode, const char *figure)
{
	cost totals[CHOICES] = {0};
	for (size_t q = 0; q < queries; q++)
		add_least(library, catalogue, shapes, q, mode, totals);
	for (int choice = 0; choice < CHOICES; choice++) {
		const double each = 1 / (double)queries;
		measure_print(figure, names[choice], totals[choice].spent * each, "ms");
		if (choice != ALL)
			measure_print(figure, names[choice], totals[choice].filtering * each, "ms of it filtering");
		measure_print(figure, names[choice], totals[choice].compared * each, "compared");
	}
}

int main(int count, char **arguments)
{
	const size_t shapes = count > 1 ? strtoull(arguments[1], NULL, 10) : 0;
	const size_t queries = count > 2 ? strtoull(arguments[2], NULL, 10) : 40;
	require(shapes >= MEMBERS && queries >= 1, "usage: bench_filter SHAPES (at least 20) [QUERIES]");
	eskel_library *library = NULL;
	esk_catalogue *catalogue = esk_catalogue_new();
	require(catalogue && !eskel_library_new(&library), "no library");
	fill(shapes, library, catalogue);
	measure(library, catalogue, shapes, queries, ESKEL_SEARCH_EXACT, "filter/exact");
	measure(library, catalogue, shapes, queries, ESKEL_SEARCH_PRUNED, "filter/pruned");
	eskel_library_free(library);
	esk_catalogue_free(catalogue);
	return 0;
}
