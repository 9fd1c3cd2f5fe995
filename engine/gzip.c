/* A gzip stream inflated as it arrives (RFC 1952): up to 1024 members, as parallel compressors write them, each with
 * its checksum and size verified by zlib. What follows the last member must be nothing. */
#include "gzip.h"

#include "error.h"
#include "memory.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

struct esk_gzip {
	z_stream stream;
	unsigned members;
	bool inside; /* of a member */
};

static const unsigned most_members = 1024;
static const int gzip_window_bits = 15 + 16; /* the largest window; + 16: a gzip header, not a zlib one */

eskel_status esk_gzip_new(esk_gzip **gzip)
{
	esk_gzip *g = esk_memory_zeroed_array(1, sizeof *g);
	if (!g || inflateInit2(&g->stream, gzip_window_bits) != Z_OK) {
		free(g);
		return ESKEL_NO_MEMORY;
	}
	*gzip = g;
	return ESKEL_OK;
}

void esk_gzip_free(esk_gzip *gzip)
{
	if (!gzip)
		return;
	inflateEnd(&gzip->stream);
	free(gzip);
}

static eskel_status begin_member(esk_gzip *g, uint8_t first_byte, eskel_error *error)
{
	if (first_byte != ESK_GZIP_FIRST_BYTE)
		return esk_error_set(
			error, ESKEL_MALFORMED, "byte 0x%02x follows the end of the gzip data", first_byte);
	if (g->members == most_members)
		return esk_error_set(error, ESKEL_TOO_LARGE, "the gzip data has more than %u members", most_members);
	g->members++;
	g->inside = true;
	inflateReset(&g->stream);
	return ESKEL_OK;
}

static eskel_status check_result(int result, const esk_gzip *g, eskel_error *error)
{
	switch (result) {
	case Z_OK:
	case Z_STREAM_END:
		return ESKEL_OK;
	case Z_MEM_ERROR:
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out while inflating");
	default:
		return esk_error_set(error, ESKEL_MALFORMED, "the gzip data is damaged: %s",
			g->stream.msg ? g->stream.msg : "unknown fault");
	}
}

static uInt clamp(size_t size)
{
	return size < UINT_MAX ? (uInt)size : UINT_MAX;
}

eskel_status esk_gzip_inflate(esk_gzip *g, const uint8_t **in, size_t *in_size, uint8_t *out, size_t out_size,
	size_t *out_used, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	size_t used = 0;
	while (status == ESKEL_OK && used < out_size) {
		if (!g->inside && *in_size == 0)
			break;
		if (!g->inside && (status = begin_member(g, **in, error)) != ESKEL_OK)
			break;
		uInt in_before = clamp(*in_size), out_before = clamp(out_size - used);
		g->stream.next_in = (z_const Bytef *)*in;
		g->stream.avail_in = in_before;
		g->stream.next_out = out + used;
		g->stream.avail_out = out_before;
		int result = inflate(&g->stream, Z_NO_FLUSH);
		uInt taken = in_before - g->stream.avail_in, written = out_before - g->stream.avail_out;
		*in += taken;
		*in_size -= taken;
		used += written;
		if (result == Z_STREAM_END)
			g->inside = false;
		else if (result == Z_BUF_ERROR) /* nothing left to do with this input */
			break;
		status = check_result(result, g, error);
	}
	*out_used = used;
	return status;
}

bool esk_gzip_is_complete(const esk_gzip *gzip)
{
	return gzip->members > 0 && !gzip->inside;
}
