#include "serve.h"

#include "clock.h"
#include "http.h"
#include "listen.h"
#include "log.h"
#include "request.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- signals */

/* SIGTERM and SIGINT are blocked in all threads and waited for by the main one. */
static sigset_t stop_signals(void)
{
	sigset_t set;
	sigemptyset(&set);
	sigaddset(&set, SIGTERM);
	sigaddset(&set, SIGINT);
	return set;
}

static void prepare_process(void)
{
	sigset_t set = stop_signals();
	pthread_sigmask(SIG_BLOCK, &set, NULL);
	signal(SIGPIPE, SIG_IGN);
	umask(077);
}

static bool stop_is_pending(void)
{
	sigset_t pending;
	sigpending(&pending);
	return sigismember(&pending, SIGTERM) == 1 || sigismember(&pending, SIGINT) == 1;
}

/* ---- set up */

/* Every connection is a file, and the database, its readers and the log need some too. */
static bool raise_file_limit(uint64_t connections)
{
	const rlim_t needed = connections + 256;
	struct rlimit limit;
	if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < needed) {
		limit.rlim_cur = limit.rlim_max < needed ? limit.rlim_max : needed;
		setrlimit(RLIMIT_NOFILE, &limit);
	}
	if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur >= needed)
		return true;
	esk_log_message("files", "%llu connections need %llu open files, the limit is %llu; lower --connections",
		(unsigned long long)connections, (unsigned long long)needed, (unsigned long long)limit.rlim_max);
	return false;
}

/* A whole small text file; NULL, with the reason in the log. */
static char *read_text(const char *path)
{
	enum { MOST = 1 << 20 };
	char *text = NULL;
	FILE *file = fopen(path, "re");
	size_t size = 0;
	if (file && (text = malloc(MOST)))
		size = fread(text, 1, MOST - 1, file);
	if (!text || ferror(file) || size == 0 || size == MOST - 1) {
		esk_log_message(
			"tls", "%s cannot be read: %s", path, errno ? strerror(errno) : "it is empty or too large");
		free(text);
		text = NULL;
	} else {
		text[size] = '\0';
	}
	if (file)
		fclose(file);
	return text;
}

static bool read_tls(const esk_options *options, esk_tls *tls)
{
	if (!options->tls_key)
		return true;
	errno = 0;
	tls->certificate = read_text(options->tls_certificate);
	tls->key = tls->certificate ? read_text(options->tls_key) : NULL;
	return tls->key;
}

static bool loading(void *context, uint64_t loaded, uint64_t total)
{
	int64_t *logged = context, now = esk_clock_now();
	if (now - *logged > 2000) {
		esk_log_message(
			"loading", "%llu of %llu shapes", (unsigned long long)loaded, (unsigned long long)total);
		*logged = now;
	}
	return !stop_is_pending();
}

static bool open_api(const esk_options *options, esk_server *server)
{
	int64_t logged = esk_clock_now();
	const eskel_api_options api_options = {
		.most_body_bytes = options->most_body,
		.most_voxels = options->most_voxels,
		.most_runs = options->most_runs,
		.most_labels = (uint32_t)options->most_labels,
		.most_distances = options->most_distances,
		.most_known_bytes = options->most_known,
		.most_result_bytes = options->most_results,
		.most_mesh_bytes = options->most_meshes,
		.loading = loading,
		.context = &logged,
	};
	eskel_store_error error;
	if (eskel_api_open(options->database, &api_options, &server->api, &error) != ESKEL_STORE_OK) {
		esk_log_message("database", "%s", error.text);
		return false;
	}
	server->auth.store = eskel_api_store(server->api);
	return true;
}

/* Beyond loopback a server without a token would be everybody's. */
static bool check_exposure(const esk_options *options, const esk_server *server, const esk_listener *listener)
{
	size_t valid = 0;
	eskel_store_error error;
	if (listener->loopback)
		return true;
	if (esk_auth_count_valid(server->auth.store, &valid, &error) != ESKEL_STORE_OK) {
		esk_log_message("database", "%s", error.text);
		return false;
	}
	if (!valid)
		esk_log_message("token",
			"%s is not a loopback address and the database has no valid token; make one: "
			"eskeld token add NAME --role admin --database %s",
			options->listen, options->database);
	return valid;
}

