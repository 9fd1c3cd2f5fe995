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

static int64_t key_at(const esk_key_index *index, const esk_directory *directory, size_t at)
{
	return esk_directory_key(directory, index->places[at] - 1);
}

/* Where a number that is there lies. */
static size_t place_of(const esk_key_index *index, int64_t key, uint32_t id)
{
	size_t at = home(index, key);
	while (index->places[at] != id + 1)
		at = next(index, at);
	return at;
}

bool esk_key_index_find(const esk_key_index *index, const esk_directory *directory, int64_t key, uint32_t *id)
{
	if (index->count == 0)
		return false;
	for (size_t at = home(index, key); index->places[at]; at = next(index, at))
		if (key_at(index, directory, at) == key) {
			*id = index->places[at] - 1;
			return true;
		}
	return false;
}

void esk_key_index_insert(esk_key_index *index, int64_t key, uint32_t id)
{
	size_t at = home(index, key);
	while (index->places[at])
		at = next(index, at);
	index->places[at] = id + 1;
	index->count++;
}

bool esk_key_index_reserve(esk_key_index *index, const esk_directory *directory)
{
	if (2 * (index->count + 1) <= index->capacity)
		return true;
	esk_key_index grown = {.capacity = index->capacity ? 2 * index->capacity : 64};
	grown.places = esk_memory_zeroed_array(grown.capacity, sizeof *grown.places);
	if (!grown.places)
		return false;
	for (size_t at = 0; at < index->capacity; at++)
		if (index->places[at])
			esk_key_index_insert(&grown, key_at(index, directory, at), index->places[at] - 1);
	free(index->places);
	*index = grown;
	return true;
}

void esk_key_index_move(esk_key_index *index, int64_t key, uint32_t from, uint32_t to)
{
	index->places[place_of(index, key, from)] = to + 1;
}

/* Those after the gap that may not be reached across it move into it (Knuth, volume 3, 6.4, algorithm R). */
void esk_key_index_remove(esk_key_index *index, const esk_directory *directory, int64_t key, uint32_t id)
{
	const size_t mask = index->capacity - 1;
	size_t gap = place_of(index, key, id);
	for (size_t at = next(index, gap); index->places[at]; at = next(index, at)) {
		size_t from_home = (at - home(index, key_at(index, directory, at))) & mask;
		if (from_home >= ((at - gap) & mask)) {
			index->places[gap] = index->places[at];
			gap = at;
		}
	}
	index->places[gap] = 0;
	index->count--;
}

void esk_key_index_clear(esk_key_index *index)
{
	free(index->places);
	*index = (esk_key_index){0};
}
