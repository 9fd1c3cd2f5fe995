/* An explanation as JSON, see explanation.h. */
#include "explanation.h"

enum { default_level = 10 };

uint32_t esk_explanation_level(const eskel_skeleton *skeleton, const esk_parameters *query)
{
	const uint32_t level = query->level ? query->level : default_level;
	return level < skeleton->level_count ? level : skeleton->level_count;
}

/* Appends to an array until memory runs out: false, and the array is gone. */
static bool append(json_t **array, json_t *item)
{
	if (json_array_append_new(*array, item) == 0)
		return true;
	json_decref(*array);
	*array = NULL;
	return false;
}

static json_t *matrix_json(const double *rows, size_t row_size)
{
	json_t *matrix = json_array();
	for (int r = 0; r < 3 && append(&matrix, esk_json_reals(rows + (size_t)r * row_size, row_size)); r++)
		;
	return matrix;
}

json_t *esk_explanation_classes(const eskel_skeleton *skeleton, uint32_t level)
{
	json_t *classes = json_array();
	for (uint32_t i = 0; i < level && classes; i++) {
		const eskel_node *node = eskel_skeleton_node(skeleton, level, i);
		append(&classes, json_pack("{s:i, s:I, s:o, s:o}", "class", (int)i, "voxels", (json_int_t)node->voxels,
					 "centre_mm", esk_json_reals(node->centre, 3), "covariance_mm2",
					 matrix_json(node->covariance[0], 3)));
	}
	return classes;
}

static json_t *match_json(const eskel_match *match)
{
	json_t *pairs = json_array();
	for (uint32_t i = 0; i < match->level && pairs; i++)
		append(&pairs,
			json_pack("[i, i, o]", (int)i, (int)match->other[i], esk_json_real(match->pair_cost[i])));
	return json_pack("{s:i, s:o}", "level", (int)match->level, "pairs", pairs);
}

static json_t *difference_json(const esk_difference *d)
{
	return json_pack("{s:i, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:b, s:s?}", "class", (int)d->class_index,
		"other", (int)d->other, "length_ratio", esk_json_reals(d->length_ratio, 3), "elongation_ratio",
		esk_json_real(d->elongation_ratio), "flatness_ratio", esk_json_real(d->flatness_ratio), "share_ratio",
		esk_json_real(d->share_ratio), "solidity_difference", esk_json_real(d->solidity_difference),
		"rho_difference_mm", esk_json_real(d->rho_difference), "importance", esk_json_real(d->importance),
		"remarkable", (int)d->remarkable, "text", d->text[0] ? d->text : NULL);
}

static json_t *differences_json(const esk_difference *differences, uint32_t count)
{
	json_t *array = json_array();
	for (uint32_t i = 0; i < count && append(&array, difference_json(&differences[i])); i++)
		;
	return array;
}

static bool add_differences(json_t *json, const esk_compared *query, const esk_compared *neighbour,
	const eskel_match *match, eskel_size size)
{
	esk_difference differences[ESKEL_LEVELS_MAX];
	esk_whole_difference whole;
	esk_differences_of_classes(query, neighbour, match, size, differences);
	esk_difference_of_wholes(query, neighbour, size, differences, match->level, &whole);
	json_t *summary = json_pack("{s:o, s:o, s:s}", "volume_ratio", esk_json_real(whole.volume_ratio),
		"length_ratio", esk_json_reals(whole.length_ratio, 3), "text", whole.text);
	return json_object_set_new(json, "summary", summary) == 0 &&
	       json_object_set_new(json, "differences", differences_json(differences, match->level)) == 0;
}

static json_t *split_json(int32_t class_index)
{
	return class_index < 0 ? json_null() : json_integer(class_index);
}

static bool add_isomorphism(
	json_t *json, const esk_compared *query, const esk_compared *neighbour, const eskel_distance_options *options)
{
	eskel_isomorphism found;
	if (eskel_isomorphism_find(query->skeleton, neighbour->skeleton, options, &found) != ESKEL_OK)
		return false;
	json_t *others = json_array();
	for (uint32_t i = 0; i < found.depth && others; i++)
		append(&others, json_integer(found.other[ESKEL_NODES(found.depth - 1) + i]));
	json_t *isomorphism = json_pack("{s:i, s:b, s:o, s:o, s:o}", "depth", (int)found.depth, "complete",
		(int)found.complete, "query_splits", split_json(found.split_class[0]), "neighbour_splits",
		split_json(found.split_class[1]), "others", others);
	return json_object_set_new(json, "isomorphism", isomorphism) == 0;
}

static bool add_partition(json_t *json, const esk_compared *query, const esk_compared *neighbour,
	const eskel_match *match, eskel_size size)
{
	eskel_partition_signature *a = NULL, *b = NULL;
	eskel_partition_difference d;
	const bool good =
		eskel_partition_signature_new(query->skeleton, match->level, NULL, &a) == ESKEL_OK &&
		eskel_partition_signature_new(neighbour->skeleton, match->level, match->other, &b) == ESKEL_OK &&
		eskel_partition_signature_compare(a, b, size, &d) == ESKEL_OK;
	eskel_partition_signature_free(a);
	eskel_partition_signature_free(b);
	return good && json_object_set_new(json, "partition",
			       json_pack("{s:i, s:o, s:o, s:o, s:o}", "level", (int)match->level, "distances_mm",
				       esk_json_real(d.distances), "tetrahedra_mm3", esk_json_real(d.tetrahedra),
				       "same_tetrahedra_mm3", esk_json_real(d.same_tetrahedra),
				       "mirrored_tetrahedra_mm3", esk_json_real(d.mirrored_tetrahedra))) == 0;
}

/* Of the hand that lies better, as the chirality tells: what a viewer shows then agrees with the verdict. */
static bool add_superposition(
	json_t *json, const esk_compared *query, const esk_compared *neighbour, const eskel_chirality *chirality)
{
	eskel_superposition proper, improper;
	const bool mirrored = chirality->score < 0;
	eskel_superposition_find(query->skeleton, neighbour->skeleton, &proper, &improper);
	const eskel_superposition *found = mirrored ? &improper : &proper;
	json_t *superposition = json_pack("{s:b, s:o, s:o}", "mirrored", (int)mirrored, "matrix",
		matrix_json(found->map.m[0], 4), "rms_mm", esk_json_real(found->rms));
	return json_object_set_new(json, "superposition", superposition) == 0;
}

bool esk_explanation_add(json_t *json, const esk_compared *query, const esk_compared *neighbour,
	const eskel_chirality *chirality, const esk_parameters *parameters)
{
	const eskel_distance_options options = esk_parameters_distance(parameters);
	const uint32_t of_query = esk_explanation_level(query->skeleton, parameters);
	const uint32_t of_neighbour = esk_explanation_level(neighbour->skeleton, parameters);
	const uint32_t level = of_query < of_neighbour ? of_query : of_neighbour;
	eskel_match match;
	return eskel_match_level(query->signature, neighbour->signature, &options, level, &match) == ESKEL_OK &&
	       json_object_set_new(json, "classes", esk_explanation_classes(neighbour->skeleton, level)) == 0 &&
	       json_object_set_new(json, "match", match_json(&match)) == 0 &&
	       add_differences(json, query, neighbour, &match, options.size) &&
	       add_isomorphism(json, query, neighbour, &options) &&
	       add_partition(json, query, neighbour, &match, options.size) &&
	       add_superposition(json, query, neighbour, chirality);
}
