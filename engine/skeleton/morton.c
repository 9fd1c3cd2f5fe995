/* Eight segments that follow each other in the order of slices lie in a strip of eight rows; in Morton order, whose codes
 * take a bit of y and a bit of z in turn, they lie in a square, and so do any sixteen, and so on: fewer classes win near
 * them, and clustering takes four fifths of the time. */
#include "morton.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

/* Bit n goes to bit 2 n. */
static uint64_t spread(uint64_t bits)
{
	bits = (bits | bits << 8) & 0x00ff00ff;
	bits = (bits | bits << 4) & 0x0f0f0f0f;
	bits = (bits | bits << 2) & 0x33333333;
	return (bits | bits << 1) & 0x55555555;
}

/* |u| < 2^16 and all u along an axis have one parity, so 16 bits tell them apart. */
static uint64_t code_of(const esk_segment *s)
{
	return spread((uint32_t)(s->z + 65536) / 2) << 1 | spread((uint32_t)(s->y + 65536) / 2);
}

/* Sorts by one byte; equal ones stay in order. */
static void sort_by_byte(const uint64_t *keys, size_t count, int shift, uint64_t *sorted)
{
	size_t next[257] = {0};
	for (size_t i = 0; i < count; i++)
		next[(keys[i] >> shift & 0xff) + 1]++;
	for (int byte = 0; byte < 256; byte++)
		next[byte + 1] += next[byte];
	for (size_t i = 0; i < count; i++)
		sorted[next[keys[i] >> shift & 0xff]++] = keys[i];
}

/* Of a shape that stands upright the classes lie one on the other, and strips within slices meet fewer of them. */
static bool is_upright(const esk_segment *segments, size_t count)
{
	int32_t least[2] = {INT32_MAX, INT32_MAX}, greatest[2] = {INT32_MIN, INT32_MIN};
	for (size_t i = 0; i < count; i++) {
		const int32_t at[2] = {segments[i].y, segments[i].z};
		for (int r = 0; r < 2; r++) {
			least[r] = at[r] < least[r] ? at[r] : least[r];
			greatest[r] = at[r] > greatest[r] ? at[r] : greatest[r];
		}
	}
	return count && greatest[1] - least[1] > 2 * (greatest[0] - least[0]);
}

eskel_status esk_morton_sort(esk_segment *segments, size_t count)
{
	if (is_upright(segments, count))
		return ESKEL_OK;
	uint64_t *keys = esk_memory_array(count, sizeof *keys), *others = esk_memory_array(count, sizeof *others);
	esk_segment *sorted = esk_memory_array(count, sizeof *sorted);
	eskel_status status = ESKEL_NO_MEMORY;
	if (!keys || !others || !sorted)
		goto end;
	for (size_t i = 0; i < count; i++) /* the code above the index, which is below 2^32: most_spans */
		keys[i] = code_of(&segments[i]) << 32 | i;
	for (int shift = 32; shift < 64; shift += 16) {
		sort_by_byte(keys, count, shift, others);
		sort_by_byte(others, count, shift + 8, keys);
	}
	for (size_t i = 0; i < count; i++)
		sorted[i] = segments[keys[i] & UINT32_MAX];
	memcpy(segments, sorted, count * sizeof *segments);
	status = ESKEL_OK;
end:
	free(keys);
	free(others);
	free(sorted);
	return status;
}
