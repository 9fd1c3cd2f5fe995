/* The order of numbers of 64 bits or more. */
#ifndef ESK_RADIX_H
#define ESK_RADIX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* At most so many words in an item. */
enum { esk_radix_most_words = 2 };

/* Sorts count < 2^32 items of so many words each; the first word counts most. O(count) for every byte in which items
 * differ. False when memory runs out. */
bool esk_radix_sort(uint64_t *items, size_t count, unsigned words);

#endif
