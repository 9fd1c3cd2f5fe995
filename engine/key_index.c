#include "key_index.h"

#include "memory.h"

#include <stdlib.h>

/* The high bits of a product with 2^64 / golden ratio: neighbouring keys land far apart. */
static size_t home(const esk_key_index *index, int64_t key)
{
	return (size_t)(((uint64_t)key * 0x9e3779b97f4a7c15) >> 20) & (index->capacity - 1);
}

static size_t next(const esk_key_index *index, size_t at)
{
	return (at + 1) & (index->capacity - 1);
}

esk_key_place *esk_key_index_find(const esk_key_index *index, int64_t key)
{
	if (index->count == 0)
		return NULL;
	for (size_t at = home(index, key); index->places[at].chunk; at = next(index, at))
		if (index->places[at].key == key)
			return &index->places[at];
	return NULL;
}

void esk_key_index_insert(esk_key_index *index, esk_key_place place)
{
	size_t at = home(index, place.key);
	while (index->places[at].chunk)
		at = next(index, at);
	index->places[at] = place;
	index->count++;
}

bool esk_key_index_reserve(esk_key_index *index)
{
	if (2 * (index->count + 1) <= index->capacity)
		return true;
	esk_key_index grown = {.capacity = index->capacity ? 2 * index->capacity : 64};
	grown.places = esk_memory_zeroed_array(grown.capacity, sizeof *grown.places);
	if (!grown.places)
		return false;
	for (size_t at = 0; at < index->capacity; at++)
		if (index->places[at].chunk)
			esk_key_index_insert(&grown, index->places[at]);
	free(index->places);
	*index = grown;
	return true;
}

/* Those after the gap that may not be reached across it move into it (Knuth, volume 3, 6.4, algorithm R). */
void esk_key_index_remove(esk_key_index *index, esk_key_place *place)
{
	const size_t mask = index->capacity - 1;
	size_t gap = (size_t)(place - index->places);
	for (size_t at = next(index, gap); index->places[at].chunk; at = next(index, at)) {
		size_t from_home = (at - home(index, index->places[at].key)) & mask;
		if (from_home >= ((at - gap) & mask)) {
			index->places[gap] = index->places[at];
			gap = at;
		}
	}
	index->places[gap] = (esk_key_place){0};
	index->count--;
}

void esk_key_index_clear(esk_key_index *index)
{
	free(index->places);
	*index = (esk_key_index){0};
}
