/* GET /healthz: the process answers. GET /readyz: it can read and write shapes. */
#include "exchange.h"
#include "resources.h"

bool esk_health_live(eskel_exchange *exchange)
{
	return esk_exchange_answer_json(exchange, 200, json_pack("{s:s}", "status", "ok"));
}

bool esk_health_ready(eskel_exchange *exchange)
{
	eskel_store_error error = {0};
	eskel_store_status status = eskel_store_ready(exchange->api->store, &error);
	if (status != ESKEL_STORE_OK)
		return esk_problem_set(&exchange->problem, 503, "the store is not ready: %s",
			error.text[0] ? error.text : eskel_store_status_text(status));
	return esk_exchange_answer_json(exchange, 200,
		json_pack("{s:s, s:I}", "status", "ready", "shapes",
			(json_int_t)eskel_library_count(exchange->api->library)));
}
