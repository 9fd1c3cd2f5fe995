/* Each shape of an evaluation searched for in both modes: how long it takes, and after which steps of the pruned search its
 * true nearest shape, which the distances have told, is still in. One search at a time, so that times are those of a
 * server that does nothing else. */
#include "clock.h"
#include "evaluation.h"

#include <math.h>
#include <stdlib.h>

enum { limit = 5 }; /* neighbours, as a recognition asks for by default */

typedef struct {
	eskel_api *api;
	eskel_distance_options distance;
	esk_evaluation *evaluation;
	eskel_key_block *keys;  /* of those that a query is compared with */
	double *exact, *pruned; /* milliseconds of each search */
} trial;

/* Returns the number of blocks; the shapes are by ascending keys. */
static size_t choose_keys(const trial *t, size_t query)
{
	const esk_evaluation *e = t->evaluation;
	const eskel_evaluation numbers = {e->count, e->classes, e->subjects};
	size_t count = 0;
	for (size_t i = 0; i < e->count; i++)
		if (!eskel_evaluation_leaves_out(&numbers, query, i))
			count = eskel_key_blocks_add(t->keys, count, e->shapes[i].key, 1);
	return count;
}

static void count_steps(esk_search_accuracy *search, const eskel_search_result *found, int64_t nearest)
{
	size_t kept = found->library;
	for (uint32_t step = 0; step < ESKEL_LEVELS_MAX; step++) {
		const uint32_t taken = step < found->step_count ? step + 1 : found->step_count;
		if (step < found->step_count)
			kept = found->kept[step];
		search->steps[step].kept += kept;
		search->steps[step].outlived += found->watched_steps >= taken;
	}
	if (found->step_count > search->step_count)
		search->step_count = found->step_count;
	search->found += found->count > 0 && found->neighbours[0].key == nearest;
}

static bool search_timed(const trial *t, const eskel_signature *signature, const eskel_search_options *options,
	double *milliseconds, eskel_search_result **found, esk_problem *problem)
{
	double start = esk_clock_milliseconds();
	eskel_status status = eskel_library_search(t->api->library, signature, options, found);
	*milliseconds = esk_clock_milliseconds() - start;
	return esk_problem_engine(problem, status, NULL);
}

static bool search_both(const trial *t, size_t query, const eskel_signature *signature, esk_problem *problem)
{
	esk_search_accuracy *search = &t->evaluation->search;
	const int64_t nearest = t->evaluation->shapes[t->evaluation->nearest[query].nearest].key;
	eskel_search_options options = {
		.distance = t->distance,
		.limit = limit,
		.keys = t->keys,
		.key_block_count = choose_keys(t, query),
		.watch = true,
		.watched_key = nearest,
	};
	eskel_search_result *exact = NULL, *pruned = NULL;
	bool good = search_timed(t, signature, &options, &t->exact[search->searches], &exact, problem);
	options.mode = ESKEL_SEARCH_PRUNED;
	if (good)
		good = search_timed(t, signature, &options, &t->pruned[search->searches], &pruned, problem);
	if (good) {
		count_steps(search, pruned, nearest);
		search->searches++;
	}
	eskel_search_result_free(exact);
	eskel_search_result_free(pruned);
	return good;
}

/* A shape that has gone meanwhile is passed over. */
static bool search_by(const trial *t, size_t query, esk_problem *problem)
{
	const esk_known_shape *known = NULL;
	eskel_store_error error = {0};
	eskel_store_status status = esk_known_by_key(t->api->known, t->evaluation->shapes[query].key, &known, &error);
	if (status == ESKEL_STORE_NOT_FOUND)
		return true;
	bool good = esk_problem_store(problem, status, &error) && search_both(t, query, known->signature, problem);
	esk_known_release(t->api->known, known);
	return good;
}

static int ascending(const void *a, const void *b)
{
	const double *x = a, *y = b;
	return *x < *y ? -1 : *x > *y;
}

/* Mean, median and 95th percentile (the least value that 95 % do not exceed). */
static void summarise(double *values, size_t count, double summary[3])
{
	if (count == 0)
		return;
	qsort(values, count, sizeof *values, ascending);
	for (size_t i = 0; i < count; i++)
		summary[0] += values[i] / (double)count;
	summary[1] = (values[(count - 1) / 2] + values[count / 2]) / 2;
	summary[2] = values[(95 * count + 99) / 100 - 1];
}

bool esk_evaluation_search(
	eskel_api *api, const esk_parameters *query, esk_evaluation *evaluation, esk_problem *problem)
{
	const size_t count = evaluation->count;
	trial t = {
		.api = api,
		.distance = esk_parameters_distance(query),
		.evaluation = evaluation,
		.keys = calloc(count + 1, sizeof *t.keys),
		.exact = calloc(count + 1, sizeof *t.exact),
		.pruned = calloc(count + 1, sizeof *t.pruned),
	};
	bool good = (t.keys && t.exact && t.pruned) || esk_problem_no_memory(problem);
	for (size_t i = 0; good && i < count; i++)
		good = evaluation->nearest[i].nearest == ESK_NO_SHAPE || search_by(&t, i, problem);
	if (good) {
		summarise(t.exact, evaluation->search.searches, evaluation->search.exact);
		summarise(t.pruned, evaluation->search.searches, evaluation->search.pruned);
	}
	free(t.keys);
	free(t.exact);
	free(t.pruned);
	return good;
}
