/* The listening socket. */
#ifndef ESK_LISTEN_H
#define ESK_LISTEN_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
	int fd;        /* bound, not yet listening: clients are refused until esk_listen_start */
	char host[64]; /* as in a URL: IPv6 in brackets */
	uint16_t port; /* the one chosen, for port 0 */
	bool loopback;
} esk_listener;

/* text: 127.0.0.1:8467 or [::1]:8467. False, with a sentence in the log, when it is none or cannot be bound. */
bool esk_listen_open(const char *text, esk_listener *listener);
bool esk_listen_start(const esk_listener *listener);

#endif
