/* A sample of keys that depends on which there are and on nothing else, and changes little when they do: those with the
 * least hashes. */
#ifndef ESK_SAMPLE_H
#define ESK_SAMPLE_H

#include "eskel.h"

/* Writes at most so many of the keys, ascending; returns how many. O(n log most). */
size_t esk_sample_choose(const eskel_key_block *blocks, size_t block_count, size_t most, int64_t *keys);

#endif
