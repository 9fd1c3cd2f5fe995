#include "shape.h"

#include "elementary.h"
#include "memory.h"
#include "signature.h"

#include <stdlib.h>
#include <string.h>

/* Keeps the logarithm of a flat class's zero finite. Distances barely depend on it: anything from 0.005 to 0.1 ranks
 * shapes alike. */
static const double offset = 0.02;

/* Ranks are numbered like the floats. Those of levels of at most 16 classes take half a byte each. */
enum { HALF_BYTE_CLASSES = 16 };
#define HALF_BYTES (ESK_NUMBERS_MAX * ESKEL_NODES(HALF_BYTE_CLASSES))

static size_t rank_bytes(size_t rank_count)
{
	return rank_count <= HALF_BYTES ? (rank_count + 1) / 2 : HALF_BYTES / 2 + (rank_count - HALF_BYTES);
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
	size_t n = ESK_NUMBERS_MAX * ESKEL_NODES(level - 1);
	const bool halves = level <= HALF_BYTE_CLASSES;
	for (uint32_t c = 0; c < row_count; c++, sorted += level, rows += level)
		for (uint32_t i = 0; i < level; i++, n++)
			rows[i] = sorted[halves ? half_byte(shape->ranks, n) : shape->ranks[n - HALF_BYTES / 2]];
}

/* Sorts one row and notes where each class went: a class's rank is how many go before it; of equal numbers the lower class
 * goes first. Counting compares every pair, but without a branch. */
static void put_row(float *row, uint8_t *ranks, size_t first, const float *numbers, uint32_t k)
{
	uint32_t rank_of[ESKEL_LEVELS_MAX] = {0};
	for (uint32_t j = 0; j < k; j++) {
		const float number = numbers[j];
		for (uint32_t i = 0; i < j; i++)
			rank_of[i] += number < numbers[i];
		for (uint32_t i = j; i < k; i++)
			rank_of[i] += number <= numbers[i];
	}
	for (uint32_t i = 0; i < k; i++) {
		row[rank_of[i] - 1] = numbers[i];
		put_rank(ranks, first + i, rank_of[i] - 1);
	}
}

static void put_level(esk_shape *shape, const eskel_signature *signature, double unit, uint32_t k)
{
	double(*rows)[ESKEL_SIGNATURE_NUMBERS] = signature->rows + ESKEL_NODES(k - 1);
	size_t at = ESK_NUMBERS_MAX * ESKEL_NODES(k - 1);
	for (uint32_t c = 0; c < ESK_NUMBERS_MAX; c++, at += k) {
		float numbers[ESKEL_LEVELS_MAX];
		for (uint32_t i = 0; i < k; i++) {
			double number = c < ESK_PAPER_NUMBERS ? rows[i][c] / unit : rows[i][c];
			numbers[i] = (float)esk_elementary_log(number + offset);
		}
		put_row((float *)(void *)shape + shape->numbers + at, shape->ranks, at, numbers, k);
	}
}

/* In floats. */
static size_t size_before_numbers(uint32_t level_count)
{
	const size_t ranks = rank_bytes(ESK_NUMBERS_MAX * ESKEL_NODES(level_count));
	return (sizeof(esk_shape) + ranks + sizeof(float) - 1) / sizeof(float);
}

size_t esk_shape_size(uint32_t level_count)
{
	return (size_before_numbers(level_count) + ESK_NUMBERS_MAX * ESKEL_NODES(level_count)) * sizeof(float);
}

void esk_shape_write(const eskel_signature *signature, esk_shape *shape)
{
	const double unit = esk_elementary_cbrt(signature->volume);
	memset(shape->ranks, 0, rank_bytes(ESK_NUMBERS_MAX * ESKEL_NODES(signature->level_count)));
	shape->level_count = signature->level_count;
	shape->log_volume = (float)esk_elementary_log(signature->volume);
	shape->scale = (float)unit;
	shape->numbers = (uint32_t)size_before_numbers(signature->level_count);
	for (uint32_t k = 1; k <= signature->level_count; k++)
		put_level(shape, signature, unit, k);
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
	for (size_t n = 0; n < count; n++) {
		float length = esk_elementary_exp(features[n]) - (float)offset;
		/* Below 1e-8 the difference is the rounding of a zero. */
		lengths[n] = (length > 1e-8f ? length : 0) * unit;
	}
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
