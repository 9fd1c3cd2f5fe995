#include "request.h"

#include "clock.h"
#include "guard.h"
#include "log.h"
#include "builtin.h"
#include "send.h"
#include "target.h"

#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>

static const uint64_t swallow_bytes = (uint64_t)8 << 20;
static const int64_t swallow_ms = 5000;
static const double failed_token_cost = 100; /* guessing is a hundredth as fast as asking */

enum { MOST_HEADERS = 128 };

typedef enum { HEAD, BODY, WORKING, WORKED, SENT, MAKING } stage;

struct esk_request {
	esk_job job; /* first: a job is its request */
	esk_server *server;
	struct MHD_Connection *connection;
	esk_connection *peer;
	_Atomic stage stage;
	char *raw_target;
	esk_target target;
	char method[8]; /* "other" for what does not fit */
	esk_caller caller;
	eskel_exchange *exchange; /* NULL before the API has it, and when it never gets it */
	esk_builtin_response own; /* status 0 while there is none */
	bool has_body, has_place, in_flight, close;
	uint64_t received;
	uint64_t swallowed;
	int64_t body_started, refused_at;
	double started;
	struct {
		const char *bytes; /* the piece that was made last, of which so many are sent */
		size_t size, sent;
		bool ended, broken;
		uint64_t total; /* sent of all pieces */
	} stream;
};

esk_request *esk_request_new(
	esk_server *server, struct MHD_Connection *connection, esk_connection *peer, const char *target)
{
	esk_request *request = calloc(1, sizeof *request);
	if (!request)
		return NULL;
	request->raw_target = strdup(target);
	if (!request->raw_target) {
		free(request);
		return NULL;
	}
	request->server = server;
	request->connection = connection;
	request->peer = peer;
	request->own.route = "";
	return request;
}

/* ---- the response */

static const eskel_response *settled(const esk_request *request)
{
	if (request->own.response.status)
		return &request->own.response;
	return request->exchange ? eskel_exchange_response(request->exchange) : NULL;
}

static void refuse(esk_request *request, int status, const char *detail)
{
	esk_builtin_refuse(status, detail, &request->own);
}

static void make_piece(esk_request *request)
{
	const void *bytes = NULL;
	size_t size = 0;
	request->stream.broken = !eskel_exchange_next(request->exchange, &bytes, &size);
	request->stream.ended = eskel_exchange_ended(request->exchange);
	request->stream.bytes = bytes;
	request->stream.size = size;
	request->stream.sent = 0;
	esk_connection_in_reply(request->peer, size);
}

/* What there is to say on a live stream, perhaps nothing. */
static void make_news(esk_request *request)
{
	if (atomic_load(&request->server->draining))
		request->stream.ended = true;
	if (request->stream.sent == request->stream.size && !request->stream.ended)
		make_piece(request);
}

/* Lets the connection rest until a worker has made the next piece, or until it is time to look for news. */
static void wait_for_piece(esk_request *request, bool live)
{
	if (!live)
		atomic_store(&request->stage, MAKING);
	esk_connection_in_work(request->peer);
	MHD_suspend_connection(request->connection); /* before anybody can resume it */
	if (live)
		esk_connection_wait(request->peer);
	else
		esk_queue_submit(request->server->queue, &request->job);
}

/* The next bytes of a streamed body, as libmicrohttpd asks for them; 0 while there are none. */
static ssize_t read_stream(void *context, uint64_t position, char *buffer, size_t size)
{
	esk_request *request = context;
	const bool live = settled(request)->live;
	(void)position;
	atomic_store(&request->peer->resumed, 0);
	if (atomic_load(&request->stage) != SENT)
		return 0;
	if (live)
		make_news(request);
	const size_t left = request->stream.size - request->stream.sent, taken = left < size ? left : size;
	if (taken > 0) {
		memcpy(buffer, request->stream.bytes + request->stream.sent, taken);
		request->stream.sent += taken;
		request->stream.total += taken;
		return (ssize_t)taken;
	}
	if (request->stream.broken || request->stream.ended)
		return request->stream.broken ? MHD_CONTENT_READER_END_WITH_ERROR : MHD_CONTENT_READER_END_OF_STREAM;
	wait_for_piece(request, live);
	return 0;
}

