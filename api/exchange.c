/* One request and its response: what the head alone decides, the body as it comes, the answer. A refusal is a problem
 * that is turned into a response in one place (refuse). */
#include "exchange.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A merge patch of every member at its longest, escaped, is smaller. */
#define MOST_JSON_BYTES ((uint64_t)1 << 18)

/* ---------------------------------------------------------------------------------------------- the response */

const char *esk_exchange_request_header(const eskel_exchange *exchange, const char *name)
{
	for (size_t i = 0; i < exchange->header_count; i++)
		if (strcasecmp(exchange->headers[i].name, name) == 0)
			return exchange->headers[i].value;
	return NULL;
}

bool esk_exchange_answer(eskel_exchange *exchange, int status, const char *content_type, char *body, size_t size)
{
	if (!body)
		return esk_problem_no_memory(&exchange->problem);
	exchange->response_body = body;
	exchange->response.content_type = content_type;
	exchange->response.body = body;
	exchange->response.size = size;
	return esk_exchange_answer_nothing(exchange, status);
}

bool esk_exchange_answer_json(eskel_exchange *exchange, int status, json_t *body)
{
	char *text = esk_json_text(body);
	return esk_exchange_answer(exchange, status, "application/json", text, text ? strlen(text) : 0);
}

bool esk_exchange_answer_nothing(eskel_exchange *exchange, int status)
{
	exchange->response.status = status;
	exchange->response.headers = exchange->response_headers;
	return exchange->settled = true;
}

bool esk_exchange_add_header(eskel_exchange *exchange, const char *name, const char *format, ...)
{
	size_t *count = &exchange->response.header_count;
	char *value = NULL;
	va_list arguments;
	va_start(arguments, format);
	int size = *count < ESK_RESPONSE_HEADERS ? vasprintf(&value, format, arguments) : -1;
	va_end(arguments);
	if (size < 0)
		return esk_problem_no_memory(&exchange->problem);
	exchange->response_headers[(*count)++] = (eskel_field){name, value};
	return true;
}

/* Makes the problem the response. Without memory for its text the status alone has to do. */
static void refuse(eskel_exchange *exchange)
{
	const esk_problem *problem = &exchange->problem;
	if (problem->status == 503)
		esk_exchange_add_header(exchange, "Retry-After", "1");
	char *text = eskel_problem_text(problem->status, problem->text);
	if (!text || !esk_exchange_answer(exchange, problem->status, "application/problem+json", text, strlen(text)))
		esk_exchange_answer_nothing(exchange, problem->status);
}

/* ---------------------------------------------------------------------------------------------- the head */

static bool copy_fields(const eskel_field *fields, size_t count, eskel_field **copies, size_t *copied)
{
	*copies = calloc(count + 1, sizeof **copies);
	if (!*copies)
		return false;
	for (*copied = 0; *copied < count;) {
		const eskel_field *field = &fields[*copied];
		eskel_field *copy = &(*copies)[(*copied)++];
		*copy = (eskel_field){strdup(field->name), strdup(field->value)};
		if (!copy->name || !copy->value)
			return false;
	}
	return true;
}

static void free_fields(eskel_field *fields, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		free((void *)fields[i].name);
		free((void *)fields[i].value);
	}
	free(fields);
}

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

static bool check_size(eskel_exchange *exchange, const char *at_least, uint64_t size)
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
	eskel_volume_options limits = {.most_voxels = options->most_voxels, .most_labels = options->most_labels};
	if (exchange->route->body != ESK_BODY_VOLUME)
		return true;
	return esk_problem_engine(&exchange->problem, eskel_volume_new(&limits, &exchange->volume), NULL);
}

/* Everything that the head alone can decide. */
static bool admit(eskel_exchange *exchange, const eskel_request *request)
{
	const char *segment = NULL;
	if (!find_route(exchange, request, &segment) || exchange->settled)
		return exchange->settled;
	return check_role(exchange) && check_content_type(exchange) && take_id(exchange, segment) &&
	       esk_parameters_parse(&exchange->query, exchange->route->query, exchange->query_fields,
		       exchange->query_count, &exchange->problem) &&
	       (!exchange->route->check || exchange->route->check(exchange)) &&
	       check_size(exchange, "", request->body_size > 0 ? (uint64_t)request->body_size : 0) &&
	       open_body(exchange);
}

eskel_exchange *eskel_api_begin(eskel_api *api, const eskel_request *request)
{
	eskel_exchange *exchange = calloc(1, sizeof *exchange);
	if (!exchange)
		return NULL;
	exchange->api = api;
	exchange->role = request->role;
	exchange->actor = request->actor ? strdup(request->actor) : NULL;
	if ((request->actor && !exchange->actor) ||
		!copy_fields(request->query, request->query_count, &exchange->query_fields, &exchange->query_count) ||
		!copy_fields(request->headers, request->header_count, &exchange->headers, &exchange->header_count)) {
		eskel_exchange_free(exchange);
		return NULL;
	}
	if (!admit(exchange, request))
		refuse(exchange);
	return exchange;
}

void eskel_exchange_free(eskel_exchange *exchange)
{
	if (!exchange)
		return;
	esk_parameters_clear(&exchange->query);
	free_fields(exchange->query_fields, exchange->query_count);
	free_fields(exchange->headers, exchange->header_count);
	for (size_t i = 0; i < exchange->response.header_count; i++)
		free((void *)exchange->response_headers[i].value);
	eskel_volume_free(exchange->volume);
	free(exchange->json.bytes);
	free(exchange->response_body);
	free(exchange->actor);
	free(exchange->id);
	free(exchange);
}

/* ---------------------------------------------------------------------------------------------- body and finish */

static bool take_bytes(eskel_exchange *exchange, const void *bytes, size_t size)
{
	eskel_error error = {0};
	exchange->body_size += size;
	if (exchange->route->body == ESK_BODY_NONE)
		return true;
	if (!check_size(exchange, "at least ", exchange->body_size))
		return false;
	if (exchange->route->body == ESK_BODY_VOLUME) {
		eskel_status status = eskel_volume_feed(exchange->volume, bytes, size, &error);
		return esk_problem_engine(&exchange->problem, status, &error);
	}
	esk_text_append(&exchange->json, bytes, size);
	return !exchange->json.failed || esk_problem_no_memory(&exchange->problem);
}

void eskel_exchange_feed(eskel_exchange *exchange, const void *bytes, size_t size)
{
	if (!exchange->settled && !take_bytes(exchange, bytes, size))
		refuse(exchange);
}

bool eskel_exchange_is_heavy(const eskel_exchange *exchange)
{
	return !exchange->settled && exchange->route->heavy;
}

void eskel_exchange_finish(eskel_exchange *exchange)
{
	if (!exchange->settled && !exchange->route->handle(exchange))
		refuse(exchange);
}

const eskel_response *eskel_exchange_response(const eskel_exchange *exchange)
{
	return exchange->settled ? &exchange->response : NULL;
}

const char *eskel_exchange_route(const eskel_exchange *exchange)
{
	return exchange->route ? exchange->route->path : "";
}
