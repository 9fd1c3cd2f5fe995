/* POST /check: each label of a volume is recognised, held against the statistics of the class that it is said to be of, and
 * taken to pieces; then all are judged together (finding.c). Nothing is stored. */
#include "check.h"
#include "exchange.h"
#include "label_name.h"
#include "resources.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is usual in the library is told by the classes that a map names, and by as many as these, evenly spaced by name. */
#define CLASSES_OF_LIBRARY 16

/* The classes of the library. */
typedef struct {
	size_t count;
	char **names;
	char (*keys)[ESK_LABEL_KEY_SIZE]; /* "": none */
	esk_class_statistics *statistics;
	bool *counted; /* whether the statistics are made */
	esk_spread distances;
} vocabulary;

bool esk_check_check(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	if (query->level && query->distance != ESKEL_DISTANCE_LEVEL)
		return esk_problem_set(&exchange->problem, 400,
			"level is %u without a use, expected distance=level beside it", query->level);
	return true;
}

/* ---- vocabulary */

static bool open_vocabulary(eskel_exchange *exchange, vocabulary *v)
{
	eskel_store_error error = {0};
	eskel_store_status status = eskel_store_classes(exchange->api->store, &v->names, &v->count, &error);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	v->keys = calloc(v->count + 1, sizeof *v->keys);
	v->statistics = calloc(v->count + 1, sizeof *v->statistics);
	v->counted = calloc(v->count + 1, sizeof *v->counted);
	if (!v->keys || !v->statistics || !v->counted)
		return esk_problem_no_memory(&exchange->problem);
	for (size_t i = 0; i < v->count; i++)
		if (!esk_label_key(v->names[i], v->keys[i]))
			v->keys[i][0] = 0;
	return true;
}

static void close_vocabulary(vocabulary *v)
{
	for (size_t i = 0; v->statistics && i < v->count; i++)
		esk_class_statistics_clear(&v->statistics[i]);
	free(v->statistics);
	free(v->counted);
	free(v->keys);
	eskel_store_classes_free(v->names, v->count);
}

/* The class of that name, or else one that differs by its vocabulary alone; SIZE_MAX without. */
static size_t find_class(const vocabulary *v, const char *class)
{
	char key[ESK_LABEL_KEY_SIZE];
	for (size_t i = 0; class && i < v->count; i++)
		if (strcmp(v->names[i], class) == 0)
			return i;
	if (class && esk_label_key(class, key))
		for (size_t i = 0; i < v->count; i++)
			if (strcmp(v->keys[i], key) == 0)
				return i;
	return SIZE_MAX;
}

static bool count_class(eskel_exchange *exchange, vocabulary *v, size_t index)
{
	if (v->counted[index])
		return true;
	v->counted[index] = true;
	if (!esk_class_statistics_make(
		    exchange->api, &exchange->query, v->names[index], &v->statistics[index], &exchange->problem))
		return false;
	esk_spread_merge(&v->distances, &v->statistics[index].distances);
	return true;
}

static bool count_library(eskel_exchange *exchange, vocabulary *v)
{
	size_t count = v->count < CLASSES_OF_LIBRARY ? v->count : CLASSES_OF_LIBRARY;
	for (size_t i = 0; i < count; i++)
		if (!count_class(exchange, v, i * v->count / count))
			return false;
	return true;
}

/* ---- one label */

static bool measure_pieces(eskel_exchange *exchange, const eskel_cloud *cloud, esk_checked_label *label)
{
	eskel_components *components = NULL, *cavities = NULL;
	eskel_status status = eskel_cloud_components(cloud, &components);
	if (status == ESKEL_OK)
		status = eskel_cloud_cavities(cloud, &cavities);
	if (status == ESKEL_OK) {
		label->component_count = components->count;
		label->largest = components->sizes[0];
		label->second = components->count > 1 ? components->sizes[1] : 0;
		label->cavity_count = cavities->count;
		label->cavity_voxels = cavities->voxels;
	}
	eskel_components_free(components);
	eskel_components_free(cavities);
	return esk_problem_engine(&exchange->problem, status, NULL);
}

static bool recognize(eskel_exchange *exchange, const esk_choice *choice, esk_check_row *row)
{
	const esk_specimen *specimen = row->specimen;
	eskel_status status = eskel_placement_new(specimen->skeleton, &row->placement);
	const esk_unknown unknown = {&specimen->shape, row->placement, specimen->signature};
	return esk_problem_engine(&exchange->problem, status, NULL) &&
	       esk_recognition_make(
		       exchange->api, &unknown, choice, &exchange->query, &row->recognition, &exchange->problem);
}

/* The distance of the nearest neighbour that is of the verdict's class. */
static double told_distance(const esk_recognition *recognition)
{
	const char *class = recognition->verdict.class;
	for (size_t i = 0; class && i < recognition->count; i++) {
		const char *other = recognition->neighbours[i].known->shape.description.class;
		if (other && strcmp(other, class) == 0)
			return recognition->neighbours[i].found->distance;
	}
	return NAN;
}

