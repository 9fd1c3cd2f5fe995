/* POST /check: each label of a volume is recognised, held against the statistics of the class that it is said to be of, and
 * taken to pieces; then all are judged together (finding.c). Nothing is stored. */
#include "check.h"

#include "calibration.h"
#include "exchange.h"
#include "resources.h"
#include "vocabulary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool esk_check_check(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	if (query->level && query->distance != ESKEL_DISTANCE_LEVEL)
		return esk_problem_set(&exchange->problem, 400,
			"level is %u without a use, expected distance=level beside it", query->level);
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
	const esk_unknown unknown = {&specimen->shape, row->placement, specimen->signature, NULL};
	return esk_problem_engine(&exchange->problem, status, NULL) &&
	       esk_recognition_make(
		       exchange->api, &unknown, choice, &exchange->query, &row->recognition, &exchange->problem);
}

/* The distance of the nearest neighbour that has a class. */
static double told_distance(const esk_recognition *recognition)
{
	const char *class = recognition->verdict.nearest_class;
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
	label->told_class = verdict->nearest_class;
	label->is_unknown = !verdict->class;
	label->told_side = verdict->side;
	label->class_score = verdict->class_score;
	label->side_score = verdict->side_score;
	label->told_distance = told_distance(&row->recognition);
	label->voxels = shape->voxels;
	label->volume = shape->volume;
	label->border = row->specimen->border;
}

/* What the class said says of the side: the verdict, or that of another recognition among this class alone. */
static bool ask_class_for_side(eskel_exchange *exchange, const esk_class_statistics *statistics,
	const esk_check_row *row, esk_checked_label *label)
{
	const esk_unknown unknown = {&row->specimen->shape, row->placement, row->specimen->signature, NULL};
	const esk_choice choice = {statistics->all.blocks, statistics->all.block_count};
	esk_recognition recognition = {0};
	label->side_in_class = label->told_side;
	label->side_in_class_score = label->side_score;
	if (label->told_class && esk_label_same_class(label->said_class, label->told_class))
		return true;
	bool good = esk_recognition_make(
		exchange->api, &unknown, &choice, &exchange->query, &recognition, &exchange->problem);
	label->side_in_class = recognition.verdict.side;
	label->side_in_class_score = recognition.verdict.side_score;
	esk_recognition_clear(exchange->api, &recognition);
	return good;
}

/* Finds the nearest shape of the class said. */
static bool hold_against_said(eskel_exchange *exchange, esk_vocabulary *v, esk_check_row *row, esk_checked_label *label)
{
	const size_t class = esk_vocabulary_find(v, label->said_class);
	if (class == SIZE_MAX)
		return true;
	if (!esk_vocabulary_count(v, exchange, class))
		return false;
	const esk_class_statistics *statistics = &v->statistics[class];
	if (statistics->all.block_count == 0)
		return true;
	row->class_index = class;
	label->class_is_known = true;
	label->volume_count = statistics->volumes.count;
	label->volume_mean = statistics->volumes.mean;
	label->volume_deviation = esk_spread_deviation(&statistics->volumes);
	return ask_class_for_side(exchange, statistics, row, label) &&
	       esk_class_statistics_distance(exchange->api, &exchange->query, &statistics->all,
		       row->specimen->signature, &label->said_distance, &exchange->problem);
}

/* z is that of the class said where the library has it, or else of the class told. */
static bool hold_against_class(
	eskel_exchange *exchange, esk_vocabulary *v, esk_check_row *row, esk_checked_label *label)
{
	label->said_distance = NAN;
	row->class_index = SIZE_MAX;
	label->z = row->recognition.verdict.distance_z;
	if (!hold_against_said(exchange, v, row, label))
		return false;
	if (!label->class_is_known)
		return true;
	const eskel_distance_options distance = esk_parameters_distance(&exchange->query);
	return esk_calibration_z(exchange->api->calibration, &distance, v->names[row->class_index],
		label->said_distance, &label->z, &exchange->problem);
}

static bool check_label(eskel_exchange *exchange, const esk_choice *choice, esk_vocabulary *v, esk_check_row *row,
	esk_checked_label *label)
{
	if (!recognize(exchange, choice, row) || !measure_pieces(exchange, row->specimen->cloud, label))
		return false;
	describe(row, label);
	return hold_against_class(exchange, v, row, label);
}

/* ---- the map */

/* Numbers the library's classes that the labels say; classes has room for all labels. How many there are. */
static size_t number_classes(const esk_check *check, size_t *classes)
{
	size_t count = 0;
	for (size_t i = 0; i < check->count; i++) {
		esk_checked_label *label = &check->labels[i];
		if (!label->class_is_known)
			continue;
		classes[count] = check->rows[i].class_index; /* stops the search */
		while (classes[label->class_number] != check->rows[i].class_index)
			label->class_number++;
		count += label->class_number == count;
	}
	return count;
}

/* Finds each label's nearest shape of each class that the labels say. */
static bool compare_with_classes(eskel_exchange *exchange, const esk_vocabulary *v, esk_check *check)
{
	size_t *classes = calloc(check->count + 1, sizeof *classes);
	size_t count = classes ? number_classes(check, classes) : 0;
	check->distances = calloc(check->count * count + 1, sizeof *check->distances);
	bool good = (classes && check->distances) || esk_problem_no_memory(&exchange->problem);
	for (size_t cell = 0; good && cell < check->count * count; cell++)
		good = esk_class_statistics_distance(exchange->api, &exchange->query,
			&v->statistics[classes[cell % count]].sample, check->rows[cell / count].specimen->signature,
			&check->distances[cell], &exchange->problem);
	for (size_t i = 0; good && i < check->count; i++)
		check->labels[i].class_distances = &check->distances[i * count];
	free(classes);
	return good;
}

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
	free(check->distances);
}

static bool check_map(eskel_exchange *exchange, esk_specimens *specimens, const esk_choice *choice, esk_vocabulary *v,
	esk_check *check)
{
	uint32_t level = exchange->query.level;
	uint32_t levels = level > ESKEL_LEVELS_DEFAULT ? level : ESKEL_LEVELS_DEFAULT;
	if (!esk_specimens_analyse(specimens, NULL, levels, &exchange->problem) || !esk_vocabulary_open(v, exchange) ||
		!make_rows(exchange, specimens, check))
		return false;
	for (size_t i = 0; i < check->count; i++)
		if (!check_label(exchange, choice, v, &check->rows[i], &check->labels[i]))
			return false;
	if (!compare_with_classes(exchange, v, check))
		return false;
	esk_findings_of_map(check->labels, check->count, check->findings);
	return true;
}

bool esk_check_volume(eskel_exchange *exchange)
{
	esk_specimens specimens = {0};
	esk_choice choice = {0};
	esk_vocabulary v = {0};
	esk_check check = {0};
	bool good = esk_specimens_take_unknown(exchange, &specimens) &&
		    esk_choice_make(exchange->api, &exchange->query, &choice, &exchange->problem) &&
		    check_map(exchange, &specimens, &choice, &v, &check) &&
		    esk_exchange_answer_json(exchange, 200, esk_check_json(&check, &specimens));
	clear_rows(exchange, &check);
	esk_vocabulary_close(&v);
	esk_choice_clear(&choice);
	esk_specimens_clear(&specimens);
	return good;
}
