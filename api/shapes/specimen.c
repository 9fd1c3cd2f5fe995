/* The labels of a posted volume, see specimen.h. */
#include "specimen.h"

#include "description.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------------------- labels */

static bool is_in(const eskel_volume *volume, int32_t label)
{
	for (size_t i = 0; i < eskel_volume_label_count(volume); i++)
		if (eskel_volume_label(volume, i) == label)
			return true;
	return false;
}

static bool is_asked(const esk_parameters *query, int32_t label)
{
	for (size_t i = 0; i < query->label_count; i++)
		if (query->labels[i] == label)
			return true;
	return query->label_count == 0;
}

static bool refuse_label(const eskel_volume *volume, int32_t label, esk_problem *problem)
{
	enum { most_named = 24 };
	char names[most_named * 13] = "";
	size_t count = eskel_volume_label_count(volume), used = 0;
	for (size_t i = 0; i < count && i < most_named; i++)
		used += (size_t)snprintf(names + used, sizeof names - used, "%s%" PRId32, i > 0 ? ", " : "",
			eskel_volume_label(volume, i));
	return esk_problem_set(problem, 422, "label %" PRId32 " is not in the volume, which has %s%s", label, names,
		count > most_named ? " and more" : "");
}

/* Every label that the query names is there, and label.N words are said only of labels that are asked for. */
static bool check_labels(const eskel_volume *volume, const esk_parameters *query, esk_problem *problem)
{
	for (size_t i = 0; i < query->label_count; i++)
		if (!is_in(volume, query->labels[i]))
			return refuse_label(volume, query->labels[i], problem);
	for (size_t i = 0; i < query->words_count; i++) {
		int32_t label = query->words[i].label;
		if (!is_in(volume, label))
			return refuse_label(volume, label, problem);
		if (!is_asked(query, label))
			return esk_problem_set(problem, 422,
				"label.%" PRId32 " is described, expected label=%" PRId32 " beside it", label, label);
	}
	return true;
}

/* ---------------------------------------------------------------------------------------------- clouds */

static bool take_cloud(esk_specimen *specimen, const eskel_volume *volume, int32_t label, esk_problem *problem)
{
	eskel_error error = {0};
	eskel_shape *shape = &specimen->shape;
	eskel_status status = eskel_volume_border(volume, label, &specimen->border);
	if (status == ESKEL_OK)
		status = eskel_volume_cloud(volume, label, &specimen->cloud, &error);
	if (!esk_problem_engine(problem, status, &error))
		return false;
	shape->label = label;
	shape->voxels = specimen->cloud->voxels;
	shape->volume = eskel_cloud_volume(specimen->cloud);
	return esk_problem_store(problem, eskel_store_identify(specimen->cloud, shape->id, shape->sha256), NULL);
}

static bool take_labels(
	esk_specimens *specimens, const eskel_volume *volume, const esk_parameters *query, esk_problem *problem)
{
	size_t count = eskel_volume_label_count(volume);
	if (!check_labels(volume, query, problem))
		return false;
	specimens->items = calloc(count, sizeof *specimens->items);
	if (!specimens->items)
		return esk_problem_no_memory(problem);
	for (size_t i = 0; i < count; i++) {
		int32_t label = eskel_volume_label(volume, i);
		if (!is_asked(query, label))
			continue;
		esk_specimen *specimen = &specimens->items[specimens->count++];
		specimen->shape.description.age = NAN;
		if (!take_cloud(specimen, volume, label, problem))
			return false;
		const char *name = eskel_volume_label_name(volume, label);
		if (!esk_description_of_label(query, label, name, &specimen->shape.description))
			return esk_problem_no_memory(problem);
	}
	return true;
}

