#include "send.h"

#include <string.h>

/* The page is one origin, loads only its own files and may be framed by nobody; the policy is harmless elsewhere. */
static const eskel_field always[] = {
	{"X-Content-Type-Options", "nosniff"},
	{"Referrer-Policy", "no-referrer"},
	{"Cross-Origin-Resource-Policy", "same-origin"},
	{"Content-Security-Policy",
		"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
		"connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
};

static bool add(struct MHD_Response *out, const eskel_field *fields, size_t count)
{
	for (size_t f = 0; f < count; f++)
		if (MHD_add_response_header(out, fields[f].name, fields[f].value) != MHD_YES)
			return false;
	return true;
}

static bool add_all(struct MHD_Response *out, const eskel_response *response, bool close)
{
	const eskel_field own[] = {
		{"Content-Type", response->content_type},
		{"Connection", "close"},
		{"Cache-Control", "no-store"},
	};
	bool cacheable = false;
	for (size_t h = 0; h < response->header_count; h++)
		cacheable |= !strcmp(response->headers[h].name, "Cache-Control");
	return add(out, always, sizeof always / sizeof *always) &&
	       add(out, response->headers, response->header_count) &&
	       add(out, &own[0], response->content_type ? 1 : 0) && add(out, &own[1], close ? 1 : 0) &&
	       add(out, &own[2], cacheable ? 0 : 1);
}

static struct MHD_Response *make_streamed(const eskel_response *response, MHD_ContentReaderCallback read, void *context)
{
	enum { AT_A_TIME = 1 << 16 };
	const uint64_t size = response->size == ESKEL_SIZE_UNKNOWN ? MHD_SIZE_UNKNOWN : response->size;
	return MHD_create_response_from_callback(size, AT_A_TIME, read, context, NULL);
}

enum MHD_Result esk_send(struct MHD_Connection *connection, const eskel_response *response, bool close,
	MHD_ContentReaderCallback read, void *context)
{
	struct MHD_Response *out = response->streamed ? make_streamed(response, read, context)
						      : MHD_create_response_from_buffer(response->size,
								(void *)response->body, MHD_RESPMEM_PERSISTENT);
	if (!out)
		return MHD_NO;
	enum MHD_Result result = MHD_NO;
	if (add_all(out, response, close))
		result = MHD_queue_response(connection, (unsigned)response->status, out);
	MHD_destroy_response(out);
	return result;
}
