/* One recognition, see recognition.h. Nothing is locked: a neighbour that was deleted since the search is dropped. */
#include "recognition.h"

#include "calibration.h"
#include "clock.h"

#include <stdlib.h>

/* What order=position chooses from: as many as scale=neighbourhood (eskel_library.h). */
enum { LEAST_SHORTLIST = 40, BEYOND_LIMIT = 35 };

bool esk_choice_make(eskel_api *api, const esk_parameters *query, esk_choice *choice, esk_problem *problem)
{
	eskel_store_error error = {0};
	const eskel_filter filter = esk_parameters_filter(query);
	if (eskel_filter_is_none(&filter))
		return true;
	eskel_store_status status = eskel_store_keys(api->store, &filter, &choice->keys, &choice->block_count, &error);
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

static bool search(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice, eskel_search_options *options,
	esk_recognition *recognition, esk_problem *problem)
{
	if (options->limit < ESK_VOTERS)
		options->limit = ESK_VOTERS;
	options->keys = choice->keys;
	options->key_block_count = choice->block_count;
	options->leave_out = unknown->shape->key != 0;
	options->left_out_key = unknown->shape->key;
	double start = esk_clock_milliseconds();
	eskel_status status = eskel_library_search(api->library, unknown->signature, options, &recognition->search);
	recognition->milliseconds = esk_clock_milliseconds() - start;
	return esk_problem_engine(problem, status, NULL);
}

static eskel_store_status take(eskel_api *api, const eskel_neighbour *found, bool explained, esk_neighbour *neighbour,
	eskel_store_error *error)
{
	esk_neighbour taken = {.found = found};
	eskel_store_status status = esk_known_by_key(api->known, found->key, &taken.known, error);
	if (status == ESKEL_STORE_OK && explained)
		status = eskel_store_skeleton(api->store, found->key, &taken.skeleton, error);
	if (status == ESKEL_STORE_OK)
		*neighbour = taken;
	else
		esk_known_release(api->known, taken.known);
	return status;
}

/* The first so many neighbours are to be explained. */
static bool gather(eskel_api *api, size_t explained, esk_recognition *recognition, esk_problem *problem)
{
	const eskel_search_result *found = recognition->search;
	recognition->neighbours = calloc(found->count + 1, sizeof *recognition->neighbours);
	if (!recognition->neighbours)
		return esk_problem_no_memory(problem);
	for (size_t i = 0; i < found->count; i++) {
		esk_neighbour *neighbour = &recognition->neighbours[recognition->count];
		eskel_store_error error = {0};
		eskel_store_status status =
			take(api, &found->neighbours[i], recognition->count < explained, neighbour, &error);
		if (status == ESKEL_STORE_NOT_FOUND)
			continue;
		if (!esk_problem_store(problem, status, &error))
			return false;
		recognition->count++;
	}
	return true;
}

/* Of the first so many neighbours; those that have been compared stay as they are. */
static bool compare_hands(const esk_unknown *unknown, size_t count, esk_recognition *recognition, esk_problem *problem)
{
	for (size_t i = 0; i < recognition->count && i < count; i++) {
		esk_neighbour *neighbour = &recognition->neighbours[i];
		if (neighbour->is_compared)
			continue;
		eskel_status status =
			eskel_chirality_compare(unknown->placement, neighbour->known->placement, &neighbour->chirality);
		if (!esk_problem_engine(problem, status, NULL))
			return false;
		neighbour->is_compared = true;
	}
	return true;
}

bool esk_recognition_find(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice, size_t explained,
	eskel_search_options *options, esk_recognition *recognition, esk_problem *problem)
{
	return search(api, unknown, choice, options, recognition, problem) &&
	       gather(api, explained, recognition, problem) && compare_hands(unknown, ESK_VOTERS, recognition, problem);
}

void esk_recognition_evidence(const esk_recognition *recognition, esk_evidence *evidence)
{
	esk_vote votes[ESK_VOTERS];
	size_t count = recognition->count < ESK_VOTERS ? recognition->count : ESK_VOTERS;
	for (size_t i = 0; i < count; i++) {
		const esk_neighbour *neighbour = &recognition->neighbours[i];
		votes[i] = (esk_vote){
			.distance = neighbour->found->distance,
			.said = &neighbour->known->shape.description,
			.chirality_score = neighbour->chirality.score,
		};
	}
	esk_evidence_of_votes(votes, count, evidence);
}

static size_t shortlist(size_t limit)
{
	return limit + BEYOND_LIMIT > LEAST_SHORTLIST ? limit + BEYOND_LIMIT : LEAST_SHORTLIST;
}

static int by_position(const void *a, const void *b)
{
	const esk_neighbour *p = a, *q = b;
	if (p->position_distance != q->position_distance)
		return p->position_distance < q->position_distance ? -1 : 1;
	return (p->found->key > q->found->key) - (p->found->key < q->found->key);
}

static bool order_by_position(
	const esk_unknown *unknown, eskel_size size, esk_recognition *recognition, esk_problem *problem)
{
	eskel_position_signature *positions = NULL;
	eskel_status status = eskel_position_signature_new(unknown->skeleton, &positions);
	if (!esk_problem_engine(problem, status, NULL))
		return false;
	for (size_t i = 0; i < recognition->count; i++) {
		esk_neighbour *neighbour = &recognition->neighbours[i];
		neighbour->position_distance = eskel_position_distance(positions, neighbour->known->positions, size);
	}
	eskel_position_signature_free(positions);
	qsort(recognition->neighbours, recognition->count, sizeof *recognition->neighbours, by_position);
	recognition->proven = recognition->search->count == recognition->search->library;
	return true;
}

bool esk_recognition_make(eskel_api *api, const esk_unknown *unknown, const esk_choice *choice,
	const esk_parameters *query, esk_recognition *recognition, esk_problem *problem)
{
	const bool by_distance = query->order == ESK_ORDER_DISTANCE;
	const size_t wanted = query->limit ? query->limit : ESK_NEIGHBOURS_DEFAULT;
	const size_t limit = by_distance ? wanted : shortlist(wanted);
	eskel_search_options options = {
		.distance = esk_parameters_distance(query),
		.mode = (eskel_search_mode)query->mode,
		.keep = query->keep,
		.minimum = query->minimum,
		.scale = (eskel_scale)query->scale,
		.limit = limit,
	};
	esk_evidence evidence;
	esk_scores scores;
	if (!esk_recognition_find(api, unknown, choice, query->explain ? limit : 0, &options, recognition, problem))
		return false;
	esk_recognition_evidence(recognition, &evidence);
	if (!esk_calibration_score(api->calibration, &options.distance, &evidence, &scores, problem))
		return false;
	recognition->has_risk = options.mode == ESKEL_SEARCH_PRUNED && !recognition->search->proven;
	if (recognition->has_risk && !esk_pruning_risk(api->pruning, &options, &recognition->risk, problem))
		return false;
	esk_verdict_of_evidence(&evidence, &scores, &unknown->shape->description, &recognition->verdict);
	recognition->proven = recognition->search->proven;
	return (by_distance || order_by_position(unknown, options.distance.size, recognition, problem)) &&
	       compare_hands(unknown, wanted, recognition, problem);
}

void esk_recognition_clear(eskel_api *api, esk_recognition *recognition)
{
	for (size_t i = 0; i < recognition->count; i++) {
		esk_known_release(api->known, recognition->neighbours[i].known);
		eskel_skeleton_free(recognition->neighbours[i].skeleton);
	}
	free(recognition->neighbours);
	eskel_search_result_free(recognition->search);
	*recognition = (esk_recognition){0};
}
