#include "memory.h"

#include <stdint.h>
#include <stdlib.h>

void *esk_memory_array(size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes))
		return NULL;
	return malloc(bytes ? bytes : 1);
}

void *esk_memory_zeroed_array(size_t count, size_t size)
{
	return calloc(count ? count : 1, size ? size : 1);
}

bool esk_memory_reserve(void **items, size_t *capacity, size_t needed, size_t size)
{
	if (needed <= *capacity)
		return true;
	size_t grown = *capacity + *capacity / 2;
	if (grown < needed)
		grown = needed;
	if (grown < 16)
		grown = 16;
	size_t bytes;
	if (__builtin_mul_overflow(grown, size, &bytes))
		return false;
	void *moved = realloc(*items, bytes);
	if (!moved)
		return false;
	*items = moved;
	*capacity = grown;
	return true;
}
