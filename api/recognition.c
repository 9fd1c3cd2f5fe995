/* One recognition, see recognition.h. Nothing is locked: a neighbour that was deleted since the search is dropped. */
#include "recognition.h"

#include <stdlib.h>
#include <time.h>

bool esk_choice_make(eskel_api *api, const esk_parameters *query, esk_choice *choice, esk_problem *problem)
{
	eskel_store_error error = {0};
	const eskel_filter filter = esk_parameters_filter(query);
	if (eskel_filter_is_none(&filter))
		return true;
	eskel_store_status status = eskel_store_keys(api->store, &filter, &choice->keys, &choice->count, &error);
	if (!esk_problem_store(problem, status, &error))
		return false;
	/* No keys at all must not look like no choice. */
	if (!choice->keys)
		choice->keys = calloc(1, sizeof *choice->keys);
	return choice->keys || esk_problem_no_memory(problem);
}

void esk_choice_clear(esk_choice *choice)
{
	free(choice->keys);
	*choice = (esk_choice){0};
}

static double now_in_milliseconds(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static bool search(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice, const esk_parameters *query,
	esk_recognition *recognition, esk_problem *problem)
{
	size_t limit = query->limit ? query->limit : ESK_NEIGHBOURS_DEFAULT;
	const eskel_search_options options = {
		.distance = esk_parameters_distance(query),
		.mode = (eskel_search_mode)query->mode,
		.limit = limit > ESK_VOTERS ? limit : ESK_VOTERS,
		.keys = choice->keys,
		.key_count = choice->count,
		.leave_out = unknown->shape->key != 0,
		.left_out_key = unknown->shape->key,
	};
	double start = now_in_milliseconds();
	eskel_status status = eskel_library_search(api->library, unknown->signature, &options, &recognition->search);
	recognition->milliseconds = now_in_milliseconds() - start;
	return esk_problem_engine(problem, status, NULL);
}

static bool gather(eskel_api *api, const esk_unknown *unknown, esk_recognition *recognition, esk_problem *problem)
{
	const eskel_search_result *found = recognition->search;
	recognition->neighbours = calloc(found->count + 1, sizeof *recognition->neighbours);
	if (!recognition->neighbours)
		return esk_problem_no_memory(problem);
	for (size_t i = 0; i < found->count; i++) {
		esk_neighbour *neighbour = &recognition->neighbours[recognition->count];
		eskel_store_error error = {0};
		eskel_store_status status =
			esk_known_by_key(api->known, found->neighbours[i].key, &neighbour->known, &error);
		if (status == ESKEL_STORE_NOT_FOUND)
			continue;
		if (!esk_problem_store(problem, status, &error))
			return false;
		neighbour->found = &found->neighbours[i];
		recognition->count++;
		eskel_status compared =
			eskel_chirality_compare(unknown->placement, neighbour->known->placement, &neighbour->chirality);
		if (!esk_problem_engine(problem, compared, NULL))
			return false;
	}
	return true;
}

static void vote(const eskel_description *recorded, esk_recognition *recognition)
{
	esk_vote votes[ESK_VOTERS];
	size_t count = recognition->count < ESK_VOTERS ? recognition->count : ESK_VOTERS;
	for (size_t i = 0; i < count; i++) {
		const esk_neighbour *neighbour = &recognition->neighbours[i];
		votes[i] = (esk_vote){
			.distance = neighbour->found->distance,
			.said = &neighbour->known->shape.description,
			.handed = neighbour->chirality.verdict,
			.chirality_score = neighbour->chirality.score,
		};
	}
	esk_verdict_of_votes(votes, count, recorded, &recognition->verdict);
}

bool esk_recognition_make(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice,
	const esk_parameters *query, esk_recognition *recognition, esk_problem *problem)
{
	if (!search(api, unknown, choice, query, recognition, problem) || !gather(api, unknown, recognition, problem))
		return false;
	vote(&unknown->shape->description, recognition);
	return true;
}

void esk_recognition_clear(eskel_api *api, esk_recognition *recognition)
{
	for (size_t i = 0; i < recognition->count; i++)
		esk_known_release(api->known, recognition->neighbours[i].known);
	free(recognition->neighbours);
	eskel_search_result_free(recognition->search);
	*recognition = (esk_recognition){0};
}
