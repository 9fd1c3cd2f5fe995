/* Volumes decoded from memory, in pieces, for tests. */
#ifndef VOLUME_DECODE_H
#define VOLUME_DECODE_H

#include "eskel.h"

/* Feeds the bytes in pieces of so many and finishes. *volume is NULL after a failure. */
eskel_status volume_decode(const void *bytes, size_t size, size_t piece, const eskel_volume_options *options,
	eskel_volume **volume, eskel_error *error);

#endif
