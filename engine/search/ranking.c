#include "ranking.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void swap(esk_ranked *a, esk_ranked *b)
{
	esk_ranked held = *a;
	*a = *b;
	*b = held;
}

/* Orders three places of all, so that the median ends in the middle. */
static esk_ranked median_of_three(esk_ranked *all, size_t n)
{
	esk_ranked *low = all, *middle = all + (n - 1) / 2, *high = all + n - 1;
	if (esk_ranked_before(middle, low))
		swap(middle, low);
	if (esk_ranked_before(high, middle))
		swap(high, middle);
	if (esk_ranked_before(middle, low))
		swap(middle, low);
	return *middle;
}

/* Hoare's quickselect. */
void esk_ranked_select(esk_ranked *all, size_t n, size_t count)
{
	while (count > 0 && count < n) {
		const esk_ranked pivot = median_of_three(all, n);
		size_t left = 0, right = n - 1;
		for (;;) {
			while (esk_ranked_before(&all[left], &pivot))
				left++;
			while (esk_ranked_before(&pivot, &all[right]))
				right--;
			if (left >= right)
				break;
			swap(&all[left++], &all[right--]);
		}
		/* None up to right comes after the pivot, none after right comes before it, and neither part is empty:
		 * the median of three was not the last. */
		size_t front = right + 1;
		if (count < front) {
			n = front;
		} else {
			all += front;
			n -= front;
			count -= front;
		}
	}
}

const esk_ranked *esk_ranked_last(const esk_ranked *all, size_t n)
{
	const esk_ranked *last = all;
	for (size_t i = 1; i < n; i++)
		if (esk_ranked_before(last, &all[i]))
			last = &all[i];
	return last;
}

/* By digits from the most significant on: the bits of floats that are not negative order as they do. Few share the first
 * digit, so that the others cost little. */
float esk_candidates_nth(const esk_candidate *all, size_t count, size_t n)
{
	static const uint32_t shifts[] = {20, 10, 0}, digits[] = {1 << 11, 1 << 10, 1 << 10};
	uint32_t counts[1 << 11], found = 0, known = 0;
	for (int d = 0; d < 3; d++) {
		memset(counts, 0, digits[d] * sizeof *counts);
		for (size_t i = 0; i < count; i++) {
			uint32_t bits;
			memcpy(&bits, &all[i].lower, sizeof bits);
			if ((bits & known) == found)
				counts[bits >> shifts[d] & (digits[d] - 1)]++;
		}
		uint32_t digit = 0;
		while (n >= counts[digit])
			n -= counts[digit++];
		found |= digit << shifts[d];
		known |= (digits[d] - 1) << shifts[d];
	}
	float lower;
	memcpy(&lower, &found, sizeof lower);
	return lower;
}

static int compare(const void *a, const void *b)
{
	return esk_ranked_before(a, b) ? -1 : esk_ranked_before(b, a);
}

void esk_ranked_sort(esk_ranked *all, size_t n)
{
	if (n > 1)
		qsort(all, n, sizeof *all, compare);
}

bool esk_nearest_init(esk_nearest *nearest, size_t wanted)
{
	esk_ranked *items = esk_memory_array(wanted, sizeof *items);
	if (!items)
		return false;
	*nearest = (esk_nearest){.items = items, .wanted = wanted};
	return true;
}

void esk_nearest_clear(esk_nearest *nearest)
{
	free(nearest->items);
	*nearest = (esk_nearest){0};
}

static void sift_up(esk_ranked *heap, size_t at)
{
	for (; at > 0 && esk_ranked_before(&heap[(at - 1) / 2], &heap[at]); at = (at - 1) / 2)
		swap(&heap[(at - 1) / 2], &heap[at]);
}

static void sift_down(esk_ranked *heap, size_t count)
{
	for (size_t at = 0, child; (child = 2 * at + 1) < count; at = child) {
		if (child + 1 < count && esk_ranked_before(&heap[child], &heap[child + 1]))
			child++;
		if (!esk_ranked_before(&heap[at], &heap[child]))
			break;
		swap(&heap[at], &heap[child]);
	}
}

void esk_nearest_offer(esk_nearest *nearest, esk_ranked candidate)
{
	if (nearest->count < nearest->wanted) {
		nearest->items[nearest->count] = candidate;
		sift_up(nearest->items, nearest->count++);
	} else if (esk_ranked_before(&candidate, &nearest->items[0])) {
		nearest->items[0] = candidate;
		sift_down(nearest->items, nearest->count);
	}
}

bool esk_nearest_takes(const esk_nearest *nearest, const esk_ranked *candidate, uint32_t *row)
{
	const bool full = nearest->count == nearest->wanted;
	if (full && !esk_ranked_before(candidate, &nearest->items[0]))
		return false;
	*row = full ? nearest->items[0].row : (uint32_t)nearest->count;
	return true;
}

double esk_nearest_threshold(const esk_nearest *nearest)
{
	return nearest->count < nearest->wanted ? (double)INFINITY : nearest->items[0].distance;
}
