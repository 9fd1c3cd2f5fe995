/* GET /distances: every pair of the shapes that are named or that a filter leaves. */
#include "exchange.h"
#include "matrix_text.h"
#include "resources.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* A shape may be in the store and not yet, or no longer, in the library while a change is under way. Each such change is
 * waited for; so many in a row do not happen to an honest client. */
#define MOST_ATTEMPTS 8

bool esk_distances_check(eskel_exchange *exchange)
{
	const esk_parameters *query = &exchange->query;
	const eskel_filter filter = esk_parameters_filter(query);
	if (query->id_count > 0 && !eskel_filter_is_none(&filter))
		return esk_problem_set(&exchange->problem, 400, "id is given beside a filter, expected one of the two");
	if (query->level && query->distance != ESKEL_DISTANCE_LEVEL)
		return esk_problem_set(&exchange->problem, 400,
			"level is %u without a use, expected distance=level beside it", query->level);
	return true;
}

static bool check_count(eskel_exchange *exchange, uint64_t count, const char *more)
{
	uint64_t most = exchange->api->options.most_distances;
	if (count == 0 || count <= most / count)
		return true;
	return esk_problem_set(&exchange->problem, 413,
		"%s%" PRIu64 " shapes are %s%" PRIu64 " distances, expected at most %" PRIu64, more, count, more,
		count * count, most);
}

static bool read_named(eskel_exchange *exchange, esk_matrix *matrix)
{
	const esk_parameters *query = &exchange->query;
	if (!check_count(exchange, query->id_count, ""))
		return false;
	matrix->shapes = calloc(query->id_count, sizeof *matrix->shapes);
	if (!matrix->shapes)
		return esk_problem_no_memory(&exchange->problem);
	for (; matrix->count < query->id_count; matrix->count++)
		if (!esk_shape_of_id(exchange, query->ids[matrix->count], &matrix->shapes[matrix->count]))
			return false;
	return true;
}

/* The most shapes whose matrix is within the limit. */
static size_t most_shapes(const eskel_exchange *exchange)
{
	size_t most = 1;
	while ((uint64_t)(most + 1) * (most + 1) <= exchange->api->options.most_distances)
		most++;
	return most;
}

static bool read_filtered(eskel_exchange *exchange, esk_matrix *matrix)
{
	const eskel_filter filter = esk_parameters_filter(&exchange->query);
	eskel_store_error error = {0};
	bool more = false;
	eskel_store_status status = eskel_store_list(exchange->api->store, &filter, 0, most_shapes(exchange),
		&matrix->shapes, &matrix->count, &more, &error);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	return !more || check_count(exchange, (uint64_t)matrix->count + 1, "at least ");
}

static void clear(esk_matrix *matrix)
{
	eskel_shapes_free(matrix->shapes, matrix->count);
	free(matrix->distances);
	*matrix = (esk_matrix){0};
}

static bool compute(eskel_exchange *exchange, esk_matrix *matrix, eskel_status *status)
{
	const eskel_distance_options options = esk_parameters_distance(&exchange->query);
	size_t count = matrix->count;
	int64_t *keys = calloc(count + 1, sizeof *keys);
	matrix->distances = calloc(count * count + 1, sizeof *matrix->distances);
	*status = ESKEL_NO_MEMORY;
	for (size_t i = 0; keys && i < count; i++)
		keys[i] = matrix->shapes[i].key;
	if (keys && matrix->distances)
		*status = eskel_library_distances(
			exchange->api->library, keys, count, keys, count, &options, matrix->distances);
	free(keys);
	return *status == ESKEL_NOT_FOUND || esk_problem_engine(&exchange->problem, *status, NULL);
}

/* Whoever holds the lock alone knows that no change is under way. */
static void wait_for_changes(eskel_api *api)
{
	pthread_rwlock_wrlock(&api->changing);
	pthread_rwlock_unlock(&api->changing);
}

static bool make(eskel_exchange *exchange, esk_matrix *matrix)
{
	eskel_status status = ESKEL_NOT_FOUND;
	for (int attempt = 0; attempt < MOST_ATTEMPTS && status == ESKEL_NOT_FOUND; attempt++) {
		clear(matrix);
		if (attempt > 0)
			wait_for_changes(exchange->api);
		bool read =
			exchange->query.id_count > 0 ? read_named(exchange, matrix) : read_filtered(exchange, matrix);
		if (!read || !compute(exchange, matrix, &status))
			return false;
	}
	return status == ESKEL_OK ||
	       esk_problem_set(&exchange->problem, 503, "the shapes keep changing; try again later");
}

/* The format that is asked for, else CSV for a client that accepts it and does not mention JSON. */
static bool wants_csv(const eskel_exchange *exchange)
{
	const char *accept = esk_exchange_request_header(exchange, "Accept");
	if (exchange->query.format != ESK_FORMAT_UNSAID)
		return exchange->query.format == ESK_FORMAT_CSV;
	return accept && strstr(accept, "text/csv") && !strstr(accept, "application/json");
}

static bool answer(eskel_exchange *exchange, const esk_matrix *matrix)
{
	esk_text text = {0};
	bool csv = wants_csv(exchange);
	(csv ? esk_matrix_csv : esk_matrix_json)(&text, matrix);
	if (text.failed) {
		free(text.bytes);
		return esk_problem_no_memory(&exchange->problem);
	}
	return esk_exchange_answer(
		exchange, 200, csv ? "text/csv; charset=utf-8" : "application/json", text.bytes, text.size);
}

bool esk_distances_get(eskel_exchange *exchange)
{
	esk_matrix matrix = {0};
	bool good = make(exchange, &matrix) && esk_exchange_add_header(exchange, "Vary", "Accept") &&
		    answer(exchange, &matrix);
	clear(&matrix);
	return good;
}
