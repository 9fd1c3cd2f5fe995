/* Arrays that grow by one. */
#ifndef ESK_ARRAY_H
#define ESK_ARRAY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

/* Makes room for one element more than count. The capacity is the power of two that holds count, so it need not be
 * kept. False, with *items untouched, when memory ran out. */
static inline bool esk_array_grow(void **items, size_t count, size_t size)
{
	if (count & (count - 1))
		return true;
	size_t bytes;
	if (__builtin_mul_overflow(count ? 2 * count : 1, size, &bytes))
		return false;
	void *moved = realloc(*items, bytes);
	if (!moved)
		return false;
	*items = moved;
	return true;
}

#endif
