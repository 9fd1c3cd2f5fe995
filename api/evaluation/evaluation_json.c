/* An evaluation as JSON, see evaluation.h. Shares are null where nothing was counted. */
#include "evaluation.h"

#include <math.h>
#include <stdlib.h>

/* The parameters that make a distance, as they are called in a query. */
static const char *const choices[] = {"signature", "distance", "metric", "size"};

static json_t *distance_json(const esk_parameters *query)
{
	const eskel_distance_options options = esk_parameters_distance(query);
	json_t *distance = json_object();
	int failed = 0;
	for (size_t i = 0; i < sizeof choices / sizeof *choices; i++)
		failed |= json_object_set_new(
			distance, choices[i], json_string(esk_parameters_choice(query, choices[i])));
	bool one_level = options.distance == ESKEL_DISTANCE_LEVEL;
	failed |= json_object_set_new(distance, "level",
		one_level ? json_integer(options.level ? options.level : ESK_LEVEL_DEFAULT) : json_null());
	if (!failed)
		return distance;
	json_decref(distance);
	return NULL;
}

static json_t *share(double part, size_t whole)
{
	return whole > 0 ? esk_json_real(part / (double)whole) : json_null();
}

/* An array of count items. NULL when memory ran out. */
static json_t *array_of(size_t count, json_t *(*item)(const void *context, size_t index), const void *context)
{
	json_t *array = json_array();
	for (size_t i = 0; array && i < count; i++)
		if (json_array_append_new(array, item(context, i)) != 0) {
			json_decref(array);
			return NULL;
		}
	return array;
}

/* ---- retrieval */

static json_t *measures_json(const esk_evaluation *e)
{
	const size_t some = e->query_count;
	return json_pack("{s:o, s:o, s:o, s:o, s:o}", "nearest_neighbour",
		some ? esk_json_real(e->mean.nearest_neighbour) : json_null(), "first_tier",
		some ? esk_json_real(e->mean.first_tier) : json_null(), "second_tier",
		some ? esk_json_real(e->mean.second_tier) : json_null(), "e_measure",
		some ? esk_json_real(e->mean.e_measure) : json_null(), "dcg",
		some ? esk_json_real(e->mean.dcg) : json_null());
}

static json_t *precision_json(const void *context, size_t step)
{
	const esk_evaluation *e = context;
	return json_pack("{s:o, s:o}", "recall", esk_json_real((double)(step + 1) / ESKEL_RECALL_STEPS), "precision",
		e->query_count ? esk_json_real(e->mean.precision[step]) : json_null());
}

/* ---- confusion */

/* The class of a query and that of its nearest shape. */
typedef struct {
	uint32_t class, nearest;
} outcome;

static int by_classes(const void *a, const void *b)
{
	const outcome *x = a, *y = b;
	if (x->class != y->class)
		return x->class < y->class ? -1 : 1;
	return x->nearest < y->nearest ? -1 : x->nearest > y->nearest;
}

/* Of the queries, ascending. */
static outcome *list_outcomes(const esk_evaluation *e)
{
	outcome *outcomes = calloc(e->query_count + 1, sizeof *outcomes);
	size_t count = 0;
	for (size_t i = 0; outcomes && i < e->count; i++)
		if (e->retrievals[i].relevant > 0)
			outcomes[count++] = (outcome){e->classes[i], e->classes[e->nearest[i].nearest]};
	if (outcomes)
		qsort(outcomes, count, sizeof *outcomes, by_classes);
	return outcomes;
}

static json_t *class_name(const esk_evaluation *e, uint32_t class)
{
	return class == ESKEL_UNNUMBERED ? json_null() : json_string(e->class_names[class]);
}

/* How often each class was nearest to outcomes[count], all of one class. */
static json_t *nearest_json(const esk_evaluation *e, const outcome *outcomes, size_t count)
{
	json_t *array = json_array();
	for (size_t begin = 0, end; begin < count; begin = end) {
		for (end = begin; end < count && outcomes[end].nearest == outcomes[begin].nearest; end++)
			;
		json_t *one = json_pack("{s:o, s:I}", "class", class_name(e, outcomes[begin].nearest), "queries",
			(json_int_t)(end - begin));
		if (json_array_append_new(array, one) != 0) {
			json_decref(array);
			return NULL;
		}
	}
	return array;
}

static json_t *confusion_json(const esk_evaluation *e)
{
	outcome *outcomes = list_outcomes(e);
	json_t *array = outcomes ? json_array() : NULL;
	for (size_t begin = 0, end; array && begin < e->query_count; begin = end) {
		size_t right = 0;
		for (end = begin; end < e->query_count && outcomes[end].class == outcomes[begin].class; end++)
			right += outcomes[end].nearest == outcomes[end].class;
		json_t *row = json_pack("{s:o, s:I, s:I, s:o}", "class", class_name(e, outcomes[begin].class),
			"queries", (json_int_t)(end - begin), "right", (json_int_t)right, "nearest",
			nearest_json(e, outcomes + begin, end - begin));
		if (json_array_append_new(array, row) != 0) {
			json_decref(array);
			array = NULL;
		}
	}
	free(outcomes);
	return array;
}

/* ---- sides and searches */

static json_t *threshold_json(const void *context, size_t t)
{
	const esk_side_accuracy *side = context;
	return json_pack("{s:o, s:I, s:I}", "threshold", esk_json_real(esk_side_thresholds[t]), "decided",
		(json_int_t)side->at[t].decided, "right", (json_int_t)side->at[t].right);
}

static json_t *step_json(const void *context, size_t step)
{
	const esk_search_accuracy *search = context;
	return json_pack("{s:I, s:o, s:o}", "level", (json_int_t)step + 1, "kept",
		share((double)search->steps[step].kept, search->searches), "recall",
		share((double)search->steps[step].outlived, search->searches));
}

static json_t *times_json(const double times[3], size_t searches)
{
	double rounded[3];
	for (int i = 0; i < 3; i++)
		rounded[i] = searches ? round(1e4 * times[i]) / 1e4 : NAN;
	return json_pack("{s:o, s:o, s:o}", "mean", esk_json_real(rounded[0]), "median", esk_json_real(rounded[1]),
		"p95", esk_json_real(rounded[2]));
}

json_t *esk_evaluation_json(const esk_evaluation *evaluation, const esk_parameters *query)
{
	const esk_search_accuracy *search = &evaluation->search;
	return json_pack("{s:o, s:s, s:I, s:I, s:I, s:o, s:o, s:o, s:{s:I, s:o}, s:{s:I, s:o, s:o}, s:{s:o, s:o}}",
		"distance", distance_json(query), "leave_out", esk_parameters_choice(query, "leave_out"), "shapes",
		(json_int_t)evaluation->count, "classes", (json_int_t)evaluation->class_count, "queries",
		(json_int_t)evaluation->query_count, "measures", measures_json(evaluation), "precision_recall",
		array_of(ESKEL_RECALL_STEPS, precision_json, evaluation), "confusion", confusion_json(evaluation),
		"side", "compared", (json_int_t)evaluation->side.compared, "thresholds",
		array_of(ESK_SIDE_THRESHOLDS, threshold_json, &evaluation->side), "pruned", "searches",
		(json_int_t)search->searches, "recall", share((double)search->found, search->searches), "steps",
		array_of(search->step_count, step_json, search), "milliseconds", "exact",
		times_json(search->exact, search->searches), "pruned", times_json(search->pruned, search->searches));
}