static void describe(const esk_check_row *row, esk_checked_label *label)
{
	const eskel_shape *shape = &row->specimen->shape;
	const esk_verdict *verdict = &row->recognition.verdict;
	label->label = shape->label;
	label->said_class = shape->description.class;
	label->said_side = shape->description.side;
	label->told_class = verdict->class;
	label->told_side = verdict->side;
	label->class_score = verdict->class_score;
	label->side_score = verdict->side_score;
	label->told_distance = told_distance(&row->recognition);
	label->voxels = shape->voxels;
	label->volume = shape->volume;
	label->border = row->specimen->border;
}

/* Finds the nearest shape of the class said. */
static bool hold_against_said(eskel_exchange *exchange, vocabulary *v, esk_check_row *row, esk_checked_label *label)
{
	const size_t class = find_class(v, label->said_class);
	if (class == SIZE_MAX)
		return true;
	if (!count_class(exchange, v, class))
		return false;
	const esk_class_statistics *statistics = &v->statistics[class];
	if (statistics->count == 0)
		return true;
	row->class_index = class;
	label->class_is_known = true;
	label->volume_count = statistics->count;
	label->volume_mean = statistics->volumes.mean;
	label->volume_deviation = esk_spread_deviation(&statistics->volumes);
	return esk_class_statistics_distance(exchange->api, &exchange->query, statistics, row->specimen->signature,
		&label->said_distance, &exchange->problem);
}

static bool hold_against_class(eskel_exchange *exchange, vocabulary *v, esk_check_row *row, esk_checked_label *label)
{
	label->said_distance = label->z = NAN;
	row->class_index = SIZE_MAX;
	if (!hold_against_said(exchange, v, row, label))
		return false;
	if (row->class_index == SIZE_MAX)
		row->class_index = find_class(v, label->told_class);
	return row->class_index == SIZE_MAX || count_class(exchange, v, row->class_index);
}

static bool check_label(
	eskel_exchange *exchange, const esk_choice *choice, vocabulary *v, esk_check_row *row, esk_checked_label *label)
{
	if (!recognize(exchange, choice, row) || !measure_pieces(exchange, row->specimen->cloud, label))
		return false;
	describe(row, label);
	return hold_against_class(exchange, v, row, label);
}

/* ---- the map */

static bool make_rows(eskel_exchange *exchange, const esk_specimens *specimens, esk_check *check)
{
	check->rows = calloc(specimens->count + 1, sizeof *check->rows);
	check->labels = calloc(specimens->count + 1, sizeof *check->labels);
	check->findings = calloc(specimens->count + 1, sizeof *check->findings);
	if (!check->rows || !check->labels || !check->findings)
		return esk_problem_no_memory(&exchange->problem);
	for (size_t i = 0; i < specimens->count; i++)
		check->rows[i].specimen = &specimens->items[i];
	check->count = specimens->count;
	return true;
}

static void clear_rows(eskel_exchange *exchange, esk_check *check)
{
	for (size_t i = 0; i < check->count; i++) {
		eskel_placement_free(check->rows[i].placement);
		esk_recognition_clear(exchange->api, &check->rows[i].recognition);
	}
	free(check->rows);
	free(check->labels);
	free(check->findings);
}

static void judge(const vocabulary *v, esk_check *check)
{
	for (size_t i = 0; i < check->count; i++) {
		esk_checked_label *label = &check->labels[i];
		size_t class = check->rows[i].class_index;
		if (class != SIZE_MAX)
			label->z = esk_class_statistics_z(&v->statistics[class].distances, &v->distances,
				label->class_is_known ? label->said_distance : label->told_distance);
	}
	esk_findings_of_map(check->labels, check->count, check->findings);
}

static bool check_map(
	eskel_exchange *exchange, esk_specimens *specimens, const esk_choice *choice, vocabulary *v, esk_check *check)
{
	uint32_t level = exchange->query.level;
	uint32_t levels = level > ESKEL_LEVELS_DEFAULT ? level : ESKEL_LEVELS_DEFAULT;
	if (!esk_specimens_analyse(specimens, NULL, levels, &exchange->problem) || !open_vocabulary(exchange, v) ||
		!make_rows(exchange, specimens, check))
		return false;
	for (size_t i = 0; i < check->count; i++)
		if (!check_label(exchange, choice, v, &check->rows[i], &check->labels[i]))
			return false;
	if (!count_library(exchange, v))
		return false;
	judge(v, check);
	return true;
}

bool esk_check_volume(eskel_exchange *exchange)
{
	esk_specimens specimens = {0};
	esk_choice choice = {0};
	vocabulary v = {0};
	esk_check check = {0};
	bool good = esk_specimens_take_unknown(exchange, &specimens) &&
		    esk_choice_make(exchange->api, &exchange->query, &choice, &exchange->problem) &&
		    check_map(exchange, &specimens, &choice, &v, &check) &&
		    esk_exchange_answer_json(exchange, 200, esk_check_json(&check, &specimens));
	clear_rows(exchange, &check);
	close_vocabulary(&v);
	esk_choice_clear(&choice);
	esk_specimens_clear(&specimens);
	return good;
}