bool esk_specimens_take(eskel_exchange *exchange, const esk_parameters *said, esk_specimens *specimens)
{
	eskel_error error = {0};
	eskel_volume *volume = NULL;
	eskel_status status = eskel_intake_finish(exchange->intake, &volume, &error);
	if (!esk_problem_engine(&exchange->problem, status, &error))
		return false;
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	specimens->warning_count = info->warning_count;
	memcpy(specimens->warnings, info->warnings, sizeof specimens->warnings);
	const bool good = take_labels(specimens, volume, said, &exchange->problem);
	eskel_volume_free(volume);
	return good;
}

bool esk_specimens_take_unknown(eskel_exchange *exchange, esk_specimens *specimens)
{
	const esk_parameters *query = &exchange->query;
	const esk_parameters said = {
		.name = query->name,
		.age = NAN,
		.label_count = query->label_count,
		.labels = query->labels,
		.words_count = query->words_count,
		.words = query->words,
	};
	return esk_specimens_take(exchange, &said, specimens);
}

void esk_specimens_clear(esk_specimens *specimens)
{
	for (size_t i = 0; i < specimens->count; i++) {
		esk_specimen *specimen = &specimens->items[i];
		eskel_cloud_free(specimen->cloud);
		eskel_skeleton_free(specimen->skeleton);
		eskel_signature_free(specimen->signature);
		eskel_shape_clear(&specimen->shape);
	}
	free(specimens->items);
	*specimens = (esk_specimens){0};
}

/* ---------------------------------------------------------------------------------------------- analysis */

/* Arrays have room for all specimens. */
typedef struct {
	size_t count;
	esk_specimen **specimens;
	const eskel_cloud **clouds;
	eskel_skeleton **skeletons;
} analysis;

static bool choose(analysis *a, esk_specimens *specimens, const bool *wanted)
{
	a->specimens = calloc(specimens->count, sizeof *a->specimens);
	a->clouds = calloc(specimens->count, sizeof *a->clouds);
	a->skeletons = calloc(specimens->count, sizeof *a->skeletons);
	if (!a->specimens || !a->clouds || !a->skeletons)
		return false;
	for (size_t i = 0; i < specimens->count; i++) {
		esk_specimen *specimen = &specimens->items[i];
		if (specimen->skeleton || (wanted && !wanted[i]))
			continue;
		a->specimens[a->count] = specimen;
		a->clouds[a->count++] = specimen->cloud;
	}
	return true;
}

/* Signature and warnings. */
static bool finish(esk_specimen *specimen, const esk_specimens *specimens, uint32_t levels, esk_problem *problem)
{
	eskel_status status = eskel_signature_new(specimen->skeleton, &specimen->signature);
	if (!esk_problem_engine(problem, status, NULL))
		return false;
	specimen->shape.levels = specimen->skeleton->level_count;
	memcpy(specimen->shape.centre, eskel_skeleton_node(specimen->skeleton, 1, 0)->centre,
		sizeof specimen->shape.centre);
	return esk_specimen_warn(specimen, specimens, levels) || esk_problem_no_memory(problem);
}

static bool analyse(analysis *a, const esk_specimens *specimens, uint32_t levels, esk_problem *problem)
{
	eskel_error error = {0};
	const eskel_skeleton_options options = {.levels = levels, .threads = ESKEL_THREADS_ONLINE};
	eskel_status status = eskel_skeletons_new(a->clouds, a->count, &options, a->skeletons, &error);
	if (!esk_problem_engine(problem, status, &error))
		return false;
	for (size_t i = 0; i < a->count; i++)
		a->specimens[i]->skeleton = a->skeletons[i];
	for (size_t i = 0; i < a->count; i++)
		if (!finish(a->specimens[i], specimens, levels, problem))
			return false;
	return true;
}

bool esk_specimens_analyse(esk_specimens *specimens, const bool *wanted, uint32_t levels, esk_problem *problem)
{
	analysis a = {0};
	const bool good = choose(&a, specimens, wanted) ? analyse(&a, specimens, levels, problem)
							: esk_problem_no_memory(problem);
	free(a.specimens);
	free(a.clouds);
	free(a.skeletons);
	return good;
}