static enum MHD_Result send_response(esk_request *request)
{
	if (!settled(request))
		refuse(request, 500, "the request was left without an answer");
	const eskel_response *response = settled(request);
	atomic_store(&request->stage, SENT);
	esk_connection_in_reply(request->peer, response->streamed ? 0 : response->size);
	return esk_send(request->connection, response, request->close || atomic_load(&request->server->draining),
		read_stream, request);
}

/* ---- head */

static enum MHD_Result collect_header(void *context, enum MHD_ValueKind kind, const char *name, const char *value)
{
	(void)kind;
	eskel_request *head = context;
	if (head->header_count == MOST_HEADERS)
		return MHD_NO;
	eskel_field *fields = (eskel_field *)head->headers;
	fields[head->header_count++] = (eskel_field){name, value ? value : ""};
	return MHD_YES;
}

static esk_refusal check_target(esk_request *request, eskel_request *head)
{
	const char *wrong = esk_target_parse(request->raw_target, &request->target);
	if (wrong)
		return (esk_refusal){400, ESK_REJECT_TARGET, wrong, true};
	head->path = request->target.path;
	head->query = request->target.query;
	head->query_count = request->target.query_count;
	return (esk_refusal){0};
}

/* What the rate of a caller is counted under: the token, or the address (of IPv6 the network, /64). */
static uint64_t rate_key(const esk_request *request)
{
	if (request->caller.token)
		return (uint64_t)request->caller.token;
	const union MHD_ConnectionInfo *info =
		MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
	uint64_t key = 0;
	if (info && info->client_addr->sa_family == AF_INET)
		memcpy(&key, &((const struct sockaddr_in *)(const void *)info->client_addr)->sin_addr, 4);
	else if (info && info->client_addr->sa_family == AF_INET6)
		memcpy(&key, &((const struct sockaddr_in6 *)(const void *)info->client_addr)->sin6_addr, 8);
	return key | (uint64_t)1 << 63; /* apart from the tokens */
}

static esk_refusal check_caller(esk_request *request, eskel_request *head)
{
	const char *authorization = esk_guard_header(head, "Authorization");
	int wrong = esk_auth_check(&request->server->auth, authorization, &request->caller);
	if (!esk_rate_take(
		    request->server->rate, rate_key(request), wrong == 401 ? failed_token_cost : 1, esk_clock_now()))
		return (esk_refusal){429, ESK_REJECT_RATE, "there are too many requests; try again in a second", false};
	if (wrong)
		return (esk_refusal){wrong, ESK_REJECT_TOKEN,
			wrong == 401 ? "the token is unknown, expired or revoked" : "the tokens cannot be read now",
			false};
	head->role = request->caller.role;
	head->actor = *request->caller.actor ? request->caller.actor : NULL;
	return (esk_refusal){0};
}

/* The first thing that is wrong with the head, in the order of what is cheapest and least trusting. */
static esk_refusal check(esk_request *request, eskel_request *head, const char *version)
{
	esk_server *server = request->server;
	if (atomic_load(&server->draining)) /* read after in_flight was raised: drain sees this request, or it this */
		return (esk_refusal){503, ESK_REJECT_STOPPING, "the server is stopping", true};
	if (head->header_count == MOST_HEADERS)
		return (esk_refusal){431, ESK_REJECT_FRAMING, "there are 128 header fields or more", true};
	esk_refusal refusal = esk_guard_framing(head, version);
	if (!refusal.status)
		refusal = check_target(request, head);
	if (!refusal.status)
		refusal = esk_guard_host(head, server->hosts, server->host_count);
	if (!refusal.status)
		refusal = esk_guard_site(head, server->hosts, server->host_count);
	if (!refusal.status)
		refusal = check_caller(request, head);
	return refusal;
}

static void leave_place(esk_request *request)
{
	if (request->has_place)
		esk_queue_leave_place(request->server->queue);
	request->has_place = false;
}

