#include "client.h"

#include "store_sample.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>
#include <cmocka.h>

#define MOST_FIELDS 6000

static void demand(bool holds, const char *what)
{
	if (holds)
		return;
	fprintf(stderr, "%s failed\n", what);
	exit(2);
}

static void open_api(api_fixture *f)
{
	eskel_store_error error = {0};
	eskel_store_status status = eskel_api_open(f->path, NULL, &f->api, &error);
	if (status != ESKEL_STORE_OK)
		fprintf(stderr, "%s\n", error.text);
	demand(status == ESKEL_STORE_OK, "eskel_api_open");
}

int api_set_up(void **state)
{
	api_fixture *f = calloc(1, sizeof *f);
	demand(f != NULL, "calloc");
	f->folder = scratch_new();
	f->path = scratch_path(f->folder, "shapes.eskel");
	open_api(f);
	*state = f;
	return 0;
}

int api_tear_down(void **state)
{
	api_fixture *f = *state;
	eskel_api_close(f->api);
	scratch_free(f->folder);
	free(f->path);
	free(f);
	return 0;
}

void api_reopen(api_fixture *f)
{
	eskel_api_close(f->api);
	f->api = NULL;
	open_api(f);
}

/* ---------------------------------------------------------------------------------------------- request */

static int hex_digit(char c)
{
	return c >= '0' && c <= '9'   ? c - '0'
	       : c >= 'A' && c <= 'F' ? c - 'A' + 10
	       : c >= 'a' && c <= 'f' ? c - 'a' + 10
				      : -1;
}

static void percent_decode(char *text)
{
	char *end = text;
	for (; *text; text++)
		if (*text == '%' && hex_digit(text[1]) >= 0 && hex_digit(text[2]) >= 0) {
			*end++ = (char)(16 * hex_digit(text[1]) + hex_digit(text[2]));
			text += 2;
		} else {
			*end++ = *text == '+' ? ' ' : *text;
		}
	*end = 0;
}

/* Splits "a=1&b" in place. */
static size_t split_query(char *query, eskel_field *fields)
{
	size_t count = 0;
	while (query && *query && count < MOST_FIELDS) {
		char *next = strchr(query, '&');
		if (next)
			*next++ = 0;
		char *value = strchr(query, '=');
		if (value)
			*value++ = 0;
		else
			value = query + strlen(query);
		percent_decode(query);
		percent_decode(value);
		fields[count++] = (eskel_field){query, value};
		query = next;
	}
	return count;
}

static eskel_exchange *begin(eskel_api *api, const question *q)
{
	char *path = strdup(q->target);
	eskel_field fields[MOST_FIELDS];
	demand(path != NULL, "strdup");
	char *query = strchr(path, '?');
	if (query)
		*query++ = 0;
	percent_decode(path);
	eskel_request request = {
		.method = q->method ? q->method
			  : q->body ? "POST"
				    : "GET",
		.path = path,
		.query_count = split_query(query, fields),
		.query = fields,
		.headers = q->headers,
		.body_size = q->chunked ? -1 : (int64_t)q->size,
		.role = q->nobody ? 0
			: q->role ? q->role
				  : ESKEL_ROLE_ADMIN,
		.actor = "tester",
	};
	while (request.header_count < 4 && q->headers[request.header_count].name)
		request.header_count++;
	eskel_exchange *exchange = eskel_api_begin(api, &request);
	demand(exchange != NULL, "eskel_api_begin");
	free(path);
	return exchange;
}

static void feed(eskel_exchange *exchange, const question *q)
{
	size_t piece = q->piece ? q->piece : q->size;
	for (size_t start = 0; start < q->size; start += piece)
		eskel_exchange_feed(
			exchange, (const char *)q->body + start, q->size - start < piece ? q->size - start : piece);
}

/* ---------------------------------------------------------------------------------------------- answer */

static char *header(const eskel_response *response, const char *name)
{
	for (size_t i = 0; i < response->header_count; i++)
		if (strcasecmp(response->headers[i].name, name) == 0)
			return strdup(response->headers[i].value);
	return NULL;
}

static void record(const question *q, const answer *a)
{
	static pthread_mutex_t writing = PTHREAD_MUTEX_INITIALIZER;
	const char *path = getenv("ESKEL_ANSWERS");
	if (!path)
		return;
	json_t *line = json_pack("{s:s, s:s, s:s, s:i, s:s?, s:o}", "method",
		q->method ? q->method
		: q->body ? "POST"
			  : "GET",
		"target", q->target, "route", a->route, "status", a->status, "type", a->type, "body",
		a->json ? json_incref(a->json) : json_null());
	char *text = line ? json_dumps(line, JSON_COMPACT) : NULL;
	json_decref(line);
	if (!text) /* the target of a refusal need not be UTF-8 */
		return;
	pthread_mutex_lock(&writing);
	FILE *file = fopen(path, "a");
	demand(file && fprintf(file, "%s\n", text) > 0 && fclose(file) == 0, path);
	pthread_mutex_unlock(&writing);
	free(text);
}

