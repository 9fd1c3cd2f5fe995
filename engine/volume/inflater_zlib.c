#include "inflater.h"

#include "memory.h"

#include <limits.h>
#include <stdlib.h>
#include <zlib.h>

struct esk_inflater {
	z_stream stream;
};

static const int raw_window_bits = -15; /* the largest window; negative: neither header nor trailer */

eskel_status esk_inflater_new(esk_inflater **inflater)
{
	esk_inflater *f = esk_memory_zeroed_array(1, sizeof *f);
	if (!f || inflateInit2(&f->stream, raw_window_bits) != Z_OK) {
		free(f);
		return ESKEL_NO_MEMORY;
	}
	*inflater = f;
	return ESKEL_OK;
}

void esk_inflater_free(esk_inflater *inflater)
{
	if (!inflater)
		return;
	inflateEnd(&inflater->stream);
	free(inflater);
}

void esk_inflater_begin(esk_inflater *inflater)
{
	inflateReset(&inflater->stream);
}

static uInt clamp(size_t size)
{
	return size < UINT_MAX ? (uInt)size : UINT_MAX;
}

eskel_status esk_inflater_run(esk_inflater *inflater, const uint8_t **in, size_t *in_size, uint8_t *out,
	size_t out_size, size_t *out_used, bool *ended)
{
	z_stream *s = &inflater->stream;
	s->next_in = (z_const Bytef *)*in;
	s->avail_in = clamp(*in_size);
	s->next_out = out;
	s->avail_out = clamp(out_size);
	int result = inflate(s, Z_NO_FLUSH);
	*in_size -= (size_t)(s->next_in - *in);
	*in = s->next_in;
	*out_used = (size_t)(s->next_out - out);
	*ended = result == Z_STREAM_END;
	if (result == Z_MEM_ERROR)
		return ESKEL_NO_MEMORY;
	/* Z_BUF_ERROR: nothing left to do with this input */
	return result == Z_OK || result == Z_BUF_ERROR || *ended ? ESKEL_OK : ESKEL_MALFORMED;
}

uint32_t esk_inflater_crc32(uint32_t crc, const uint8_t *bytes, size_t size)
{
	return (uint32_t)crc32_z(crc, bytes, size);
}

uint32_t esk_inflater_adler32(uint32_t adler, const uint8_t *bytes, size_t size)
{
	return (uint32_t)adler32_z(adler, bytes, size);
}
