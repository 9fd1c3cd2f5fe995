/* One HTTP request from its first byte to its log line.
 *
 *     HEAD     the head is checked (guard.h, auth.h, rate.h) and given to the API or answered here
 *     BODY     the body is fed to the exchange; once the exchange has refused it, swallowed
 *     WORKING  a worker finishes the exchange while libmicrohttpd has the connection suspended
 *     WORKED   the worker is done
 *     SENT     the response is queued
 *     MAKING   a worker makes the next piece of a streamed body while the connection is suspended; then SENT again
 *
 * A stream keeps its place in the queue to its end, and each of its pieces waits its turn there: however long it is,
 * others are served in between. When its client is gone, that is seen when the piece under way is to be sent.
 *
 * A live stream has neither place nor worker: the network thread makes its pieces, which cost nothing, and where there is no
 * news the connection is suspended and looked at again a quarter of a second later (connections.h). A stop ends it.
 *
 * libmicrohttpd drops a response that is queued in mid-body. So a refusal waits until the body has passed; the
 * connection then stays usable. Cut off is only who sends more than 8 MiB and for longer than 5 s after the refusal.
 * A refusal by the head of a client that waits (Expect: 100-continue), announces more than 8 MiB, or sends a head that
 * cannot be trusted is sent at once, and the connection closed.
 */
#ifndef ESK_REQUEST_H
#define ESK_REQUEST_H

#include "server.h"

#include <microhttpd.h>

typedef struct esk_request esk_request;

/* target: as in the request line. NULL when memory ran out. */
esk_request *esk_request_new(
	esk_server *server, struct MHD_Connection *connection, esk_connection *peer, const char *target);

/* libmicrohttpd's access handler: the first call is for the head, then one for each piece of body, one for its end,
 * and one after each resumption. */
enum MHD_Result esk_request_receive(
	esk_request *request, const char *method, const char *version, const char *bytes, size_t *size);

/* What workers do with the job of a request. */
void esk_request_work(esk_job *job);

/* Logs, counts and frees it. */
void esk_request_end(esk_request *request, enum MHD_RequestTerminationCode how);

#endif
