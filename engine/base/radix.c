/* Radix sort by bytes, the lowest first. One look at the items counts the values of all their bytes; then each byte in which
 * they differ takes a pass, which keeps the order of items that share its value. The high bytes of small numbers take none.
 */
#include "radix.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

enum { word_digits = 8, digit_values = 256, most_digits = word_digits * esk_radix_most_words };

/* Digit 0 is the lowest byte of an item's last word. */
static unsigned digit_of(const uint64_t *item, unsigned words, unsigned digit)
{
	return item[words - 1 - digit / word_digits] >> 8 * (digit % word_digits) & (digit_values - 1);
}

static void count_digits(
	const uint64_t *items, size_t count, unsigned words, uint32_t counts[most_digits][digit_values])
{
	for (size_t i = 0; i < count; i++)
		for (unsigned d = 0; d < word_digits * words; d++)
			counts[d][digit_of(items + i * words, words, d)]++;
}

static void distribute(const uint64_t *from, uint64_t *to, size_t count, unsigned words, unsigned digit,
	const uint32_t counts[digit_values])
{
	uint32_t places[digit_values], before = 0;
	for (unsigned v = 0; v < digit_values; v++) {
		places[v] = before;
		before += counts[v];
	}
	for (size_t i = 0; i < count; i++) {
		const uint64_t *item = from + i * words;
		uint64_t *place = to + (size_t)words * places[digit_of(item, words, digit)]++;
		for (unsigned w = 0; w < words; w++)
			place[w] = item[w];
	}
}

bool esk_radix_sort(uint64_t *items, size_t count, unsigned words)
{
	if (count < 2)
		return true;
	uint32_t counts[most_digits][digit_values] = {{0}};
	uint64_t *others = esk_memory_array(count, words * sizeof *others), *from = items, *to = others;
	if (!others)
		return false;
	count_digits(items, count, words, counts);
	for (unsigned d = 0; d < word_digits * words; d++) {
		if (counts[d][digit_of(items, words, d)] == count)
			continue; /* all share it */
		distribute(from, to, count, words, d, counts[d]);
		uint64_t *ordered = to;
		to = from;
		from = ordered;
	}
	if (from != items)
		memcpy(items, from, count * words * sizeof *items);
	free(others);
	return true;
}