/* Hands the head to the API, and takes a place in the queue when the exchange will need one. */
static void begin_exchange(esk_request *request, const eskel_request *head)
{
	request->exchange = eskel_api_begin(request->server->api, head);
	if (!request->exchange) {
		refuse(request, 503, "memory ran out");
		return;
	}
	if (settled(request) || !eskel_exchange_is_heavy(request->exchange))
		return;
	request->has_place = esk_queue_take_place(request->server->queue);
	if (!request->has_place) {
		esk_metrics_reject(request->server->metrics, ESK_REJECT_QUEUE);
		refuse(request, 503, "the queue is full; try again in a second");
	}
}

static int64_t body_size(const eskel_request *head)
{
	const char *length = esk_guard_header(head, "Content-Length");
	if (length) /* libmicrohttpd has refused what is no number or too large for one */
		return strtoull(length, NULL, 10) > INT64_MAX ? INT64_MAX : (int64_t)strtoull(length, NULL, 10);
	return esk_guard_header(head, "Transfer-Encoding") ? -1 : 0;
}

static enum MHD_Result receive_head(esk_request *request, const char *method, const char *version)
{
	eskel_field fields[MOST_HEADERS];
	eskel_request head = {.method = method, .headers = fields};
	request->started = esk_clock_exact();
	request->in_flight = true;
	atomic_fetch_add(&request->server->in_flight, 1);
	strcpy(request->method, strlen(method) < sizeof request->method ? method : "other");
	MHD_get_connection_values(request->connection, MHD_HEADER_KIND, collect_header, &head);
	head.body_size = body_size(&head);
	request->has_body = head.body_size != 0;

	esk_refusal refusal = check(request, &head, version);
	if (refusal.status) {
		esk_metrics_reject(request->server->metrics, refusal.reason);
		refuse(request, refusal.status, refusal.detail);
		request->close = refusal.close;
	} else if (!esk_builtin_answer(request->server, method, head.path, head.role, &request->own)) {
		begin_exchange(request, &head);
	}

	atomic_store(&request->stage, BODY);
	request->body_started = esk_clock_now();
	if (request->has_body)
		esk_connection_in_body(request->peer, request->body_started, 0);
	bool waits = esk_guard_header(&head, "Expect");
	if (settled(request) && request->has_body &&
		(request->close || waits || head.body_size > (int64_t)swallow_bytes))
		return send_response(request);
	return MHD_YES;
}

/* ---- body */

/* MHD_NO cuts the client off. */
static enum MHD_Result swallow(esk_request *request, size_t size)
{
	int64_t now = esk_clock_now();
	leave_place(request);
	if (!request->refused_at)
		request->refused_at = now;
	request->swallowed += size;
	return request->swallowed > swallow_bytes && now - request->refused_at > swallow_ms ? MHD_NO : MHD_YES;
}

static enum MHD_Result receive_body(esk_request *request, const char *bytes, size_t *size)
{
	size_t taken = *size;
	*size = 0;
	request->received += taken;
	esk_connection_in_body(request->peer, request->body_started, request->received);
	if (settled(request))
		return swallow(request, taken);
	eskel_exchange_feed(request->exchange, bytes, taken);
	return MHD_YES;
}

static enum MHD_Result end_body(esk_request *request)
{
	if (settled(request))
		return send_response(request);
	if (!request->has_place) {
		eskel_exchange_finish(request->exchange);
		return send_response(request);
	}
	atomic_store(&request->stage, WORKING);
	esk_connection_in_work(request->peer);
	MHD_suspend_connection(request->connection); /* before a worker can resume it */
	esk_queue_submit(request->server->queue, &request->job);
	return MHD_YES;
}

void esk_request_work(esk_job *job)
{
	esk_request *request = (esk_request *)job;
	struct MHD_Connection *connection = request->connection;
	const bool makes = atomic_load(&request->stage) == MAKING;
	if (makes)
		make_piece(request);
	else
		eskel_exchange_finish(request->exchange);
	if (!settled(request)->streamed)
		leave_place(request);
	atomic_store(&request->peer->resumed, esk_clock_now());
	atomic_store(&request->stage, makes ? SENT : WORKED);
	MHD_resume_connection(connection); /* the request may be gone when this returns */
}

