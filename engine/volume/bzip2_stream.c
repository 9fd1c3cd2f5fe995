/* libbz2 does all. Its run-length stage packs 8 GiB of zeros into a few kilobytes, so whoever takes the output must stop at
 * what the header promised, as esk_decompressor_feed lets it. */
#include "bzip2_stream.h"

#include "error.h"
#include "memory.h"

#include <bzlib.h>
#include <limits.h>
#include <stdlib.h>

struct esk_bzip2_stream {
	bz_stream stream;
	bool complete;
};

eskel_status esk_bzip2_stream_new(esk_bzip2_stream **stream)
{
	esk_bzip2_stream *s = esk_memory_zeroed_array(1, sizeof *s);
	const int silent = 0, fast = 0;
	if (!s || BZ2_bzDecompressInit(&s->stream, silent, fast) != BZ_OK) {
		free(s);
		return ESKEL_NO_MEMORY;
	}
	*stream = s;
	return ESKEL_OK;
}

void esk_bzip2_stream_free(esk_bzip2_stream *stream)
{
	if (!stream)
		return;
	BZ2_bzDecompressEnd(&stream->stream);
	free(stream);
}

static unsigned clamp(size_t size)
{
	return size < UINT_MAX ? (unsigned)size : UINT_MAX;
}

static eskel_status decode_some(esk_bzip2_stream *s, const uint8_t **in, size_t *in_size, uint8_t *out, size_t out_size,
	size_t *out_used, eskel_error *error)
{
	bz_stream *b = &s->stream;
	const unsigned given = clamp(*in_size), room = clamp(out_size);
	b->next_in = (char *)*in; /* which it only reads */
	b->avail_in = given;
	b->next_out = (char *)out;
	b->avail_out = room;
	const int result = BZ2_bzDecompress(b);
	*in += given - b->avail_in;
	*in_size -= given - b->avail_in;
	*out_used = room - b->avail_out;
	s->complete = result == BZ_STREAM_END;
	if (result == BZ_MEM_ERROR)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out while decoding bzip2 data");
	if (result == BZ_DATA_ERROR_MAGIC)
		return esk_error_set(
			error, ESKEL_MALFORMED, "the compressed data does not begin as a bzip2 stream, BZh");
	if (result != BZ_OK && result != BZ_STREAM_END)
		return esk_error_set(error, ESKEL_MALFORMED, "the bzip2 data is damaged: it cannot be decoded");
	return ESKEL_OK;
}

eskel_status esk_bzip2_stream_decode(esk_bzip2_stream *stream, const uint8_t **in, size_t *in_size, uint8_t *out,
	size_t out_size, size_t *out_used, eskel_error *error)
{
	*out_used = 0;
	if (!stream->complete)
		return decode_some(stream, in, in_size, out, out_size, out_used, error);
	return *in_size == 0
		       ? ESKEL_OK
		       : esk_error_set(error, ESKEL_MALFORMED, "byte 0x%02x follows the end of the bzip2 data", **in);
}

bool esk_bzip2_stream_is_complete(const esk_bzip2_stream *stream)
{
	return stream->complete;
}
