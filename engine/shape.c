#include "shape.h"

#include "lanes.h"
#include "memory.h"
#include "signature.h"

#include <stdlib.h>
#include <string.h>

/* Ranks are numbered like the floats. Those of levels of at most 16 classes take half a byte each. */
enum { HALF_BYTE_CLASSES = 16 };
#define HALF_BYTES (ESK_NUMBERS_MAX * ESKEL_NODES(HALF_BYTE_CLASSES))

static size_t rank_bytes(size_t rank_count)
{
	return rank_count <= HALF_BYTES ? (rank_count + 1) / 2 : HALF_BYTES / 2 + (rank_count - HALF_BYTES);
}

static const uint8_t *ranks_of(const esk_shape *shape)
{
	return (const uint8_t *)(shape->numbers + ESK_NUMBERS_MAX * ESKEL_NODES(shape->level_count));
}

static uint32_t half_byte(const uint8_t *ranks, size_t n)
{
	return (uint32_t)ranks[n / 2] >> 4 * (n % 2) & 15;
}

/* The bytes are zero before. */
static void put_rank(uint8_t *ranks, size_t n, uint32_t rank)
{
	if (n < HALF_BYTES)
		ranks[n / 2] = (uint8_t)(ranks[n / 2] | rank << 4 * (n % 2));
	else
		ranks[n - HALF_BYTES / 2] = (uint8_t)rank;
}

/* On the way to every matching, so the kind of rank is found outside the loop. */
void esk_shape_unsort(const esk_shape *shape, uint32_t level, const float *sorted, uint32_t row_count, float *rows)
{
	const uint8_t *ranks = ranks_of(shape);
	size_t n = ESK_NUMBERS_MAX * ESKEL_NODES(level - 1);
	const bool halves = level <= HALF_BYTE_CLASSES;
	for (uint32_t c = 0; c < row_count; c++, sorted += level, rows += level)
		for (uint32_t i = 0; i < level; i++, n++)
			rows[i] = sorted[halves ? half_byte(ranks, n) : ranks[n - HALF_BYTES / 2]];
}

/* Sorts one row and notes where each class went: a class's rank is how many go before it; of equal numbers the lower class
 * goes first. Counting compares every pair, but without a branch. */
static inline __attribute__((always_inline)) void put_row(
	float *row, uint8_t *ranks, size_t first, const float *numbers, size_t k)
{
	uint32_t rank_of[ESKEL_LEVELS_MAX] = {0};
	for (size_t j = 0; j < k; j++) {
		const float number = numbers[j];
		for (size_t i = 0; i < j; i++)
			rank_of[i] += number < numbers[i];
		for (size_t i = j; i < k; i++)
			rank_of[i] += number <= numbers[i];
	}
	for (size_t i = 0; i < k; i++) {
		row[rank_of[i] - 1] = numbers[i];
		put_rank(ranks, first + i, rank_of[i] - 1);
	}
}

static inline __attribute__((always_inline)) void put_level(
	esk_shape *shape, uint8_t *ranks, const eskel_signature *signature, double unit, uint32_t k)
{
	double(*rows)[ESKEL_SIGNATURE_NUMBERS] = signature->rows + ESKEL_NODES(k - 1);
	size_t at = ESK_NUMBERS_MAX * ESKEL_NODES(k - 1);
	for (size_t c = 0; c < ESK_NUMBERS_MAX; c++, at += k) {
		const double divisor = c < ESK_PAPER_NUMBERS ? unit : 1;
		float numbers[ESKEL_LEVELS_MAX];
		for (size_t i = 0; i < k; i++)
			numbers[i] = (float)esk_elementary_log(rows[i][c] / divisor + ESK_SHAPE_OFFSET);
		put_row(shape->numbers + at, ranks, at, numbers, k);
	}
}

size_t esk_shape_size(uint32_t level_count)
{
	const size_t numbers = ESK_NUMBERS_MAX * ESKEL_NODES(level_count);
	return sizeof(esk_shape) + numbers * sizeof(float) + rank_bytes(numbers);
}

ESK_EVERY_WIDTH void esk_shape_write(const eskel_signature *signature, esk_shape *shape)
{
	const double unit = esk_elementary_cbrt(signature->volume);
	const size_t numbers = ESK_NUMBERS_MAX * ESKEL_NODES(signature->level_count);
	uint8_t *ranks = (uint8_t *)(shape->numbers + numbers);
	memset(ranks, 0, rank_bytes(numbers));
	shape->level_count = signature->level_count;
	shape->log_volume = (float)esk_elementary_log(signature->volume);
	shape->scale = (float)unit;
	for (uint32_t k = 1; k <= signature->level_count; k++)
		put_level(shape, ranks, signature, unit, k);
}

eskel_status esk_shape_new(const eskel_signature *signature, esk_shape **shape)
{
	eskel_status status = esk_signature_check(signature, NULL);
	if (status != ESKEL_OK)
		return status;
	esk_shape *made = esk_memory_array(1, esk_shape_size(signature->level_count));
	if (!made)
		return ESKEL_NO_MEMORY;
	esk_shape_write(signature, made);
	*shape = made;
	return ESKEL_OK;
}

void esk_shape_release(esk_shape *shape)
{
	free(shape);
}

void esk_shape_lengths(const float *features, size_t count, float unit, float *lengths)
{
	for (size_t n = 0; n < count; n++)
		lengths[n] = esk_shape_length(features[n]) * unit;
}

void esk_shape_halves(const esk_shape *shape, eskel_signature_kind kind, uint32_t level, float *halves)
{
	const float *rows = esk_shape_sorted(shape, level);
	float lengths[ESK_PAPER_NUMBERS * ESKEL_LEVELS_MAX];
	if (kind == ESKEL_SIGNATURE_PAPER) {
		esk_shape_lengths(rows, (size_t)ESK_PAPER_NUMBERS * level, 1, lengths);
		rows = lengths;
	}
	for (uint32_t c = 0; c < esk_numbers(kind); c++, rows += level) {
		const double middle = level % 2 ? (double)rows[level / 2] / 2 : 0;
		double lower = middle, upper = middle;
		for (uint32_t i = 0; i < level / 2; i++) {
			lower += (double)rows[i];
			upper += (double)rows[level - 1 - i];
		}
		*halves++ = (float)(lower / level);
		*halves++ = (float)(upper / level);
	}
}
