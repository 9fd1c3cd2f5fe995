/* One request and its response: what is kept of the request, the body as it comes, the answer. A refusal is a problem
 * that is turned into a response in one place (refuse). */
#include "exchange.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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

bool esk_exchange_answer_stream(
	eskel_exchange *exchange, int status, const char *content_type, size_t size, const esk_stream *stream)
{
	exchange->stream = *stream;
	exchange->response.content_type = content_type;
	exchange->response.size = size;
	exchange->response.streamed = true;
	exchange->response.live = stream->ended != NULL;
	return esk_exchange_answer_nothing(exchange, status);
}

bool eskel_exchange_next(eskel_exchange *exchange, const void **bytes, size_t *size)
{
	exchange->piece.size = 0;
	if (!exchange->stream.next(exchange->stream.source, &exchange->piece) || exchange->piece.failed)
		return false;
	*bytes = exchange->piece.bytes;
	*size = exchange->piece.size;
	return true;
}

bool eskel_exchange_ended(const eskel_exchange *exchange)
{
	const esk_stream *stream = &exchange->stream;
	return exchange->piece.size == 0 && (!stream->ended || stream->ended(stream->source));
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

/* ---------------------------------------------------------------------------------------------- the request */

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
	if (!esk_exchange_admit(exchange, request))
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
	eskel_intake_free(exchange->intake);
	free(exchange->json.bytes);
	free(exchange->response_body);
	if (exchange->stream.free)
		exchange->stream.free(exchange->stream.source);
	free(exchange->piece.bytes);
	free(exchange->actor);
	free(exchange->id);
	free(exchange);
}

static bool take_bytes(eskel_exchange *exchange, const void *bytes, size_t size)
{
	eskel_error error = {0};
	exchange->body_size += size;
	if (exchange->route->body == ESK_BODY_NONE)
		return true;
	if (!esk_exchange_check_size(exchange, "at least ", exchange->body_size))
		return false;
	if (exchange->route->body == ESK_BODY_VOLUME) {
		eskel_status status = eskel_intake_feed(exchange->intake, bytes, size, &error);
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
