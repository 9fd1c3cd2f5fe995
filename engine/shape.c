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

static uint32_t get_rank(const uint8_t *ranks, size_t n)
{
	return n < HALF_BYTES ? (uint32_t)ranks[n / 2] >> 4 * (n % 2) & 15 : ranks[n - HALF_BYTES / 2];
}

/* The bytes are zero before. */
static void put_rank(uint8_t *ranks, size_t n, uint32_t rank)
{
	if (n < HALF_BYTES)
		ranks[n / 2] = (uint8_t)(ranks[n / 2] | rank << 4 * (n % 2));
	else
		ranks[n - HALF_BYTES / 2] = (uint8_t)rank;
}

void esk_shape_unsort(const esk_shape *shape, uint32_t level, const float *sorted, uint32_t row_count, float *rows)
{
	size_t n = ESK_NUMBERS_MAX * ESKEL_NODES(level - 1);
	for (uint32_t c = 0; c < row_count; c++)
		for (uint32_t i = 0; i < level; i++)
			rows[c * level + i] = sorted[c * level + get_rank(shape->ranks, n++)];
}

/* Sorts one row and notes where each class went; of equal numbers the lower class goes first. */
static void put_row(esk_shape *shape, size_t first, const float *numbers, uint32_t k)
{
	uint32_t class_of[ESKEL_LEVELS_MAX];
	for (uint32_t i = 0; i < k; i++) {
		uint32_t at = i;
		for (; at > 0 && numbers[class_of[at - 1]] > numbers[i]; at--)
			class_of[at] = class_of[at - 1];
		class_of[at] = i;
	}
	for (uint32_t rank = 0; rank < k; rank++) {
		shape->numbers[first + rank] = numbers[class_of[rank]];
		put_rank(shape->ranks, first + class_of[rank], rank);
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
		put_row(shape, at, numbers, k);
	}
}

eskel_status esk_shape_new(const eskel_signature *signature, esk_shape **shape)
{
	eskel_status status = esk_signature_check(signature, NULL);
	if (status != ESKEL_OK)
		return status;
	const size_t floats = ESK_NUMBERS_MAX * ESKEL_NODES(signature->level_count);
	const size_t before = (sizeof(esk_shape) + rank_bytes(floats) + sizeof(float) - 1) / sizeof(float);
	esk_shape *made = esk_memory_zeroed_array(before + floats, sizeof(float));
	if (!made)
		return ESKEL_NO_MEMORY;
	const double unit = esk_elementary_cbrt(signature->volume);
	atomic_init(&made->references, 1);
	made->level_count = signature->level_count;
	made->log_volume = (float)esk_elementary_log(signature->volume);
	made->scale = (float)unit;
	made->numbers = (float *)made + before;
	for (uint32_t k = 1; k <= signature->level_count; k++)
		put_level(made, signature, unit, k);
	*shape = made;
	return ESKEL_OK;
}

esk_shape *esk_shape_hold(esk_shape *shape)
{
	atomic_fetch_add_explicit(&shape->references, 1, memory_order_relaxed);
	return shape;
}

void esk_shape_release(esk_shape *shape)
{
	if (shape && atomic_fetch_sub_explicit(&shape->references, 1, memory_order_acq_rel) == 1)
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

void esk_shape_level_means(const esk_shape *shape, eskel_signature_kind kind, float *means)
{
	const uint32_t numbers = esk_numbers(kind);
	memset(means, 0, ESK_SUMMED_LEVELS * numbers * sizeof *means);
	for (uint32_t k = 1; k <= shape->level_count && k <= ESK_SUMMED_LEVELS; k++) {
		const float *rows = esk_shape_sorted(shape, k);
		float lengths[ESK_PAPER_NUMBERS * ESK_SUMMED_LEVELS];
		if (kind == ESKEL_SIGNATURE_PAPER) {
			esk_shape_lengths(rows, (size_t)numbers * k, 1, lengths);
			rows = lengths;
		}
		for (uint32_t c = 0; c < numbers; c++) {
			double sum = 0;
			for (uint32_t i = 0; i < k; i++)
				sum += (double)rows[c * k + i];
			*means++ = (float)(sum / k);
		}
	}
}
