/* The open connections and how long each may take: against clients that drip.
 *
 * libmicrohttpd's timeout starts anew with each byte, so a client that sends one every few seconds holds its
 * connection for ever. Here each connection has one deadline, moved by the network threads as the exchange proceeds;
 * one thread looks through the list four times a second and shuts the sockets that are late. libmicrohttpd then finds
 * them closed and cleans up as after any lost client. The same thread wakes those that wait for news to send.
 *
 *     head    10 s from the connection's start
 *     body    10 s, and a second for every 16 KB that came; 10 minutes at most
 *     work    none: the client waits for us; the same while there is no news to send
 *     reply   30 s, and a second for every 16 KB of it; of a streamed one for each piece
 *     idle    25 s to the end of the next head (libmicrohttpd itself ends idle ones after 15 s)
 */
#ifndef ESK_CONNECTIONS_H
#define ESK_CONNECTIONS_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

struct MHD_Connection;
typedef struct esk_connections esk_connections;

typedef struct esk_connection {
	struct esk_connection *next, *previous;
	struct MHD_Connection *connection;
	int fd;
	_Atomic int64_t deadline; /* monotonic milliseconds */
	_Atomic int64_t resumed;  /* when it was woken and no network thread has come since; else 0 */
	atomic_bool waits;        /* suspended, until it is woken a quarter of a second later */
} esk_connection;

/* late is called for each connection that is shut. NULL when threads or memory ran out. */
esk_connections *esk_connections_start(void (*late)(void *context), void *context);
/* The list must be empty by then. NULL is fine. */
void esk_connections_stop(esk_connections *connections);

/* NULL when memory ran out. */
esk_connection *esk_connections_add(esk_connections *connections, struct MHD_Connection *connection, int fd);
/* Before the socket is closed: its number may be another connection's a moment later. */
void esk_connections_remove(esk_connections *connections, esk_connection *connection);
size_t esk_connections_count(esk_connections *connections);

void esk_connection_in_body(esk_connection *connection, int64_t started, uint64_t received);
void esk_connection_in_work(esk_connection *connection);
void esk_connection_in_reply(esk_connection *connection, uint64_t size);
/* Of a connection that was suspended: wakes it at the next look through the list. */
void esk_connection_wait(esk_connection *connection);
void esk_connection_idle(esk_connection *connection);

#endif
