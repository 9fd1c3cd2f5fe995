/* Compressed data, decoded as they arrive, through a window. */
#ifndef ESK_DECOMPRESSOR_H
#define ESK_DECOMPRESSOR_H

#include "eskel.h"

typedef enum { ESK_COMPRESSION_GZIP, ESK_COMPRESSION_ZLIB, ESK_COMPRESSION_BZIP2 } esk_compression;

typedef struct esk_decompressor esk_decompressor;

eskel_status esk_decompressor_new(esk_compression compression, esk_decompressor **decompressor);
void esk_decompressor_free(esk_decompressor *decompressor);

/* Takes decoded bytes; a failure ends the decoding and is returned. */
typedef eskel_status esk_decompressor_taker(void *taker, const uint8_t *bytes, size_t size, eskel_error *error);

/* Decodes all bytes and hands on what comes out. That is done before a fault in them is reported, so it does not matter how
 * the data were cut. */
eskel_status esk_decompressor_feed(esk_decompressor *decompressor, const uint8_t *bytes, size_t size,
	esk_decompressor_taker *take, void *taker, eskel_error *error);

/* Whether the data have come to their end and their checksums were right. */
bool esk_decompressor_is_complete(const esk_decompressor *decompressor);

/* "gzip", "zlib" or "bzip2", static. */
const char *esk_decompressor_name(const esk_decompressor *decompressor);

#endif
