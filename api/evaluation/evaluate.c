/* GET /evaluation: how well a distance does on the shapes that a filter leaves. */
#include "evaluation.h"
#include "exchange.h"
#include "resources.h"

#include <inttypes.h>

/* Each shape is compared with each: as many as there may be in a matrix. */
static size_t most_shapes(const eskel_exchange *exchange)
{
	size_t most = 1;
	while ((uint64_t)(most + 1) * (most + 1) <= exchange->api->options.most_distances)
		most++;
	return most;
}

static bool read_shapes(eskel_exchange *exchange, esk_evaluation *evaluation)
{
	const eskel_filter filter = esk_parameters_filter(&exchange->query);
	const size_t most = most_shapes(exchange);
	eskel_store_error error = {0};
	bool more = false;
	eskel_store_status status = eskel_store_list(
		exchange->api->store, &filter, 0, most, &evaluation->shapes, &evaluation->count, &more, &error);
	if (!esk_problem_store(&exchange->problem, status, &error))
		return false;
	return !more ||
	       esk_problem_set(&exchange->problem, 413,
		       "there are more than %zu shapes to be compared with each other, expected at most %" PRIu64
		       " distances: a filter leaves fewer",
		       most, exchange->api->options.most_distances);
}

static bool make(eskel_exchange *exchange, esk_evaluation *evaluation)
{
	eskel_status status = ESKEL_NOT_FOUND;
	for (int attempt = 0; attempt < ESK_MOST_ATTEMPTS && status == ESKEL_NOT_FOUND; attempt++) {
		esk_evaluation_clear(evaluation);
		if (attempt > 0)
			esk_api_wait_for_changes(exchange->api);
		if (!read_shapes(exchange, evaluation) ||
			!esk_evaluation_make(exchange->api, &exchange->query, evaluation, &status, &exchange->problem))
			return false;
	}
	return status == ESKEL_OK ||
	       esk_problem_set(&exchange->problem, 503, "the shapes keep changing; try again later");
}

bool esk_evaluation_get(eskel_exchange *exchange)
{
	esk_evaluation evaluation = {0};
	bool good = make(exchange, &evaluation) &&
		    esk_exchange_answer_json(exchange, 200, esk_evaluation_json(&evaluation, &exchange->query));
	esk_evaluation_clear(&evaluation);
	return good;
}
