/* A bzip2 stream decoded as it arrives. */
#ifndef ESK_BZIP2_STREAM_H
#define ESK_BZIP2_STREAM_H

#include "eskel.h"

typedef struct esk_bzip2_stream esk_bzip2_stream;

eskel_status esk_bzip2_stream_new(esk_bzip2_stream **stream);
void esk_bzip2_stream_free(esk_bzip2_stream *stream);

/* Decodes some of the *in_size bytes at *in, which it moves past what it took, into out; *out_used receives how many
 * bytes it wrote, also on failure. All is decoded once *in_size is 0 and *out_used < out_size. A block comes
 * out when all of it has come in. */
eskel_status esk_bzip2_stream_decode(esk_bzip2_stream *stream, const uint8_t **in, size_t *in_size, uint8_t *out,
	size_t out_size, size_t *out_used, eskel_error *error);

/* Whether the stream's end has come and its checksums were right. */
bool esk_bzip2_stream_is_complete(const esk_bzip2_stream *stream);

#endif