static void add_bytes(answer *a, const void *bytes, size_t size)
{
	a->body = realloc(a->body, a->size + size + 1);
	demand(a->body != NULL, "realloc");
	if (size > 0)
		memcpy(a->body + a->size, bytes, size);
	a->size += size;
	a->body[a->size] = 0;
}

/* The body, as a transport sends it. */
static void read_body(eskel_exchange *exchange, answer *a)
{
	const eskel_response *response = eskel_exchange_response(exchange);
	const void *bytes = response->body;
	size_t size = response->streamed ? 0 : response->size;
	a->streamed = response->streamed;
	add_bytes(a, bytes, size);
	do {
		demand(!a->streamed || eskel_exchange_next(exchange, &bytes, &size), "eskel_exchange_next");
		if (a->streamed)
			add_bytes(a, bytes, size);
		if (a->streamed && size == 0 && !eskel_exchange_ended(exchange))
			nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
	} while (a->streamed && !eskel_exchange_ended(exchange));
	demand(response->size == a->size || (a->streamed && response->size == ESKEL_SIZE_UNKNOWN), "response->size");
}

answer ask(eskel_api *api, const question *q)
{
	eskel_exchange *exchange = begin(api, q);
	answer a = {.early = eskel_exchange_response(exchange) != NULL};
	feed(exchange, q);
	eskel_exchange_finish(exchange);
	const eskel_response *response = eskel_exchange_response(exchange);
	demand(response != NULL, "eskel_exchange_response");
	a.status = response->status;
	a.route = eskel_exchange_route(exchange);
	a.type = response->content_type ? strdup(response->content_type) : NULL;
	a.location = header(response, "Location");
	a.etag = header(response, "ETag");
	a.link = header(response, "Link");
	a.allow = header(response, "Allow");
	a.challenge = header(response, "WWW-Authenticate");
	a.part = header(response, "Content-Range");
	a.caching = header(response, "Cache-Control");
	read_body(exchange, &a);
	a.json = json_loadb(a.body, a.size, JSON_REJECT_DUPLICATES, NULL);
	record(q, &a);
	eskel_exchange_free(exchange);
	return a;
}

void answer_free(answer *a)
{
	free(a->type);
	free(a->location);
	free(a->etag);
	free(a->link);
	free(a->allow);
	free(a->challenge);
	free(a->part);
	free(a->caching);
	free(a->body);
	json_decref(a->json);
	*a = (answer){0};
}

static char *format_target(const char *format, va_list arguments)
{
	char *target = NULL;
	demand(vasprintf(&target, format, arguments) >= 0, "vasprintf");
	return target;
}

answer get(eskel_api *api, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	char *target = format_target(format, arguments);
	va_end(arguments);
	answer a = ask(api, &(question){.target = target});
	free(target);
	return a;
}

answer post_volume(eskel_api *api, const volume_file *file, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	char *target = format_target(format, arguments);
	va_end(arguments);
	answer a = ask(api, &(question){.target = target, .body = file->bytes, .size = file->size, .piece = 10007});
	free(target);
	return a;
}

json_t *at(const answer *a, const char *path)
{
	json_t *value = a->json;
	for (const char *rest = path; value && *rest;) {
		char name[64];
		size_t size = strcspn(rest, ".");
		snprintf(name, sizeof name, "%.*s", (int)size, rest);
		value = json_is_array(value) ? json_array_get(value, (size_t)atoi(name)) : json_object_get(value, name);
		rest += size + (rest[size] == '.');
	}
	if (!value) {
		fprintf(stderr, "no %s in %d %s\n", path, a->status, a->body);
		exit(2);
	}
	return value;
}

const char *text_at(const answer *a, const char *path)
{
	return json_string_value(at(a, path));
}

double number_at(const answer *a, const char *path)
{
	json_t *value = at(a, path);
	demand(json_is_number(value), path);
	return json_number_value(value);
}

void assert_answer(const char *file, int line, const answer *a, int status, const char *fragment)
{
	if (a->status == status && strstr(a->body, fragment))
		return;
	print_error("%d %s\nexpected %d with \"%s\"\n", a->status, a->body, status, fragment);
	_fail(file, line);
}

void enroll_blob(
	eskel_api *api, unsigned family, unsigned member, int mirrored, const char *query, char id[ESKEL_ID_SIZE])
{
	volume_file file = volume_of_family(family, member, mirrored);
	answer a = post_volume(api, &file, "/shapes?%s", query);
	assert_status(&a, 201);
	snprintf(id, ESKEL_ID_SIZE, "%s", text_at(&a, "shapes.0.id"));
	answer_free(&a);
	volume_free(&file);
}
