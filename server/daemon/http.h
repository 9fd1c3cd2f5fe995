/* libmicrohttpd: how it is set up, and its callbacks. */
#ifndef ESK_HTTP_H
#define ESK_HTTP_H

#include "server.h"

#include <stdbool.h>

struct MHD_Daemon;

/* PEM texts; both NULL for plain http. */
typedef struct {
	char *certificate, *key;
} esk_tls;

/* Serves the listening socket. NULL, with the reason in the log, when it cannot. */
struct MHD_Daemon *esk_http_start(esk_server *server, const esk_options *options, const esk_tls *tls, int listening);

#endif
