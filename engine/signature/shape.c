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

/* A level on its way to be sorted. What lies beyond its classes is compared with them and goes nowhere. */
enum { COMPARED = 8 };
typedef struct {
	float numbers[ESK_NUMBERS_MAX][ESKEL_LEVELS_MAX];
	int32_t less[ESK_NUMBERS_MAX][ESKEL_LEVELS_MAX]; /* so many are less */
} unsorted_level;

/* Compares every pair, but without a branch. */
static inline __attribute__((always_inline)) void count_less(unsorted_level *level, size_t k)
{
	for (size_t begin = 0; begin < k; begin += COMPARED)
#pragma omp simd
		for (size_t l = begin; l < begin + COMPARED; l++) {
			int32_t less[ESK_NUMBERS_MAX] = {0};
			for (size_t j = 0; j < k; j++)
				for (size_t c = 0; c < ESK_NUMBERS_MAX; c++)
					less[c] += level->numbers[c][j] < level->numbers[c][l];
			for (size_t c = 0; c < ESK_NUMBERS_MAX; c++)
				level->less[c][l] = less[c];
		}
}

/* The five rows of a level, from its classes' features one after the other. A class's rank is how many go before it; of
 * equal numbers the lower class goes first. */
static inline __attribute__((always_inline)) void put_level(
	unsorted_level *level, const float *features, size_t k, float *sorted, uint8_t *ranks)
{
	uint8_t equal[ESK_NUMBERS_MAX][ESKEL_LEVELS_MAX] = {{0}}; /* so many of them have been put */
	for (size_t i = 0; i < k; i++)
		for (size_t c = 0; c < ESK_NUMBERS_MAX; c++)
			level->numbers[c][i] = features[i * ESK_NUMBERS_MAX + c];
	count_less(level, k);
	for (size_t i = 0; i < k; i++)
		for (size_t c = 0; c < ESK_NUMBERS_MAX; c++) {
			const size_t less = (size_t)level->less[c][i], rank = less + equal[c][less]++;
			sorted[c * k + rank] = level->numbers[c][i];
			ranks[c * k + i] = (uint8_t)rank;
		}
}

/* All numbers of a signature in its own order, eight classes at a time for whole vectors of any width. */
static inline __attribute__((always_inline)) void take_logarithms(
	const double *numbers, size_t count, double unit, float *features)
{
	enum { BLOCK = 8 * ESK_NUMBERS_MAX };
	double divisors[BLOCK];
	for (size_t i = 0; i < BLOCK; i++)
		divisors[i] = i % ESK_NUMBERS_MAX < ESK_PAPER_NUMBERS ? unit : 1;
	for (size_t n = 0; n < count; n += BLOCK) {
		const size_t size = count - n < BLOCK ? count - n : BLOCK;
		for (size_t i = 0; i < size; i++)
			features[n + i] = (float)esk_elementary_log(numbers[n + i] / divisors[i] + ESK_SHAPE_OFFSET);
	}
}

static inline __attribute__((always_inline)) void pack_ranks(const uint8_t *ranks, size_t count, uint8_t *packed)
{
	const size_t halves = count < HALF_BYTES ? count : HALF_BYTES;
	for (size_t n = 0; n < halves / 2; n++)
		packed[n] = (uint8_t)(ranks[2 * n] | ranks[2 * n + 1] << 4);
	if (halves % 2)
		packed[halves / 2] = ranks[halves - 1];
	memcpy(packed + HALF_BYTES / 2, ranks + halves, count - halves);
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
	float features[ESK_NUMBERS_MAX * ESKEL_NODES(ESKEL_LEVELS_MAX)];
	uint8_t ranks[ESK_NUMBERS_MAX * ESKEL_NODES(ESKEL_LEVELS_MAX)];
	unsorted_level level = {0};
	shape->level_count = signature->level_count;
	shape->log_volume = (float)esk_elementary_log(signature->volume);
	shape->scale = (float)unit;
	take_logarithms(signature->rows[0], numbers, unit, features);
	for (size_t k = 1; k <= signature->level_count; k++) {
		const size_t at = ESK_NUMBERS_MAX * ESKEL_NODES(k - 1);
		put_level(&level, features + at, k, shape->numbers + at, ranks + at);
	}
	pack_ranks(ranks, numbers, (uint8_t *)(shape->numbers + numbers));
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

ESK_EVERY_WIDTH void esk_shape_lengths(const float *features, size_t count, float unit, float *lengths)
{
	for (size_t n = 0; n < count; n++)
		lengths[n] = esk_shape_length(features[n]) * unit;
}

static inline __attribute__((always_inline)) void sum_halves(
	const float *rows, size_t numbers, size_t level, double *sums)
{
	double lower[ESK_NUMBERS_MAX], upper[ESK_NUMBERS_MAX];
	for (size_t c = 0; c < numbers; c++)
		lower[c] = upper[c] = level % 2 ? (double)rows[c * level + level / 2] / 2 : 0;
	for (size_t i = 0; i < level / 2; i++)
		for (size_t c = 0; c < numbers; c++) {
			lower[c] += (double)rows[c * level + i];
			upper[c] += (double)rows[c * level + level - 1 - i];
		}
	for (size_t c = 0; c < numbers; c++) {
		sums[2 * c] = lower[c];
		sums[2 * c + 1] = upper[c];
	}
}

void esk_shape_half_sums(const float *rows, eskel_signature_kind kind, uint32_t level, double *sums)
{
	if (kind == ESKEL_SIGNATURE_PAPER)
		sum_halves(rows, ESK_PAPER_NUMBERS, level, sums);
	else
		sum_halves(rows, ESK_NUMBERS_MAX, level, sums);
}

void esk_shape_halves(const esk_shape *shape, eskel_signature_kind kind, uint32_t level, float *halves)
{
	const float *rows = esk_shape_sorted(shape, level);
	float lengths[ESK_PAPER_NUMBERS * ESKEL_LEVELS_MAX];
	double sums[2 * ESK_NUMBERS_MAX];
	if (kind == ESKEL_SIGNATURE_PAPER) {
		esk_shape_lengths(rows, (size_t)ESK_PAPER_NUMBERS * level, 1, lengths);
		rows = lengths;
	}
	esk_shape_half_sums(rows, kind, level, sums);
	for (uint32_t h = 0; h < 2 * esk_numbers(kind); h++)
		halves[h] = (float)(sums[h] / level);
}
