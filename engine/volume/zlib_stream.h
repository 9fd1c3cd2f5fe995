/* A zlib stream inflated as it arrives. */
#ifndef ESK_ZLIB_STREAM_H
#define ESK_ZLIB_STREAM_H

#include "eskel.h"

typedef struct esk_zlib_stream esk_zlib_stream;

eskel_status esk_zlib_stream_new(esk_zlib_stream **stream);
void esk_zlib_stream_free(esk_zlib_stream *stream);

/* Inflates some of the *in_size bytes at *in, which it moves past what it took, into out; *out_used receives how many
 * bytes it wrote, also on failure. All is inflated once *in_size is 0 and *out_used < out_size. */
eskel_status esk_zlib_stream_inflate(esk_zlib_stream *stream, const uint8_t **in, size_t *in_size, uint8_t *out,
	size_t out_size, size_t *out_used, eskel_error *error);

/* Whether the stream's end has come and its checksum was right. */
bool esk_zlib_stream_is_complete(const esk_zlib_stream *stream);

#endif
