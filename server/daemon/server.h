/* What all requests of one running server share. Made and unmade by serve.c; the members lock for themselves. */
#ifndef ESK_SERVER_H
#define ESK_SERVER_H

#include "auth.h"
#include "connections.h"
#include "eskel_api.h"
#include "metrics.h"
#include "options.h"
#include "queue.h"
#include "rate.h"

#include <stdatomic.h>

typedef struct {
	eskel_api *api;
	esk_auth auth;
	esk_rate *rate;
	esk_queue *queue;
	esk_connections *connections;
	esk_metrics *metrics;
	const char *hosts[ESK_MOST_HOSTS + 4];
	size_t host_count;
	atomic_size_t in_flight; /* requests from the end of their head to that of their reply */
	atomic_bool listening;
	atomic_bool draining; /* new requests are refused, connections closed after their reply */
} esk_server;

#endif
