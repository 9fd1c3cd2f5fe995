/* A gzip stream inflated as it arrives (RFC 1952): up to 1024 members, as parallel compressors write them. What follows
 * the last member must be nothing.
 *
 * zlib's checksum takes as long as its inflating, so the checksum is ours (crc32.h): once a member's header is read and
 * verified, zlib is told not to check. It still takes the member's last eight bytes, checksum and size, so the last
 * bytes that it took are kept, and compared at the member's end.
 */
#include "gzip.h"

#include "bytes.h"
#include "crc32.h"
#include "error.h"
#include "memory.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

enum { trailer_size = 8 };

struct esk_gzip {
	z_stream stream;
	gz_header header; /* of the member; only done is of interest */
	unsigned members;
	bool inside; /* of a member */
	uint32_t crc, size;
	uint8_t last[trailer_size]; /* bytes taken */
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
	g->crc = 0;
	g->size = 0;
	inflateReset(&g->stream);
	inflateValidate(&g->stream, 1);
	inflateGetHeader(&g->stream, &g->header);
	return ESKEL_OK;
}

static eskel_status end_member(esk_gzip *g, eskel_error *error)
{
	uint32_t crc = esk_bytes_get_u32(g->last), size = esk_bytes_get_u32(g->last + 4);
	g->inside = false;
	if (crc != g->crc)
		return esk_error_set(error, ESKEL_MALFORMED,
			"the gzip data is damaged: its checksum is %08x, expected %08x", g->crc, crc);
	if (size != g->size)
		return esk_error_set(
			error, ESKEL_MALFORMED, "the gzip data is damaged: its size is %u, expected %u", g->size, size);
	return ESKEL_OK;
}

static eskel_status check_result(int result, esk_gzip *g, eskel_error *error)
{
	switch (result) {
	case Z_OK:
		return ESKEL_OK;
	case Z_STREAM_END:
		return end_member(g, error);
	case Z_MEM_ERROR:
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out while inflating");
	default:
		return esk_error_set(error, ESKEL_MALFORMED, "the gzip data is damaged: %s",
			g->stream.msg ? g->stream.msg : "unknown fault");
	}
}

static void keep_last(esk_gzip *g, const uint8_t *taken, size_t size)
{
	size_t fresh = size < trailer_size ? size : trailer_size;
	memmove(g->last, g->last + fresh, trailer_size - fresh);
	memcpy(g->last + trailer_size - fresh, taken + size - fresh, fresh);
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
		/* Z_BLOCK: return after the header. */
		int result = inflate(&g->stream, g->header.done ? Z_NO_FLUSH : Z_BLOCK);
		uInt taken = in_before - g->stream.avail_in, written = out_before - g->stream.avail_out;
		keep_last(g, *in, taken);
		g->crc = esk_crc32(g->crc, out + used, written);
		g->size += written;
		if (g->header.done)
			inflateValidate(&g->stream, 0);
		*in += taken;
		*in_size -= taken;
		used += written;
		if (result == Z_BUF_ERROR) /* nothing left to do with this input */
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