static void set_hosts(const esk_options *options, const esk_listener *listener, esk_server *server)
{
	const char *const always[] = {"localhost", "127.0.0.1", "[::1]", listener->host};
	for (size_t a = 0; a < sizeof always / sizeof *always; a++)
		server->hosts[server->host_count++] = always[a];
	for (size_t h = 0; h < options->host_count; h++)
		server->hosts[server->host_count++] = options->hosts[h];
}

static void on_late(void *context)
{
	esk_metrics_reject(context, ESK_REJECT_SLOW);
}

static bool start_parts(const esk_options *options, esk_server *server)
{
	long processors = sysconf(_SC_NPROCESSORS_ONLN);
	size_t workers = options->workers ? options->workers : processors > 0 ? 2 * (size_t)processors : 2;
	server->rate = esk_rate_new(options->rate);
	server->metrics = esk_metrics_new();
	if (server->metrics)
		server->connections = esk_connections_start(on_late, server->metrics);
	if (server->connections)
		server->queue = esk_queue_start(workers, options->queue, esk_request_work);
	if (server->rate && server->queue)
		return true;
	esk_log_message("start", "there is not enough memory, or too few threads are allowed");
	return false;
}

/* ---- life */

static void announce(const esk_listener *listener, bool tls, const esk_server *server)
{
	esk_log_line line;
	esk_log_begin(&line, "listening");
	esk_log_text(&line, "host", listener->host);
	esk_log_number(&line, "port", listener->port);
	esk_log_number(&line, "shapes", eskel_api_shape_count(server->api));
	esk_log_end(&line);
	printf("%s://%s:%u\n", tls ? "https" : "http", listener->host, listener->port);
	fflush(stdout);
}

/* Takes no more connections and requests and waits for the requests under way: until there is none, the time is over, or the
 * signal comes again. */
static bool drain(esk_server *server, struct MHD_Daemon *daemon, uint64_t seconds)
{
	sigset_t set = stop_signals();
	int64_t until = esk_clock_now() + (int64_t)seconds * 1000;
	atomic_store(&server->draining, true);
	shutdown(MHD_quiesce_daemon(daemon), SHUT_RDWR); /* closed later: network threads may not have let go of it */
	esk_log_message("draining", "%zu requests are under way", atomic_load(&server->in_flight));
	const struct timespec moment = {0, 10000000};
	while (atomic_load(&server->in_flight) && esk_clock_now() < until)
		if (sigtimedwait(&set, NULL, &moment) > 0)
			break;
	return atomic_load(&server->in_flight) == 0;
}

static bool run(const esk_options *options, esk_server *server, const esk_tls *tls, const esk_listener *listener)
{
	sigset_t set = stop_signals();
	int signal_number;
	if (!esk_listen_start(listener))
		return false;
	struct MHD_Daemon *daemon = esk_http_start(server, options, tls, listener->fd);
	if (!daemon)
		return false;
	announce(listener, tls->key, server);
	sigwait(&set, &signal_number);
	if (!drain(server, daemon, options->drain)) {
		/* A computation cannot be broken off. Nothing unfinished was acknowledged, and the database is safe
		 * at every moment. */
		esk_log_message("stopped", "%zu requests were abandoned", atomic_load(&server->in_flight));
		_exit(0);
	}
	/* The queue first: a worker may still be leaving MHD_resume_connection. Requests that come now do not reach it. */
	esk_queue_stop(server->queue);
	server->queue = NULL;
	MHD_stop_daemon(daemon);
	close(listener->fd);
	esk_log_message("stopped", "all requests were answered");
	return true;
}

int esk_serve(const esk_options *options)
{
	esk_server server = {0};
	esk_listener listener = {.fd = -1};
	esk_tls tls = {0};
	prepare_process();
	bool good = raise_file_limit(options->connections) && read_tls(options, &tls) &&
		    esk_listen_open(options->listen, &listener) && open_api(options, &server) &&
		    check_exposure(options, &server, &listener) && start_parts(options, &server);
	if (good) {
		set_hosts(options, &listener, &server);
		good = run(options, &server, &tls, &listener);
	} else if (listener.fd >= 0) {
		close(listener.fd);
	}
	esk_queue_stop(server.queue);
	esk_connections_stop(server.connections);
	esk_metrics_free(server.metrics);
	esk_rate_free(server.rate);
	eskel_api_close(server.api);
	free(tls.certificate);
	free(tls.key);
	return good ? 0 : 1;
}
