/* Volumes and distances of a class, see class_statistics.h. */
#include "class_statistics.h"

#include "sample.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_COUNTED 32
#define MOST_SAMPLED 256

/* Welford's update. */
void esk_spread_add(esk_spread *spread, double number)
{
	const double before = number - spread->mean;
	spread->count++;
	spread->mean += before / (double)spread->count;
	spread->squares += before * (number - spread->mean);
}

double esk_spread_deviation(const esk_spread *spread)
{
	return spread->count > 0 ? sqrt(spread->squares / (double)spread->count) : NAN;
}

static bool find_keys(
	eskel_api *api, const esk_parameters *query, const char *class, esk_class_keys *keys, esk_problem *problem)
{
	eskel_filter filter = esk_parameters_filter(query);
	eskel_store_error error = {0};
	if (filter.class && strcmp(filter.class, class) != 0)
		return true;
	filter.class = class;
	eskel_store_status status = eskel_store_keys(api->store, &filter, &keys->blocks, &keys->block_count, &error);
	return esk_problem_store(problem, status, &error);
}

static bool take_sample(esk_class_statistics *statistics)
{
	int64_t keys[MOST_SAMPLED];
	const size_t count = esk_sample_choose(statistics->all.blocks, statistics->all.block_count, MOST_SAMPLED, keys);
	statistics->sample.blocks = calloc(count + 1, sizeof *statistics->sample.blocks);
	if (!statistics->sample.blocks)
		return false;
	for (size_t i = 0; i < count; i++)
		statistics->sample.block_count =
			eskel_key_blocks_add(statistics->sample.blocks, statistics->sample.block_count, keys[i], 1);
	return true;
}

/* Passes over one that was deleted since. */
static bool add_volume(eskel_api *api, int64_t key, esk_spread *volumes, esk_problem *problem)
{
	const esk_known_shape *known = NULL;
	eskel_store_error error = {0};
	eskel_store_status status = esk_known_by_key(api->known, key, &known, &error);
	if (status == ESKEL_STORE_OK)
		esk_spread_add(volumes, log(known->shape.volume));
	esk_known_release(api->known, known);
	return status == ESKEL_STORE_NOT_FOUND || esk_problem_store(problem, status, &error);
}

bool esk_class_statistics_make(eskel_api *api, const esk_parameters *query, const char *class,
	esk_class_statistics *statistics, esk_problem *problem)
{
	int64_t counted[MOST_COUNTED];
	if (!find_keys(api, query, class, &statistics->all, problem))
		return false;
	if (!take_sample(statistics))
		return esk_problem_no_memory(problem);
	const size_t count =
		esk_sample_choose(statistics->all.blocks, statistics->all.block_count, MOST_COUNTED, counted);
	for (size_t i = 0; i < count; i++)
		if (!add_volume(api, counted[i], &statistics->volumes, problem))
			return false;
	return true;
}

void esk_class_statistics_clear(esk_class_statistics *statistics)
{
	free(statistics->all.blocks);
	free(statistics->sample.blocks);
	*statistics = (esk_class_statistics){0};
}

bool esk_class_statistics_distance(eskel_api *api, const esk_parameters *query, const esk_class_keys *keys,
	const eskel_signature *signature, double *distance, esk_problem *problem)
{
	eskel_search_result *result = NULL;
	const eskel_search_options options = {
		.distance = esk_parameters_distance(query),
		.limit = 1,
		.keys = keys->blocks,
		.key_block_count = keys->block_count,
	};
	*distance = NAN;
	if (keys->block_count == 0)
		return true;
	eskel_status status = eskel_library_search(api->library, signature, &options, &result);
	if (status == ESKEL_OK && result->count > 0)
		*distance = result->neighbours[0].distance;
	eskel_search_result_free(result);
	return esk_problem_engine(problem, status, NULL);
}
