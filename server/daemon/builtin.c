#include "builtin.h"

#include "page_files.h"

#include <stdlib.h>
#include <string.h>

static const eskel_field page_headers[] = {{"Cache-Control", "no-cache"}};
static const eskel_field allow[] = {{"Allow", "GET, HEAD, OPTIONS"}};

/* ---- refusals */

static const eskel_field authenticate[] = {{"WWW-Authenticate", "Bearer"}};
static const eskel_field retry[] = {{"Retry-After", "1"}};

void esk_builtin_refuse(int status, const char *detail, esk_builtin_response *answer)
{
	char *text = eskel_problem_text(status, detail);
	answer->text = text;
	answer->response = (eskel_response){
		.status = status,
		.content_type = text ? "application/problem+json" : NULL,
		.body = text,
		.size = text ? strlen(text) : 0,
	};
	const eskel_field *header = status == 401                    ? authenticate
				    : status == 405                  ? allow
				    : status == 429 || status == 503 ? retry
								     : NULL;
	answer->response.headers = header;
	answer->response.header_count = header ? 1 : 0;
}

/* ---- metrics */

static void answer_metrics(esk_server *server, esk_builtin_response *answer)
{
	esk_queue_state queue = esk_queue_look(server->queue);
	const esk_gauge gauges[] = {
		{"eskeld_shapes", "Shapes in the library.", (double)eskel_api_shape_count(server->api)},
		{"eskeld_http_requests_in_flight", "Requests whose reply is not out.",
			(double)atomic_load(&server->in_flight)},
		{"eskeld_connections", "Open connections.", (double)esk_connections_count(server->connections)},
		{"eskeld_queue_places_taken", "Uploads and computations under way or waiting.", (double)queue.taken},
		{"eskeld_queue_waiting", "Requests that wait for a worker.", (double)queue.waiting},
		{"eskeld_queue_working", "Requests that a worker computes.", (double)queue.working},
	};
	size_t size = 0;
	char *text = esk_metrics_text(server->metrics, gauges, sizeof gauges / sizeof *gauges, &size);
	if (!text) {
		esk_builtin_refuse(503, "memory ran out", answer);
		return;
	}
	answer->text = text;
	answer->response = (eskel_response){
		.status = 200,
		.content_type = "text/plain; version=0.0.4; charset=utf-8",
		.body = text,
		.size = size,
	};
}

/* ---- all */

static const page_file *find_page(const char *path)
{
	for (size_t p = 0; p < sizeof page_files / sizeof *page_files; p++)
		if (!strcmp(page_files[p].path, path))
			return &page_files[p];
	return NULL;
}

static void answer_page(const page_file *page, esk_builtin_response *answer)
{
	answer->response = (eskel_response){
		.status = 200,
		.content_type = page->content_type,
		.header_count = 1,
		.headers = page_headers,
		.body = page->bytes,
		.size = page->size,
	};
}

bool esk_builtin_answer(
	esk_server *server, const char *method, const char *path, eskel_role role, esk_builtin_response *answer)
{
	const page_file *page = find_page(path);
	bool is_metrics = !strcmp(path, "/metrics");
	if (!page && !is_metrics)
		return false;
	*answer = (esk_builtin_response){.route = page ? page->path : "/metrics"};
	if (!strcmp(method, "OPTIONS"))
		answer->response = (eskel_response){.status = 204, .header_count = 1, .headers = allow};
	else if (strcmp(method, "GET") != 0 && strcmp(method, "HEAD") != 0)
		esk_builtin_refuse(405, "the method is none of GET, HEAD and OPTIONS", answer);
	else if (page)
		answer_page(page, answer);
	else if (role < ESKEL_ROLE_READ)
		esk_builtin_refuse(401, "the metrics need a token", answer);
	else
		answer_metrics(server, answer);
	return true;
}