enum MHD_Result esk_request_receive(
	esk_request *request, const char *method, const char *version, const char *bytes, size_t *size)
{
	switch (atomic_load(&request->stage)) {
	case HEAD:
		return receive_head(request, method, version);
	case BODY:
		return *size ? receive_body(request, bytes, size) : end_body(request);
	case WORKED:
		atomic_store(&request->peer->resumed, 0);
		return send_response(request);
	case WORKING:
	case SENT:
	case MAKING:
		break;
	}
	return MHD_YES;
}

/* ---- end */

static const char *route(const esk_request *request)
{
	return request->exchange ? eskel_exchange_route(request->exchange) : request->own.route;
}

/* The id in /shapes/{id}..., of the request or of the Location that answers it; "" when there is none. */
static void shape_id(const esk_request *request, const eskel_response *response, char id[ESKEL_ID_SIZE])
{
	static const char prefix[] = "/shapes/";
	const char *path = request->target.path;
	for (size_t h = 0; response && h < response->header_count; h++)
		if (!strcmp(response->headers[h].name, "Location"))
			path = response->headers[h].value;
	id[0] = '\0';
	if (!path || strncmp(path, prefix, sizeof prefix - 1) != 0)
		return;
	path += sizeof prefix - 1;
	if (strspn(path, "0123456789abcdef") != ESKEL_ID_SIZE - 1)
		return;
	memcpy(id, path, ESKEL_ID_SIZE - 1);
	id[ESKEL_ID_SIZE - 1] = '\0';
}

static void write_log(
	const esk_request *request, const eskel_response *response, uint64_t sent, double ms, const char *end)
{
	char id[ESKEL_ID_SIZE];
	esk_log_line line;
	shape_id(request, response, id);
	esk_log_begin(&line, "request");
	esk_log_text(&line, "method", request->method);
	esk_log_text(&line, "route", route(request));
	if (response)
		esk_log_number(&line, "status", (uint64_t)response->status);
	esk_log_number(&line, "received", request->received);
	esk_log_number(&line, "bytes", sent);
	esk_log_milliseconds(&line, "ms", ms);
	if (request->caller.token)
		esk_log_number(&line, "token", (uint64_t)request->caller.token);
	esk_log_text(&line, "shape", id);
	esk_log_text(&line, "end", end);
	esk_log_end(&line);
}

static void report(const esk_request *request, enum MHD_RequestTerminationCode how)
{
	static const char *const ends[] = {
		[MHD_REQUEST_TERMINATED_COMPLETED_OK] = "",
		[MHD_REQUEST_TERMINATED_WITH_ERROR] = "error",
		[MHD_REQUEST_TERMINATED_TIMEOUT_REACHED] = "timeout",
		[MHD_REQUEST_TERMINATED_DAEMON_SHUTDOWN] = "shutdown",
		[MHD_REQUEST_TERMINATED_READ_ERROR] = "lost",
		[MHD_REQUEST_TERMINATED_CLIENT_ABORT] = "lost",
	};
	double ms = esk_clock_exact() - request->started;
	const eskel_response *response = request->stage == SENT ? settled(request) : NULL;
	uint64_t sent = response && strcmp(request->method, "HEAD") != 0 ? response->size : 0;
	if (response && response->streamed)
		sent = request->stream.total;
	if (response)
		esk_metrics_request(request->server->metrics, route(request), request->method, response->status,
			ms / 1000, request->received, sent);
	write_log(request, response, sent, ms, ends[how]);
}

void esk_request_end(esk_request *request, enum MHD_RequestTerminationCode how)
{
	if (request->in_flight)
		report(request, how);
	esk_connection_idle(request->peer);
	leave_place(request);
	eskel_exchange_free(request->exchange);
	free(request->own.text);
	esk_target_clear(&request->target);
	free(request->raw_target);
	if (request->in_flight)
		atomic_fetch_sub(&request->server->in_flight, 1);
	free(request);
}
