#include "listen.h"

#include "log.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* Cuts "host:port" or "[host]:port" into its parts, in place. */
static bool split(char *text, char **host, char **port)
{
	char *colon = strrchr(text, ':');
	if (!colon || colon == text || !colon[1] || strlen(colon + 1) > 5 ||
		colon[1 + strspn(colon + 1, "0123456789")] || atoi(colon + 1) > UINT16_MAX)
		return false;
	*colon = '\0';
	*host = text;
	*port = colon + 1;
	if (*text != '[')
		return !strchr(text, ':');
	if (colon[-1] != ']')
		return false;
	colon[-1] = '\0';
	*host = text + 1;
	return true;
}

static struct addrinfo *resolve(const char *text)
{
	struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
	struct addrinfo *found = NULL;
	char *copy = strdup(text), *host = NULL, *port = NULL;
	if (!copy || !split(copy, &host, &port) || getaddrinfo(host, port, &hints, &found) != 0)
		found = NULL;
	free(copy);
	return found;
}

static int bind_to(const struct addrinfo *address)
{
	int on = 1;
	int fd = socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return -1;
	/* A restarted server must not wait for the old connections' TIME_WAIT. */
	if (setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
		bind(fd, address->ai_addr, address->ai_addrlen) == 0)
		return fd;
	int failed = errno;
	close(fd);
	errno = failed;
	return -1;
}

static void describe(int fd, esk_listener *listener)
{
	union {
		struct sockaddr any;
		struct sockaddr_in v4;
		struct sockaddr_in6 v6;
	} bound = {.v6 = {0}};
	socklen_t size = sizeof bound;
	char text[INET6_ADDRSTRLEN];
	getsockname(fd, &bound.any, &size);
	*listener = (esk_listener){.fd = fd};
	if (bound.any.sa_family == AF_INET6) {
		inet_ntop(AF_INET6, &bound.v6.sin6_addr, text, sizeof text);
		snprintf(listener->host, sizeof listener->host, "[%s]", text);
		listener->port = ntohs(bound.v6.sin6_port);
		listener->loopback = IN6_IS_ADDR_LOOPBACK(&bound.v6.sin6_addr);
	} else {
		inet_ntop(AF_INET, &bound.v4.sin_addr, listener->host, sizeof listener->host);
		listener->port = ntohs(bound.v4.sin_port);
		listener->loopback = ntohl(bound.v4.sin_addr.s_addr) >> 24 == 127;
	}
}

bool esk_listen_open(const char *text, esk_listener *listener)
{
	struct addrinfo *address = resolve(text);
	if (!address) {
		esk_log_message(
			"listen", "--listen is %s, expected ADDRESS:PORT such as 127.0.0.1:8467 or [::1]:8467", text);
		return false;
	}
	int fd = bind_to(address);
	freeaddrinfo(address);
	if (fd < 0) {
		esk_log_message("listen", "%s cannot be listened to: %s", text, strerror(errno));
		return false;
	}
	describe(fd, listener);
	return true;
}

bool esk_listen_start(const esk_listener *listener)
{
	if (listen(listener->fd, SOMAXCONN) == 0)
		return true;
	esk_log_message("listen", "%s:%u cannot be listened to: %s", listener->host, listener->port, strerror(errno));
	return false;
}
