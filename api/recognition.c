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

/* Reads what is stored of a neighbour and compares handedness. */
static eskel_store_status read_neighbour(eskel_api *api, const esk_unknown *unknown, bool explain,
	esk_neighbour *neighbour, eskel_status *computed, eskel_store_error *error)
{
	eskel_skeleton *skeleton = NULL;
	int64_t key = neighbour->found->key;
	eskel_store_status status = eskel_store_shape_by_key(api->store, key, &neighbour->shape, error);
	if (status == ESKEL_STORE_OK)
		status = eskel_store_skeleton(api->store, key, &skeleton, error);
	if (status == ESKEL_STORE_OK && explain)
		status = eskel_store_signature(api->store, key, &neighbour->signature, error);
	if (status == ESKEL_STORE_OK)
		*computed = eskel_chirality_compare(unknown->skeleton, skeleton, &neighbour->chirality);
	eskel_skeleton_free(skeleton);
	return status;
}

static void clear_neighbour(esk_neighbour *neighbour)
{
	eskel_signature_free(neighbour->signature);
	eskel_shape_clear(&neighbour->shape);
	*neighbour = (esk_neighbour){0};
}

static bool gather(
	eskel_api *api, const esk_unknown *unknown, bool explain, esk_recognition *recognition, esk_problem *problem)
{
	const eskel_search_result *found = recognition->search;
	recognition->neighbours = calloc(found->count + 1, sizeof *recognition->neighbours);
	if (!recognition->neighbours)
		return esk_problem_no_memory(problem);
	for (size_t i = 0; i < found->count; i++) {
		esk_neighbour *neighbour = &recognition->neighbours[recognition->count];
		eskel_status computed = ESKEL_OK;
		eskel_store_error error = {0};
		neighbour->found = &found->neighbours[i];
		eskel_store_status status = read_neighbour(api, unknown, explain, neighbour, &computed, &error);
		if (status == ESKEL_STORE_OK && computed == ESKEL_OK) {
			recognition->count++;
			continue;
		}
		clear_neighbour(neighbour);
		if (status != ESKEL_STORE_NOT_FOUND)
			return esk_problem_store(problem, status, &error) &&
			       esk_problem_engine(problem, computed, NULL);
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
			.said = &neighbour->shape.description,
			.handed = neighbour->chirality.verdict,
			.chirality_score = neighbour->chirality.score,
		};
	}
	esk_verdict_of_votes(votes, count, recorded, &recognition->verdict);
}

bool esk_recognition_make(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice,
	const esk_parameters *query, esk_recognition *recognition, esk_problem *problem)
{
	if (!search(api, unknown, choice, query, recognition, problem) ||
		!gather(api, unknown, query->explain, recognition, problem))
		return false;
	vote(&unknown->shape->description, recognition);
	return true;
}

void esk_recognition_clear(esk_recognition *recognition)
{
	for (size_t i = 0; i < recognition->count; i++)
		clear_neighbour(&recognition->neighbours[i]);
	free(recognition->neighbours);
	eskel_search_result_free(recognition->search);
	*recognition = (esk_recognition){0};
}
