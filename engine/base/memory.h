/* Allocation with checked sizes, and arrays that grow. */
#ifndef ESK_MEMORY_H
#define ESK_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

/* NULL when count * size overflows or memory ran out; never NULL for a zero size. Not zeroed. free() it. */
void *esk_memory_array(size_t count, size_t size);
void *esk_memory_zeroed_array(size_t count, size_t size);

/* Makes room for at least needed elements of size bytes: *items may move, *capacity grows by half at least.
 * False, with both untouched, when memory ran out. */
bool esk_memory_reserve(void **items, size_t *capacity, size_t needed, size_t size);

#endif
