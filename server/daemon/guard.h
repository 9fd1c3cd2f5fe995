/* What a request's head must not say, whoever asks.
 *
 * libmicrohttpd accepts heads that two servers in a row read differently (request smuggling), and knows nothing of
 * browsers that are led here by a foreign page. Pure functions over the header fields.
 */
#ifndef ESK_GUARD_H
#define ESK_GUARD_H

#include "eskel_api.h"
#include "metrics.h"

typedef struct {
	int status; /* 0: nothing to refuse */
	esk_rejection reason;
	const char *detail; /* static */
	bool close;         /* where the next request starts cannot be trusted */
} esk_refusal;

/* The value of the first field of that name in any case, or NULL. */
const char *esk_guard_header(const eskel_request *head, const char *name);

/* Field names that are no tokens; Host, Content-Length, Transfer-Encoding or Authorization twice; a length and an
 * encoding at once, an encoding in HTTP/1.0 (400); an encoding other than chunked (501). All close. */
esk_refusal esk_guard_framing(const eskel_request *head, const char *version);

/* A Host that is not in the list (421): a foreign name that resolves to this machine (DNS rebinding). hosts hold
 * names and addresses without a port, IPv6 in brackets. */
esk_refusal esk_guard_host(const eskel_request *head, const char *const *hosts, size_t host_count);

/* Anything but GET, HEAD and OPTIONS that a browser sends for a page of another site (403). Browsers say so in
 * Sec-Fetch-Site, older ones in Origin; other clients send neither. */
esk_refusal esk_guard_site(const eskel_request *head, const char *const *hosts, size_t host_count);

#endif
