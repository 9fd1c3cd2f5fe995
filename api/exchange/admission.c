/* What the head of a request alone decides, in this order: the route, the method, the role, the body's type, the id, the
 * query, the body's size. */
#include "exchange.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* A merge patch of every member at its longest, escaped, is smaller. */
#define MOST_JSON_BYTES ((uint64_t)1 << 18)

/* Finds the route; OPTIONS and wrong methods are dealt with here. */
static bool find_route(eskel_exchange *exchange, const eskel_request *request, const char **segment)
{
	const char *method = strcmp(request->method, "HEAD") == 0 ? "GET" : request->method;
	char allow[ESK_ALLOW_SIZE];
	exchange->route = esk_route_of_path(request->path, segment);
	if (!exchange->route)
		return esk_problem_set(
			&exchange->problem, 404, "there is nothing at \"%.200s\", see /openapi.json", request->path);
	const esk_route *route = esk_route_of_method(exchange->route, method);
	if (route) {
		exchange->route = route;
		return true;
	}
	esk_route_allow(exchange->route, allow);
	if (!esk_exchange_add_header(exchange, "Allow", "%s", allow))
		return false;
	if (strcmp(method, "OPTIONS") == 0)
		return esk_exchange_answer_nothing(exchange, 204);
	return esk_problem_set(&exchange->problem, 405, "%.30s is not allowed on %s, expected %s", method,
		exchange->route->path, allow);
}

static bool check_role(eskel_exchange *exchange)
{
	static const char *const roles[] = {"", "read", "write", "admin"};
	eskel_role needed = exchange->route->role;
	if (exchange->role >= needed)
		return true;
	if (exchange->role != 0)
		return esk_problem_set(&exchange->problem, 403, "the token has the role %s, %s %s needs %s",
			roles[exchange->role], exchange->route->method, exchange->route->path, roles[needed]);
	return esk_exchange_add_header(exchange, "WWW-Authenticate", "Bearer") &&
	       esk_problem_set(&exchange->problem, 401,
		       "%s %s needs a token of the role %s: Authorization: Bearer TOKEN", exchange->route->method,
		       exchange->route->path, roles[needed]);
}

static bool content_type_is(const char *type, const char *wanted)
{
	size_t size = strlen(wanted);
	return strncasecmp(type, wanted, size) == 0 && (type[size] == 0 || strchr("; \t", type[size]));
}

/* A browser sends the three form types (and bodies without a type) to other sites without asking them first, and says
 * in Sec-Fetch-Site that it does. curl --data-binary sends one of them too, without that header. A multipart body is
 * never the file itself. */
static bool check_content_type(eskel_exchange *exchange)
{
	const char *type = esk_exchange_request_header(exchange, "Content-Type");
	const char *site = esk_exchange_request_header(exchange, "Sec-Fetch-Site");
	bool foreign = site && strcmp(site, "same-origin") != 0 && strcmp(site, "none") != 0;
	if (exchange->route->body == ESK_BODY_NONE)
		return true;
	if (type && content_type_is(type, "multipart/form-data"))
		return esk_problem_set(&exchange->problem, 415,
			"the body is multipart/form-data, expected the file itself: curl --data-binary @FILE or curl "
			"-X POST "
			"-T FILE");
	if (foreign && (!type || content_type_is(type, "application/x-www-form-urlencoded") ||
			       content_type_is(type, "text/plain")))
		return esk_problem_set(&exchange->problem, 415,
			"Content-Type is \"%.60s\" in a request from another site, expected one that is not a form's: "
			"application/octet-stream or application/json",
			type ? type : "");
	if (exchange->route->body == ESK_BODY_VOLUME || !type ||
		content_type_is(type, "application/merge-patch+json") || content_type_is(type, "application/json") ||
		content_type_is(type, "application/x-www-form-urlencoded"))
		return true;
	return esk_exchange_add_header(exchange, "Accept-Patch", "application/merge-patch+json, application/json") &&
	       esk_problem_set(&exchange->problem, 415,
		       "Content-Type is \"%.60s\", expected application/merge-patch+json or application/json", type);
}

static bool take_id(eskel_exchange *exchange, const char *segment)
{
	char id[ESKEL_ID_SIZE];
	if (!segment)
		return true;
	size_t size = strcspn(segment, "/");
	snprintf(id, sizeof id, "%.*s", size < sizeof id ? (int)size : 0, segment);
	if (!esk_value_is_id(id))
		return esk_problem_set(&exchange->problem, 404,
			"\"%.*s\" is no id, expected 32 lower-case hexadecimal digits", (int)(size < 80 ? size : 80),
			segment);
	exchange->id = strdup(id);
	return exchange->id || esk_problem_no_memory(&exchange->problem);
}

static uint64_t most_body_bytes(const eskel_exchange *exchange)
{
	uint64_t most = exchange->api->options.most_body_bytes;
	return exchange->route->body == ESK_BODY_JSON && MOST_JSON_BYTES < most ? MOST_JSON_BYTES : most;
}

bool esk_exchange_check_size(eskel_exchange *exchange, const char *at_least, uint64_t size)
{
	uint64_t most = most_body_bytes(exchange);
	if (size <= most)
		return true;
	return esk_problem_set(&exchange->problem, 413, "the body has %s%" PRIu64 " bytes, expected at most %" PRIu64,
		at_least, size, most);
}

static bool open_body(eskel_exchange *exchange)
{
	const eskel_api_options *options = &exchange->api->options;
	eskel_volume_options limits = {.most_voxels = options->most_voxels,
		.most_runs = options->most_runs,
		.most_labels = options->most_labels,
		.weights = exchange->query.weights,
		.spacing = exchange->query.spacing};
	if (exchange->route->body != ESK_BODY_VOLUME)
		return true;
	return esk_problem_engine(&exchange->problem, eskel_intake_new(&limits, NULL, &exchange->intake), NULL);
}

bool esk_exchange_admit(eskel_exchange *exchange, const eskel_request *request)
{
	const char *segment = NULL;
	if (!find_route(exchange, request, &segment) || exchange->settled)
		return exchange->settled;
	return check_role(exchange) && check_content_type(exchange) && take_id(exchange, segment) &&
	       esk_parameters_parse(&exchange->query, exchange->route->query, exchange->query_fields,
		       exchange->query_count, &exchange->problem) &&
	       (!exchange->route->check || exchange->route->check(exchange)) &&
	       esk_exchange_check_size(exchange, "", request->body_size > 0 ? (uint64_t)request->body_size : 0) &&
	       open_body(exchange);
}
