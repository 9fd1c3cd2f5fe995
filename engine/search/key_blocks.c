#include "key_blocks.h"

enum { BITS = 64 };

/* The first key of the block that holds this one: the next multiple of 64 below, also for negative keys. */
static int64_t first_of(int64_t key)
{
	return (int64_t)((uint64_t)key / BITS * BITS);
}

static unsigned place_of(int64_t key)
{
	return (unsigned)((uint64_t)key % BITS);
}

static size_t add_block(eskel_key_block *blocks, size_t count, int64_t first, uint64_t members)
{
	if (members == 0)
		return count;
	if (count == 0 || blocks[count - 1].first != first)
		blocks[count++] = (eskel_key_block){first, 0};
	blocks[count - 1].members |= members;
	return count;
}

size_t eskel_key_blocks_add(eskel_key_block *blocks, size_t count, int64_t key, uint64_t members)
{
	const int64_t first = first_of(key);
	const unsigned place = place_of(key);
	count = add_block(blocks, count, first, members << place);
	if (place > 0)
		count = add_block(blocks, count, (int64_t)((uint64_t)first + BITS), members >> (BITS - place));
	return count;
}

/* The first block from begin on that is not before the one that begins with first. It gallops, because that is mostly near. */
static size_t advance(const eskel_key_block *blocks, size_t count, size_t begin, int64_t first)
{
	size_t low = begin, step = 1;
	while (step <= count - low && blocks[low + step - 1].first < first) {
		low += step;
		step *= 2;
	}
	size_t high = step <= count - low ? low + step - 1 : count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (blocks[middle].first < first)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static uint64_t members_of(const eskel_key_block *blocks, size_t count, size_t *at, int64_t first)
{
	*at = advance(blocks, count, *at, first);
	return *at < count && blocks[*at].first == first ? blocks[*at].members : 0;
}

/* In the block of the first, or also in the one that follows. */
uint64_t esk_key_blocks_find_run(
	const eskel_key_block *blocks, size_t block_count, size_t *at, int64_t key, uint32_t count)
{
	const int64_t first = first_of(key);
	const unsigned place = place_of(key);
	uint64_t found = members_of(blocks, block_count, at, first) >> place;
	if (place + count > BITS)
		found |= members_of(blocks, block_count, at, (int64_t)((uint64_t)first + BITS)) << (BITS - place);
	return found & UINT64_MAX >> (BITS - count);
}

uint64_t esk_key_blocks_find(
	const eskel_key_block *blocks, size_t block_count, size_t *at, const int64_t *keys, uint32_t count)
{
	if ((uint64_t)keys[count - 1] - (uint64_t)keys[0] == count - 1)
		return esk_key_blocks_find_run(blocks, block_count, at, keys[0], count);
	uint64_t found = 0;
	for (uint32_t i = 0; i < count; i++)
		found |= (members_of(blocks, block_count, at, first_of(keys[i])) >> place_of(keys[i]) & 1) << i;
	return found;
}
