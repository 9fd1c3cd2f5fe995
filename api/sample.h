/* A sample of keys that depends on which there are and on nothing else, and changes little when they do: those with the
 * least hashes. */
#ifndef ESK_SAMPLE_H
#define ESK_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

/* Moves at most so many of the keys, which are unique, to the front, ascending; returns how many. O(count log most). */
size_t esk_sample_choose(int64_t *keys, size_t count, size_t most);

#endif
