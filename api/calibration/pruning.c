/* Trials of pruned searches, see pruning.h. */
#include "pruning.h"

#include "sample.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

/* A standard error of 4 % in a share of a tenth. */
#define MOST_TRIALS 64
#define MOST_WAYS 8

/* A way to search, and its risk. */
typedef struct {
	eskel_search_options options;
	uint64_t used; /* when last; 0: never */
	esk_risk risk;
} way;

struct esk_pruning {
	eskel_api *api;
	pthread_mutex_t lock;
	uint64_t uses;
	way ways[MOST_WAYS];
};

/* The distance of the nearest that a search finds, infinite if it finds none. */
static bool find_nearest(const eskel_api *api, const eskel_signature *signature, const eskel_search_options *options,
	double *distance, esk_problem *problem)
{
	eskel_search_result *result = NULL;
	eskel_status status = eskel_library_search(api->library, signature, options, &result);
	if (!esk_problem_engine(problem, status, NULL))
		return false;
	*distance = result->count > 0 ? result->neighbours[0].distance : INFINITY;
	eskel_search_result_free(result);
	return true;
}

/* Whether the nearest of a stored shape is lost; *held stays as it is for one that is no longer there. */
static bool hold_trial(eskel_api *api, const eskel_search_options *options, int64_t key, size_t *held, size_t *lost,
	esk_problem *problem)
{
	const esk_known_shape *known = NULL;
	eskel_store_error error = {0};
	eskel_store_status status = esk_known_by_key(api->known, key, &known, &error);
	if (status == ESKEL_STORE_NOT_FOUND)
		return true;
	if (!esk_problem_store(problem, status, &error))
		return false;
	eskel_search_options exact = {
		.distance = options->distance, .limit = 1, .leave_out = true, .left_out_key = key};
	eskel_search_options pruned = *options;
	pruned.keys = NULL;
	pruned.scale = ESKEL_SCALE_NONE; /* which orders what was found, and loses nothing */
	pruned.leave_out = true;
	pruned.left_out_key = key;
	double nearest, found;
	bool good = find_nearest(api, known->signature, &exact, &nearest, problem) &&
		    find_nearest(api, known->signature, &pruned, &found, problem);
	if (good) {
		(*held)++;
		*lost += found > nearest;
	}
	esk_known_release(api->known, known);
	return good;
}

static bool hold_trials(eskel_api *api, const eskel_search_options *options, esk_risk *risk, esk_problem *problem)
{
	const eskel_filter all = eskel_filter_none();
	eskel_store_error error = {0};
	eskel_key_block *stored = NULL;
	int64_t keys[MOST_TRIALS];
	size_t block_count = 0, held = 0, lost = 0;
	const size_t library = eskel_library_count(api->library);
	eskel_store_status status = eskel_store_keys(api->store, &all, &stored, &block_count, &error);
	bool good = esk_problem_store(problem, status, &error);
	const size_t count = good ? esk_sample_choose(stored, block_count, MOST_TRIALS, keys) : 0;
	free(stored);
	for (size_t i = 0; good && i < count; i++)
		good = hold_trial(api, options, keys[i], &held, &lost, problem);
	if (good)
		*risk = (esk_risk){((double)lost + 0.5) / ((double)held + 1), held, library};
	return good;
}

static bool same_way(const eskel_search_options *a, const eskel_search_options *b)
{
	const eskel_distance_options *x = &a->distance, *y = &b->distance;
	return a->keep == b->keep && a->minimum == b->minimum && a->limit == b->limit && x->signature == y->signature &&
	       x->distance == y->distance && x->level == y->level && x->metric == y->metric && x->size == y->size;
}

/* In the place of the one least recently used if it is new. */
static way *way_of(esk_pruning *pruning, const eskel_search_options *options)
{
	way *oldest = &pruning->ways[0], *found = NULL;
	for (size_t i = 0; i < MOST_WAYS && !found; i++) {
		way *w = &pruning->ways[i];
		if (w->used && same_way(&w->options, options))
			found = w;
		else if (w->used < oldest->used)
			oldest = w;
	}
	if (!found) {
		*oldest = (way){.options = *options};
		found = oldest;
	}
	found->used = ++pruning->uses;
	return found;
}

static bool is_old(const esk_risk *risk, size_t library)
{
	const size_t change = library > risk->library ? library - risk->library : risk->library - library;
	return risk->library == 0 || 10 * change > risk->library;
}

bool esk_pruning_risk(esk_pruning *pruning, const eskel_search_options *options, esk_risk *risk, esk_problem *problem)
{
	bool good = true;
	pthread_mutex_lock(&pruning->lock);
	way *w = way_of(pruning, options);
	if (is_old(&w->risk, eskel_library_count(pruning->api->library)))
		good = hold_trials(pruning->api, options, &w->risk, problem);
	if (good)
		*risk = w->risk;
	pthread_mutex_unlock(&pruning->lock);
	return good;
}

esk_pruning *esk_pruning_new(eskel_api *api)
{
	esk_pruning *made = calloc(1, sizeof *made);
	if (!made)
		return NULL;
	made->api = api;
	pthread_mutex_init(&made->lock, NULL);
	return made;
}

void esk_pruning_free(esk_pruning *pruning)
{
	if (!pruning)
		return;
	pthread_mutex_destroy(&pruning->lock);
	free(pruning);
}
