/* One recognition as JSON, see recognition.h. */
#include "explanation.h"
#include "recognition.h"
#include "shape_json.h"

#include <math.h>

static json_t *search_json(const esk_recognition *recognition, const esk_parameters *query)
{
	const eskel_search_result *search = recognition->search;
	json_t *kept = json_array();
	for (uint32_t i = 0; i < search->step_count; i++)
		if (json_array_append_new(kept, json_integer((json_int_t)search->kept[i])) != 0) {
			json_decref(kept);
			return NULL;
		}
	json_t *risk = !recognition->has_risk ? json_null()
					      : json_pack("{s:o, s:I, s:I}", "dropped_nearest",
							esk_json_real(recognition->risk.dropped_nearest), "trials",
							(json_int_t)recognition->risk.trials, "library",
							(json_int_t)recognition->risk.library);
	return json_pack("{s:s, s:b, s:o, s:s, s:I, s:I, s:o, s:o}", "mode",
		query->mode == ESKEL_SEARCH_EXACT ? "exact" : "pruned", "proven", (int)recognition->proven, "risk",
		risk, "distance", query->distance == ESKEL_DISTANCE_LEVEL ? "level" : "sum", "library",
		(json_int_t)search->library, "compared", (json_int_t)search->compared, "kept", kept, "milliseconds",
		esk_json_real(round(1e3 * recognition->milliseconds) / 1e3));
}

static json_t *chirality_json(const eskel_chirality *chirality)
{
	static const char *const verdicts[] = {
		[ESKEL_CHIRALITY_UNDECIDED] = "undecided",
		[ESKEL_CHIRALITY_SAME] = "same",
		[ESKEL_CHIRALITY_MIRRORED] = "mirrored",
	};
	json_t *determinant = json_null();
	if (chirality->has_determinant)
		determinant = json_pack("{s:i, s:o, s:o}", "level", (int)chirality->determinant_level, "query",
			esk_json_real(chirality->determinant[0]), "neighbour",
			esk_json_real(chirality->determinant[1]));
	return json_pack("{s:s, s:o, s:o}", "verdict", verdicts[chirality->verdict], "score",
		esk_json_real(chirality->score), "determinant", determinant);
}

static bool explain(
	json_t *json, const esk_unknown *unknown, const esk_neighbour *neighbour, const esk_parameters *query)
{
	const esk_compared shape = {unknown->signature, unknown->skeleton};
	const esk_compared other = {neighbour->known->signature, neighbour->skeleton};
	return esk_explanation_add(json, &shape, &other, &neighbour->chirality, query);
}

static bool explain_query(json_t *json, const eskel_skeleton *skeleton, const esk_parameters *query)
{
	json_t *classes = esk_explanation_classes(skeleton, esk_explanation_level(skeleton, query));
	return json_object_set_new(json, "classes", classes) == 0;
}

/* What the neighbours are ordered by, where that is not the distance. */
static bool add_order(json_t *json, const esk_neighbour *neighbour, const esk_parameters *query)
{
	if (query->scale == ESKEL_SCALE_NEIGHBOURHOOD)
		return json_object_set_new(json, "scaled", esk_json_real(neighbour->found->scaled)) == 0;
	if (query->order == ESK_ORDER_POSITION)
		return json_object_set_new(json, "position_distance", esk_json_real(neighbour->position_distance)) == 0;
	return true;
}

static json_t *neighbour_json(const esk_unknown *unknown, const esk_neighbour *neighbour, const esk_parameters *query)
{
	const eskel_neighbour *found = neighbour->found;
	const eskel_shape *shape = &neighbour->known->shape;
	const eskel_description *said = &shape->description;
	json_t *json = json_pack("{s:s, s:s?, s:s?, s:s?, s:s?, s:o, s:o, s:o}", "id", shape->id, "name", said->name,
		"class", said->class, "side", esk_value_side_text(said->side), "subject", said->subject, "distance",
		esk_json_real(found->distance), "levels", esk_json_reals(found->levels, found->level_count),
		"chirality", chirality_json(&neighbour->chirality));
	if (json && !add_order(json, neighbour, query)) {
		json_decref(json);
		return NULL;
	}
	if (json && query->explain && !explain(json, unknown, neighbour, query)) {
		json_decref(json);
		return NULL;
	}
	return json;
}

static json_t *neighbours_json(
	const esk_unknown *unknown, const esk_recognition *recognition, const esk_parameters *query)
{
	size_t limit = query->limit ? query->limit : ESK_NEIGHBOURS_DEFAULT;
	json_t *array = json_array();
	for (size_t i = 0; i < recognition->count && i < limit; i++)
		if (json_array_append_new(array, neighbour_json(unknown, &recognition->neighbours[i], query)) != 0) {
			json_decref(array);
			return NULL;
		}
	return array;
}

static json_t *verdict_json(const esk_verdict *verdict)
{
	json_t *agrees =
		verdict->agrees == ESK_AGREES_UNKNOWN ? json_null() : json_boolean(verdict->agrees == ESK_AGREES);
	return json_pack("{s:s?, s:o, s:s?, s:o, s:s?, s:o, s:o}", "class", verdict->class, "class_score",
		esk_json_real(verdict->class_score), "nearest_class", verdict->nearest_class, "distance_z",
		esk_json_real(verdict->distance_z), "side", esk_value_side_text(verdict->side), "side_score",
		esk_json_real(verdict->side_score), "agrees", agrees);
}

json_t *esk_recognition_json(
	const esk_unknown *unknown, const esk_recognition *recognition, const esk_parameters *query)
{
	json_t *json = json_pack("{s:o, s:o, s:o, s:o}", "query", esk_shape_json(unknown->shape), "search",
		search_json(recognition, query), "neighbours", neighbours_json(unknown, recognition, query), "verdict",
		verdict_json(&recognition->verdict));
	if (json && query->explain && !explain_query(json, unknown->skeleton, query)) {
		json_decref(json);
		return NULL;
	}
	return json;
}
