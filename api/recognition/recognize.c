/* GET and POST /recognize: a stored shape, or each label of a posted volume, of which nothing is stored. */
#include "exchange.h"
#include "recognition.h"
#include "resources.h"
#include "specimen.h"

#include <string.h>

bool esk_recognize_check(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	if (exchange->route->body == ESK_BODY_NONE && !query->shape)
		return esk_problem_set(&exchange->problem, 400, "shape is missing, expected " ESK_ID_EXPECTED);
	if (query->limit > ESK_NEIGHBOURS_MOST)
		return esk_problem_set(
			&exchange->problem, 400, "limit is %u, expected 1 to %d", query->limit, ESK_NEIGHBOURS_MOST);
	if (query->level && query->distance != ESKEL_DISTANCE_LEVEL && !query->explain)
		return esk_problem_set(&exchange->problem, 400,
			"level is %u without a use, expected distance=level or explain=true beside it", query->level);
	if ((query->keep > 0 || query->minimum > 0) && query->mode != ESKEL_SEARCH_PRUNED)
		return esk_problem_set(&exchange->problem, 400,
			"%s is given without a use, expected mode=pruned beside it",
			query->keep > 0 ? "keep" : "minimum");
	if (query->order == ESK_ORDER_POSITION && query->scale == ESKEL_SCALE_NEIGHBOURHOOD)
		return esk_problem_set(&exchange->problem, 400,
			"order=position is given beside scale=neighbourhood, expected one of the two");
	return true;
}

/* Adds the recognition of one unknown to the results. */
static bool recognize(eskel_exchange *exchange, const esk_unknown *unknown, const esk_choice *choice, json_t *results)
{
	esk_recognition recognition = {0};
	bool good = esk_recognition_make(
		exchange->api, unknown, choice, &exchange->query, &recognition, &exchange->problem);
	if (good && json_array_append_new(results, esk_recognition_json(unknown, &recognition, &exchange->query)) != 0)
		good = esk_problem_no_memory(&exchange->problem);
	esk_recognition_clear(exchange->api, &recognition);
	return good;
}

/* Takes results. */
static bool answer_results(eskel_exchange *exchange, json_t *results)
{
	return esk_exchange_answer_json(exchange, 200, json_pack("{s:o}", "results", results));
}

/* Of a stored shape what recognition needs, and its skeleton where that is explained or gives the order. */
static bool know(eskel_exchange *exchange, const char *id, const esk_known_shape **known, eskel_skeleton **skeleton)
{
	eskel_store_error error = {0};
	eskel_store_status status = esk_known_by_id(exchange->api->known, id, known, &error);
	if (status == ESKEL_STORE_OK && (exchange->query.explain || exchange->query.order == ESK_ORDER_POSITION))
		status = eskel_store_skeleton(exchange->api->store, (*known)->shape.key, skeleton, &error);
	if (status == ESKEL_STORE_NOT_FOUND)
		return esk_problem_no_shape(&exchange->problem, id);
	return esk_problem_store(&exchange->problem, status, &error);
}

bool esk_recognize_shape(eskel_exchange *exchange)
{
	const esk_known_shape *known = NULL;
	eskel_skeleton *skeleton = NULL;
	esk_choice choice = {0};
	json_t *results = json_array();
	bool good = know(exchange, exchange->query.shape, &known, &skeleton) &&
		    esk_choice_make(exchange->api, &exchange->query, &choice, &exchange->problem) &&
		    recognize(exchange, &(esk_unknown){&known->shape, known->placement, known->signature, skeleton},
			    &choice, results);
	if (good)
		good = answer_results(exchange, results);
	else
		json_decref(results);
	esk_choice_clear(&choice);
	eskel_skeleton_free(skeleton);
	esk_known_release(exchange->api->known, known);
	return good;
}

static bool recognize_specimen(
	eskel_exchange *exchange, const esk_specimen *specimen, const esk_choice *choice, json_t *results)
{
	eskel_placement *placement = NULL;
	eskel_status status = eskel_placement_new(specimen->skeleton, &placement);
	const esk_unknown unknown = {&specimen->shape, placement, specimen->signature, specimen->skeleton};
	bool good =
		esk_problem_engine(&exchange->problem, status, NULL) && recognize(exchange, &unknown, choice, results);
	eskel_placement_free(placement);
	return good;
}

static bool recognize_specimens(
	eskel_exchange *exchange, esk_specimens *specimens, const esk_choice *choice, json_t *results)
{
	uint32_t level = exchange->query.level;
	uint32_t levels = level > ESKEL_LEVELS_DEFAULT ? level : ESKEL_LEVELS_DEFAULT;
	if (!esk_specimens_analyse(specimens, NULL, levels, &exchange->problem))
		return false;
	for (size_t i = 0; i < specimens->count; i++) {
		const esk_specimen *specimen = &specimens->items[i];
		if (!recognize_specimen(exchange, specimen, choice, results))
			return false;
	}
	return true;
}

bool esk_recognize_volume(eskel_exchange *exchange)
{
	esk_specimens specimens = {0};
	esk_choice choice = {0};
	json_t *results = json_array();
	bool good = esk_specimens_take_unknown(exchange, &specimens) &&
		    esk_choice_make(exchange->api, &exchange->query, &choice, &exchange->problem) &&
		    recognize_specimens(exchange, &specimens, &choice, results);
	if (good)
		good = answer_results(exchange, results);
	else
		json_decref(results);
	esk_choice_clear(&choice);
	esk_specimens_clear(&specimens);
	return good;
}
