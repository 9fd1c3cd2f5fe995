#include "connections.h"

#include "clock.h"
#include "log.h"

#include <microhttpd.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/socket.h>

static const int64_t sweep_ms = 250;
static const int64_t head_ms = 10000, idle_ms = 25000, reply_ms = 30000;
static const int64_t body_grace_ms = 10000, body_most_ms = 600000;
static const uint64_t bytes_a_ms = 16; /* 16 KB/s: a modem of 1998 had a third */
static const int64_t lost_ms = 5000;

struct esk_connections {
	pthread_mutex_t lock;
	pthread_cond_t stop;
	bool stopping;
	esk_connection *first;
	size_t count;
	void (*late)(void *context);
	void *context;
	pthread_t thread;
};

/* ---- deadlines */

static int64_t time_for(uint64_t bytes)
{
	uint64_t ms = bytes / bytes_a_ms;
	return ms < INT64_MAX / 2 ? (int64_t)ms : INT64_MAX / 2;
}

void esk_connection_in_body(esk_connection *connection, int64_t started, uint64_t received)
{
	int64_t allowed = body_grace_ms + time_for(received);
	atomic_store(&connection->deadline, started + (allowed < body_most_ms ? allowed : body_most_ms));
}

void esk_connection_in_work(esk_connection *connection)
{
	atomic_store(&connection->deadline, INT64_MAX);
}

void esk_connection_in_reply(esk_connection *connection, uint64_t size)
{
	atomic_store(&connection->deadline, esk_clock_now() + reply_ms + time_for(size));
}

void esk_connection_wait(esk_connection *connection)
{
	atomic_store(&connection->waits, true);
}

void esk_connection_idle(esk_connection *connection)
{
	atomic_store(&connection->deadline, esk_clock_now() + idle_ms);
}

/* ---- list */

esk_connection *esk_connections_add(esk_connections *connections, struct MHD_Connection *connection, int fd)
{
	esk_connection *c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	c->connection = connection;
	c->fd = fd;
	atomic_init(&c->deadline, esk_clock_now() + head_ms);
	pthread_mutex_lock(&connections->lock);
	c->next = connections->first;
	if (c->next)
		c->next->previous = c;
	connections->first = c;
	connections->count++;
	pthread_mutex_unlock(&connections->lock);
	return c;
}

void esk_connections_remove(esk_connections *connections, esk_connection *c)
{
	pthread_mutex_lock(&connections->lock);
	if (c->next)
		c->next->previous = c->previous;
	*(c->previous ? &c->previous->next : &connections->first) = c->next;
	connections->count--;
	pthread_mutex_unlock(&connections->lock);
	free(c);
}

size_t esk_connections_count(esk_connections *connections)
{
	pthread_mutex_lock(&connections->lock);
	size_t count = connections->count;
	pthread_mutex_unlock(&connections->lock);
	return count;
}

/* ---- thread */

static void wake_waiting(esk_connection *c, int64_t now)
{
	if (!atomic_exchange(&c->waits, false))
		return;
	atomic_store(&c->resumed, now);
	MHD_resume_connection(c->connection);
}

/* A connection that was resumed and that libmicrohttpd forgot would hang for ever: resuming it again is harmless. */
static void wake_lost(esk_connection *c, int64_t now)
{
	int64_t resumed = atomic_load(&c->resumed);
	if (!resumed || now - resumed < lost_ms)
		return;
	atomic_store(&c->resumed, now);
	MHD_resume_connection(c->connection);
	esk_log_message("watchdog", "a finished request was not picked up: woke it again");
}

static void sweep(esk_connections *connections)
{
	int64_t now = esk_clock_now();
	for (esk_connection *c = connections->first; c; c = c->next) {
		wake_waiting(c, now);
		wake_lost(c, now);
		if (now < atomic_load(&c->deadline))
			continue;
		atomic_store(&c->deadline, INT64_MAX);
		shutdown(c->fd, SHUT_RDWR);
		connections->late(connections->context);
	}
}

static void *run(void *context)
{
	esk_connections *connections = context;
	pthread_mutex_lock(&connections->lock);
	while (!connections->stopping) {
		struct timespec until;
		clock_gettime(CLOCK_MONOTONIC, &until);
		until.tv_nsec += sweep_ms * 1000000;
		until.tv_sec += until.tv_nsec / 1000000000;
		until.tv_nsec %= 1000000000;
		pthread_cond_timedwait(&connections->stop, &connections->lock, &until);
		sweep(connections);
	}
	pthread_mutex_unlock(&connections->lock);
	return NULL;
}

esk_connections *esk_connections_start(void (*late)(void *context), void *context)
{
	esk_connections *connections = calloc(1, sizeof *connections);
	if (!connections)
		return NULL;
	connections->late = late;
	connections->context = context;
	pthread_mutex_init(&connections->lock, NULL);
	pthread_condattr_t monotonic;
	pthread_condattr_init(&monotonic);
	pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
	pthread_cond_init(&connections->stop, &monotonic);
	pthread_condattr_destroy(&monotonic);
	if (pthread_create(&connections->thread, NULL, run, connections) == 0)
		return connections;
	pthread_cond_destroy(&connections->stop);
	pthread_mutex_destroy(&connections->lock);
	free(connections);
	return NULL;
}

void esk_connections_stop(esk_connections *connections)
{
	if (!connections)
		return;
	pthread_mutex_lock(&connections->lock);
	connections->stopping = true;
	pthread_cond_signal(&connections->stop);
	pthread_mutex_unlock(&connections->lock);
	pthread_join(connections->thread, NULL);
	pthread_cond_destroy(&connections->stop);
	pthread_mutex_destroy(&connections->lock);
	free(connections);
}
