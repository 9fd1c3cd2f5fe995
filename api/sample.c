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

size_t esk_sample_choose(int64_t *keys, size_t count, size_t most)
{
	size_t sampled = count < most ? count : most;
	for (size_t i = sampled; i-- > 0;)
		sift_down(keys, sampled, i);
	for (size_t i = sampled; sampled > 0 && i < count; i++)
		if (hash(keys[i]) < hash(keys[0])) {
			keys[0] = keys[i];
			sift_down(keys, sampled, 0);
		}
	qsort(keys, sampled, sizeof *keys, compare_keys);
	return sampled;
}
