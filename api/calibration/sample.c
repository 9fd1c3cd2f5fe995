/* The keys with the least hashes, see sample.h. */
#include "sample.h"

#include <stdlib.h>

/* A bijection without any pattern that keys could have (the finaliser of SplitMix64). */
static uint64_t hash(int64_t key)
{
	uint64_t h = (uint64_t)key + UINT64_C(0x9e3779b97f4a7c15);
	h = (h ^ h >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
	h = (h ^ h >> 27) * UINT64_C(0x94d049bb133111eb);
	return h ^ h >> 31;
}

static int compare_keys(const void *a, const void *b)
{
	int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
	return (x > y) - (x < y);
}

/* The key with the largest hash is on top. */
static void sift_down(int64_t *heap, size_t count, size_t i)
{
	for (size_t child; (child = 2 * i + 1) < count; i = child) {
		if (child + 1 < count && hash(heap[child + 1]) > hash(heap[child]))
			child++;
		if (hash(heap[i]) >= hash(heap[child]))
			return;
		int64_t swapped = heap[i];
		heap[i] = heap[child];
		heap[child] = swapped;
	}
}

/* A heap of the keys sampled so far. */
typedef struct {
	int64_t *keys;
	size_t count, most;
} sample;

static void offer(sample *s, int64_t key)
{
	if (s->count < s->most) {
		s->keys[s->count++] = key;
		for (size_t i = s->count == s->most ? s->most / 2 : 0; i-- > 0;) /* the heap is made when it is full */
			sift_down(s->keys, s->count, i);
	} else if (s->most > 0 && hash(key) < hash(s->keys[0])) {
		s->keys[0] = key;
		sift_down(s->keys, s->count, 0);
	}
}

size_t esk_sample_choose(const eskel_key_block *blocks, size_t block_count, size_t most, int64_t *keys)
{
	sample s = {.keys = keys, .most = most};
	for (size_t b = 0; b < block_count; b++)
		for (uint64_t members = blocks[b].members; members; members &= members - 1)
			offer(&s, blocks[b].first + __builtin_ctzll(members));
	qsort(keys, s.count, sizeof *keys, compare_keys);
	return s.count;
}
