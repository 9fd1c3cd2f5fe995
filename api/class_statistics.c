/* Spreads of distances and volumes in a class, see class_statistics.h. */
#include "class_statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_COUNTED 32
#define MOST_SAMPLED 256

/* As many neighbours of the same subject are passed over: both sides, each segmented three times. */
#define MOST_PASSED_OVER 6

/* Copies are at distance 0, which has no logarithm, or at what the rounding to 32-bit floats leaves of it. */
#define LEAST_DISTANCE 1e-6

/* Pretended numbers of the library in each class. */
#define LIBRARY_SHARE 3

/* ---- spreads */

/* Welford's update. */
void esk_spread_add(esk_spread *spread, double number)
{
	const double before = number - spread->mean;
	spread->count++;
	spread->mean += before / (double)spread->count;
	spread->squares += before * (number - spread->mean);
}

void esk_spread_merge(esk_spread *spread, const esk_spread *other)
{
	const double a = (double)spread->count, b = (double)other->count, apart = other->mean - spread->mean;
	if (other->count == 0)
		return;
	spread->count += other->count;
	spread->mean += apart * b / (a + b);
	spread->squares += other->squares + apart * apart * a * b / (a + b);
}

double esk_spread_deviation(const esk_spread *spread)
{
	return spread->count > 0 ? sqrt(spread->squares / (double)spread->count) : NAN;
}

double esk_class_statistics_z(const esk_spread *class, const esk_spread *library, double distance)
{
	if (library->count == 0 || isnan(distance))
		return NAN;
	esk_spread pretended = {
		LIBRARY_SHARE, library->mean, LIBRARY_SHARE * library->squares / (double)library->count};
	esk_spread_merge(&pretended, class);
	const double deviation = esk_spread_deviation(&pretended);
	return deviation > 0 ? (log(fmax(distance, LEAST_DISTANCE)) - pretended.mean) / deviation : NAN;
}

/* ---- of a class */

static bool find_keys(eskel_api *api, const esk_parameters *query, const char *class, esk_class_statistics *statistics,
	esk_problem *problem)
{
	eskel_filter filter = esk_parameters_filter(query);
	eskel_store_error error = {0};
	if (filter.class && strcmp(filter.class, class) != 0)
		return true;
	filter.class = class;
	eskel_store_status status =
		eskel_store_keys(api->store, &filter, &statistics->keys, &statistics->count, &error);
	return esk_problem_store(problem, status, &error);
}

/* NULL when it was deleted since. */
static bool know(eskel_api *api, int64_t key, const esk_known_shape **known, esk_problem *problem)
{
	eskel_store_error error = {0};
	eskel_store_status status = esk_known_by_key(api->known, key, known, &error);
	return status == ESKEL_STORE_NOT_FOUND || esk_problem_store(problem, status, &error);
}

static eskel_search_options search_options(const esk_parameters *query, const int64_t *keys, size_t count)
{
	return (eskel_search_options){.distance = esk_parameters_distance(query), .keys = keys, .key_count = count};
}

static bool is_of_subject(eskel_api *api, const char *subject, int64_t key, bool *same, esk_problem *problem)
{
	const esk_known_shape *known = NULL;
	if (!know(api, key, &known, problem))
		return false;
	const char *other = known ? known->shape.description.subject : NULL;
	*same = other && strcmp(other, subject) == 0;
	esk_known_release(api->known, known);
	return true;
}

/* Adds the distance of one shape from the nearest of another subject, or else from the nearest. */
static bool add_distance(eskel_api *api, const esk_parameters *query, esk_class_statistics *statistics,
	const esk_known_shape *shape, esk_problem *problem)
{
	eskel_search_result *result = NULL;
	const char *subject = shape->shape.description.subject;
	eskel_search_options options = search_options(query, statistics->keys, statistics->count);
	options.limit = MOST_PASSED_OVER + 1;
	options.leave_out = true;
	options.left_out_key = shape->shape.key;
	eskel_status status = eskel_library_search(api->library, shape->signature, &options, &result);
	bool good = esk_problem_engine(problem, status, NULL);
	size_t nearest = 0;
	bool same = subject != NULL;
	for (size_t i = 0; good && same && i < result->count; i++) {
		good = is_of_subject(api, subject, result->neighbours[i].key, &same, problem);
		nearest = same ? 0 : i;
	}
	if (good && result->count > 0)
		esk_spread_add(&statistics->distances, log(fmax(result->neighbours[nearest].distance, LEAST_DISTANCE)));
	eskel_search_result_free(result);
	return good;
}

static bool add_shape(eskel_api *api, const esk_parameters *query, esk_class_statistics *statistics, int64_t key,
	esk_problem *problem)
{
	const esk_known_shape *shape = NULL;
	if (!know(api, key, &shape, problem))
		return false;
	bool good = !shape || add_distance(api, query, statistics, shape, problem);
	if (shape)
		esk_spread_add(&statistics->volumes, log(shape->shape.volume));
	esk_known_release(api->known, shape);
	return good;
}

static bool take_sample(esk_class_statistics *statistics)
{
	const size_t count = statistics->count, sampled = count < MOST_SAMPLED ? count : MOST_SAMPLED;
	statistics->sample = calloc(sampled + 1, sizeof *statistics->sample);
	if (!statistics->sample)
		return false;
	for (size_t i = 0; i < sampled; i++)
		statistics->sample[i] = statistics->keys[i * count / sampled];
	statistics->sample_count = sampled;
	return true;
}

bool esk_class_statistics_make(eskel_api *api, const esk_parameters *query, const char *class,
	esk_class_statistics *statistics, esk_problem *problem)
{
	if (!find_keys(api, query, class, statistics, problem))
		return false;
	if (!take_sample(statistics))
		return esk_problem_no_memory(problem);
	const size_t count = statistics->count, counted = count < MOST_COUNTED ? count : MOST_COUNTED;
	for (size_t i = 0; i < counted; i++)
		if (!add_shape(api, query, statistics, statistics->keys[i * count / counted], problem))
			return false;
	return true;
}

void esk_class_statistics_clear(esk_class_statistics *statistics)
{
	free(statistics->keys);
	free(statistics->sample);
	*statistics = (esk_class_statistics){0};
}

bool esk_class_statistics_distance(eskel_api *api, const esk_parameters *query, const esk_class_statistics *statistics,
	esk_among among, const eskel_signature *signature, double *distance, esk_problem *problem)
{
	eskel_search_result *result = NULL;
	eskel_search_options options = among == ESK_AMONG_ALL
					       ? search_options(query, statistics->keys, statistics->count)
					       : search_options(query, statistics->sample, statistics->sample_count);
	options.limit = 1;
	*distance = NAN;
	if (options.key_count == 0)
		return true;
	eskel_status status = eskel_library_search(api->library, signature, &options, &result);
	if (status == ESKEL_OK && result->count > 0)
		*distance = result->neighbours[0].distance;
	eskel_search_result_free(result);
	return esk_problem_engine(problem, status, NULL);
}
