#include "decompressor.h"

#include "bzip2_stream.h"
#include "gzip.h"
#include "memory.h"
#include "zlib_stream.h"

#include <stdlib.h>

/* Decoded bytes are scanned while they are still in the second-level cache. A window costs the inflater a copy of the
 * 32 KB before it, so it is not small. Fuzzers define one that their inputs fill. */
#ifndef ESK_DECOMPRESSOR_WINDOW
#define ESK_DECOMPRESSOR_WINDOW (1 << 18)
#endif
enum { window_size = ESK_DECOMPRESSOR_WINDOW };

struct esk_decompressor {
	esk_compression compression;
	union {
		esk_gzip *gzip;
		esk_zlib_stream *zlib;
		esk_bzip2_stream *bzip2;
	} of;
	uint8_t *window;
};

static eskel_status new_stream(esk_decompressor *d)
{
	switch (d->compression) {
	case ESK_COMPRESSION_ZLIB:
		return esk_zlib_stream_new(&d->of.zlib);
	case ESK_COMPRESSION_BZIP2:
		return esk_bzip2_stream_new(&d->of.bzip2);
	case ESK_COMPRESSION_GZIP:
		break;
	}
	return esk_gzip_new(&d->of.gzip);
}

eskel_status esk_decompressor_new(esk_compression compression, esk_decompressor **decompressor)
{
	esk_decompressor *d = esk_memory_zeroed_array(1, sizeof *d);
	if (!d)
		return ESKEL_NO_MEMORY;
	d->compression = compression;
	d->window = esk_memory_array(window_size, 1);
	if (!d->window || new_stream(d) != ESKEL_OK) {
		free(d->window);
		free(d);
		return ESKEL_NO_MEMORY;
	}
	*decompressor = d;
	return ESKEL_OK;
}

void esk_decompressor_free(esk_decompressor *decompressor)
{
	if (!decompressor)
		return;
	switch (decompressor->compression) {
	case ESK_COMPRESSION_GZIP:
		esk_gzip_free(decompressor->of.gzip);
		break;
	case ESK_COMPRESSION_ZLIB:
		esk_zlib_stream_free(decompressor->of.zlib);
		break;
	case ESK_COMPRESSION_BZIP2:
		esk_bzip2_stream_free(decompressor->of.bzip2);
		break;
	}
	free(decompressor->window);
	free(decompressor);
}

static eskel_status decode_some(
	esk_decompressor *d, const uint8_t **bytes, size_t *size, size_t *used, eskel_error *error)
{
	switch (d->compression) {
	case ESK_COMPRESSION_ZLIB:
		return esk_zlib_stream_inflate(d->of.zlib, bytes, size, d->window, window_size, used, error);
	case ESK_COMPRESSION_BZIP2:
		return esk_bzip2_stream_decode(d->of.bzip2, bytes, size, d->window, window_size, used, error);
	case ESK_COMPRESSION_GZIP:
		break;
	}
	return esk_gzip_inflate(d->of.gzip, bytes, size, d->window, window_size, used, error);
}

eskel_status esk_decompressor_feed(esk_decompressor *decompressor, const uint8_t *bytes, size_t size,
	esk_decompressor_taker *take, void *taker, eskel_error *error)
{
	eskel_status decoded;
	size_t used;
	do {
		decoded = decode_some(decompressor, &bytes, &size, &used, error);
		/* What came out before a fault is looked at first, as it would be had it come alone. */
		eskel_status status = used > 0 ? take(taker, decompressor->window, used, error) : ESKEL_OK;
		if (status != ESKEL_OK)
			return status;
	} while (decoded == ESKEL_OK && (size > 0 || used == window_size));
	return decoded;
}

bool esk_decompressor_is_complete(const esk_decompressor *decompressor)
{
	switch (decompressor->compression) {
	case ESK_COMPRESSION_ZLIB:
		return esk_zlib_stream_is_complete(decompressor->of.zlib);
	case ESK_COMPRESSION_BZIP2:
		return esk_bzip2_stream_is_complete(decompressor->of.bzip2);
	case ESK_COMPRESSION_GZIP:
		break;
	}
	return esk_gzip_is_complete(decompressor->of.gzip);
}

const char *esk_decompressor_name(const esk_decompressor *decompressor)
{
	static const char *const names[] = {"gzip", "zlib", "bzip2"};
	return names[decompressor->compression];
}
