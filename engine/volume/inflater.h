/* Deflated data (RFC 1951) inflated as they arrive, and the checksums that gzip and zlib keep of them. ISA-L does all
 * (inflater_isal.c), or zlib where the build found no ISA-L (inflater_zlib.c), more slowly. The two differ in bad data
 * alone: zlib refuses a block whose code leaves bit patterns without a meaning, ISA-L only data that use one; and ISA-L
 * may keep back the last two bytes before the end of what has arrived, which only shows where data break off. */
#ifndef ESK_INFLATER_H
#define ESK_INFLATER_H

#include "eskel.h"

typedef struct esk_inflater esk_inflater;

eskel_status esk_inflater_new(esk_inflater **inflater);
void esk_inflater_free(esk_inflater *inflater);

/* Before each stream. */
void esk_inflater_begin(esk_inflater *inflater);

/* Inflates some of the *in_size bytes at *in, which it moves past what it took, into out; *out_used receives how many
 * bytes it wrote, also on failure: all that come before the fault. *ended: the stream is complete, and *in stands behind
 * it. Otherwise all input is taken, or all of out is written. ESKEL_MALFORMED or ESKEL_NO_MEMORY, without a sentence. */
eskel_status esk_inflater_run(esk_inflater *inflater, const uint8_t **in, size_t *in_size, uint8_t *out,
	size_t out_size, size_t *out_used, bool *ended);

/* The CRC-32 of some bytes followed by size more, given that of the former (0 for none). */
uint32_t esk_inflater_crc32(uint32_t crc, const uint8_t *bytes, size_t size);
/* The same for the Adler-32 (1 for none). */
uint32_t esk_inflater_adler32(uint32_t adler, const uint8_t *bytes, size_t size);

#endif
