/* Sets of keys in blocks of 64 (eskel_library.h): a filter over a library is mostly a few bits a shape, not a key, to write and to
 * read, and keys that follow one another are found 64 at a time. */
#ifndef ESK_KEY_BLOCKS_H
#define ESK_KEY_BLOCKS_H

#include "eskel.h"

/* Which of up to 64 ascending keys are in the set, as bits. *at is a block before which the keys are not, 0 at first; it
 * becomes one for the keys that follow. */
uint64_t esk_key_blocks_find(
	const eskel_key_block *blocks, size_t block_count, size_t *at, const int64_t *keys, uint32_t count);

/* The same of keys that follow one another, from this one on. */
uint64_t esk_key_blocks_find_run(
	const eskel_key_block *blocks, size_t block_count, size_t *at, int64_t key, uint32_t count);

#endif
