#include "guard.h"

#include <string.h>
#include <strings.h>

static const esk_refusal nothing;

const char *esk_guard_header(const eskel_request *head, const char *name)
{
	for (size_t h = 0; h < head->header_count; h++)
		if (!strcasecmp(head->headers[h].name, name))
			return head->headers[h].value;
	return NULL;
}

static size_t count(const eskel_request *head, const char *name)
{
	size_t n = 0;
	for (size_t h = 0; h < head->header_count; h++)
		n += !strcasecmp(head->headers[h].name, name);
	return n;
}

/* RFC 9110, 5.6.2. "Content-Length : 5" is not a Content-Length here, but may be one to a proxy. */
static bool is_token(const char *name)
{
	static const char allowed[] = "!#$%&'*+-.^_`|~0123456789"
				      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
	return *name && !name[strspn(name, allowed)];
}

static esk_refusal framing(int status, const char *detail)
{
	return (esk_refusal){status, ESK_REJECT_FRAMING, detail, true};
}

esk_refusal esk_guard_framing(const eskel_request *head, const char *version)
{
	for (size_t h = 0; h < head->header_count; h++)
		if (!is_token(head->headers[h].name))
			return framing(400, "a header field's name is not a token");
	static const char *const single[] = {"Host", "Content-Length", "Transfer-Encoding", "Authorization"};
	for (size_t s = 0; s < sizeof single / sizeof *single; s++)
		if (count(head, single[s]) > 1)
			return framing(400, "Host, Content-Length, Transfer-Encoding or Authorization is there twice");
	const char *encoding = esk_guard_header(head, "Transfer-Encoding");
	if (!encoding)
		return nothing;
	if (esk_guard_header(head, "Content-Length"))
		return framing(400, "there are both Content-Length and Transfer-Encoding");
	if (strcmp(version, "HTTP/1.1") != 0)
		return framing(400, "Transfer-Encoding needs HTTP/1.1");
	if (strcasecmp(encoding, "chunked") != 0)
		return framing(501, "the Transfer-Encoding is not chunked");
	return nothing;
}

/* The length of the host in "host", "host:port" or "[v6]:port", 0 when it is none of them. */
static size_t host_length(const char *text)
{
	size_t length = *text == '[' ? strcspn(text, "]") + 1 : strcspn(text, ":");
	if (length > strlen(text))
		return 0;
	const char *port = text + length;
	if (*port && (*port != ':' || port[1 + strspn(port + 1, "0123456789")]))
		return 0;
	return length;
}

static bool is_ours(const char *text, const char *const *hosts, size_t host_count)
{
	size_t length = host_length(text);
	for (size_t h = 0; h < host_count; h++)
		if (length && strlen(hosts[h]) == length && !strncasecmp(hosts[h], text, length))
			return true;
	return false;
}

esk_refusal esk_guard_host(const eskel_request *head, const char *const *hosts, size_t host_count)
{
	const char *host = esk_guard_header(head, "Host");
	if (host && is_ours(host, hosts, host_count))
		return nothing;
	return (esk_refusal){421, ESK_REJECT_HOST,
		"the Host is not a name of this server; its operator can add one with --host", false};
}

esk_refusal esk_guard_site(const eskel_request *head, const char *const *hosts, size_t host_count)
{
	static const esk_refusal foreign = {
		403, ESK_REJECT_SITE, "a page of another site may not change anything here", false};
	if (!strcmp(head->method, "GET") || !strcmp(head->method, "HEAD") || !strcmp(head->method, "OPTIONS"))
		return nothing;
	const char *site = esk_guard_header(head, "Sec-Fetch-Site");
	if (site)
		return !strcmp(site, "same-origin") || !strcmp(site, "none") ? nothing : foreign;
	const char *origin = esk_guard_header(head, "Origin");
	if (!origin)
		return nothing;
	const char *host = strstr(origin, "://");
	return host && is_ours(host + 3, hosts, host_count) ? nothing : foreign;
}
