#include "http.h"

#include "log.h"
#include "request.h"

#include <stdio.h>
#include <string.h>
#include <sys/socket.h>

static esk_connection *peer_of(struct MHD_Connection *connection)
{
	return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;
}

static void on_connection(
	void *context, struct MHD_Connection *connection, void **peer, enum MHD_ConnectionNotificationCode code)
{
	esk_server *server = context;
	if (code == MHD_CONNECTION_NOTIFY_CLOSED) {
		if (*peer)
			esk_connections_remove(server->connections, *peer);
		return;
	}
	int fd = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
	*peer = esk_connections_add(server->connections, connection, fd);
}

/* The earliest callback of a request and the only one that sees its target as sent. What it returns becomes the
 * request's context. The query is then cut off: libmicrohttpd would parse it into the connection's memory, and when that
 * does not suffice 0.9.75 queues an error that it never sends. */
static void *on_target(void *context, const char *target, struct MHD_Connection *connection)
{
	esk_connection *peer = peer_of(connection);
	esk_request *request = peer ? esk_request_new(context, connection, peer, target) : NULL;
	char *query = strchr(target, '?'); /* in the connection's read buffer */
	if (query)
		query[1] = '\0';
	return request;
}

static enum MHD_Result on_request(void *context, struct MHD_Connection *connection, const char *url, const char *method,
	const char *version, const char *bytes, size_t *size, void **request)
{
	(void)context;
	(void)connection;
	(void)url;
	return *request ? esk_request_receive(*request, method, version, bytes, size) : MHD_NO;
}

static void on_completed(
	void *context, struct MHD_Connection *connection, void **request, enum MHD_RequestTerminationCode how)
{
	(void)context;
	(void)connection;
	if (*request)
		esk_request_end(*request, how);
	*request = NULL;
}

/* Its messages matter while it starts. Later they tell of clients' errors and may quote them. */
static void on_message(void *context, const char *format, va_list arguments)
{
	const esk_server *server = context;
	char text[256];
	if (atomic_load(&server->listening))
		return;
	vsnprintf(text, sizeof text, format, arguments);
	esk_log_message("libmicrohttpd", "%s", text);
}

struct MHD_Daemon *esk_http_start(esk_server *server, const esk_options *options, const esk_tls *tls, int listening)
{
	unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME | MHD_USE_ERROR_LOG;
	const struct MHD_OptionItem secure[] = {
		{MHD_OPTION_HTTPS_MEM_CERT, 0, tls->certificate},
		{MHD_OPTION_HTTPS_MEM_KEY, 0, tls->key},
		{MHD_OPTION_END, 0, NULL},
	};
	const struct MHD_OptionItem plain[] = {{MHD_OPTION_END, 0, NULL}};
	struct MHD_Daemon *daemon = MHD_start_daemon(tls->key ? flags | MHD_USE_TLS : flags, 0, NULL, NULL, on_request,
		server, MHD_OPTION_EXTERNAL_LOGGER, on_message, server, /* first, to hear of the others */
		MHD_OPTION_LISTEN_SOCKET, listening, MHD_OPTION_THREAD_POOL_SIZE, (unsigned)options->threads,
		MHD_OPTION_CONNECTION_LIMIT, (unsigned)options->connections, MHD_OPTION_CONNECTION_TIMEOUT, 15u,
		MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)128 << 10, MHD_OPTION_STRICT_FOR_CLIENT, 1,
		MHD_OPTION_NOTIFY_CONNECTION, on_connection, server, MHD_OPTION_NOTIFY_COMPLETED, on_completed, server,
		MHD_OPTION_URI_LOG_CALLBACK, on_target, server, MHD_OPTION_ARRAY, tls->key ? secure : plain,
		MHD_OPTION_END);
	atomic_store(&server->listening, true);
	return daemon;
}
