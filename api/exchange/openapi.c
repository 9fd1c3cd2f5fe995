/* GET /openapi.json: openapi.yaml, made JSON and embedded at build time. */
#include "exchange.h"
#include "openapi_json.h"
#include "resources.h"

#include <string.h>

bool esk_openapi_get(eskel_exchange *exchange)
{
	return esk_exchange_answer(
		exchange, 200, "application/json", strdup((const char *)openapi_json), sizeof openapi_json - 1);
}
