#include "feature_columns.h"

#include "elementary.h"
#include "memory.h"
#include "signature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Keeps the logarithm of a flat class's zero finite. Distances barely depend on it: anything from 0.005 to 0.1 ranks
 * shapes alike. */
static const double offset = 0.02;

void esk_columns_free(esk_columns *columns)
{
	if (!columns)
		return;
	free(columns->level_counts);
	free(columns->log_volumes);
	free(columns->scales);
	for (int k = 0; k < ESKEL_LEVELS_MAX; k++) {
		free(columns->levels[k]);
		free(columns->ranks[k]);
	}
	for (int kind = 0; kind < 2; kind++) {
		free(columns->level_means[kind]);
		free(columns->total_means[kind]);
	}
	free(columns);
}

eskel_status esk_columns_new(uint32_t capacity, esk_columns **columns)
{
	esk_columns *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	made->capacity = capacity;
	made->level_counts = esk_memory_array(capacity, sizeof *made->level_counts);
	made->log_volumes = esk_memory_array(capacity, sizeof(float));
	made->scales = esk_memory_array(capacity, sizeof(float));
	bool complete = made->level_counts && made->log_volumes && made->scales;
	for (int kind = 0; kind < 2; kind++) {
		size_t numbers = esk_numbers((eskel_signature_kind)kind);
		made->level_means[kind] = esk_memory_array(capacity, numbers * ESK_SUMMED_LEVELS * sizeof(float));
		made->total_means[kind] = esk_memory_array(capacity, numbers * sizeof(float));
		complete = complete && made->level_means[kind] && made->total_means[kind];
	}
	if (!complete) {
		esk_columns_free(made);
		return ESKEL_NO_MEMORY;
	}
	*columns = made;
	return ESKEL_OK;
}

/* Ranks up to 16 classes take half a byte each. */
static size_t rank_bytes(uint32_t k)
{
	return k <= 16 ? (ESK_NUMBERS_MAX * k + 1) / 2 : ESK_NUMBERS_MAX * k;
}

static uint32_t get_rank(const uint8_t *ranks, uint32_t k, uint32_t index)
{
	return k <= 16 ? (uint32_t)ranks[index / 2] >> 4 * (index % 2) & 15 : ranks[index];
}

/* The half bytes are zero before. */
static void put_rank(uint8_t *ranks, uint32_t k, uint32_t index, uint32_t rank)
{
	if (k <= 16)
		ranks[index / 2] = (uint8_t)(ranks[index / 2] | rank << 4 * (index % 2));
	else
		ranks[index] = (uint8_t)rank;
}

/* Pointers are set once, before any shape with the level can be seen, and read by those who saw one. */
static eskel_status make_levels(esk_columns *columns, uint32_t level_count)
{
	for (uint32_t k = 1; k <= level_count; k++) {
		if (!columns->levels[k - 1])
			columns->levels[k - 1] =
				esk_memory_array(columns->capacity, ESK_NUMBERS_MAX * k * sizeof(float));
		if (!columns->ranks[k - 1])
			columns->ranks[k - 1] = esk_memory_array(columns->capacity, rank_bytes(k));
		if (!columns->levels[k - 1] || !columns->ranks[k - 1])
			return ESKEL_NO_MEMORY;
	}
	return ESKEL_OK;
}

void esk_features_lengths(const float *features, size_t count, float unit, float *lengths)
{
	for (size_t n = 0; n < count; n++) {
		float length = esk_elementary_exp(features[n]) - (float)offset;
		/* Below 1e-8 the difference is the rounding of a zero. */
		lengths[n] = length > 1e-8f ? length * unit : 0;
	}
}

void esk_shape_unsort(esk_shape shape, uint32_t level, const float *sorted, uint32_t row_count, float *rows)
{
	const uint8_t *ranks = shape.columns->ranks[level - 1] + shape.slot * rank_bytes(level);
	for (uint32_t c = 0; c < row_count; c++)
		for (uint32_t i = 0; i < level; i++)
			rows[c * level + i] = sorted[c * level + get_rank(ranks, level, c * level + i)];
}

/* Sorts one row and notes where each class went; of equal numbers the lower class goes first. */
static void put_row(const float *numbers, uint32_t k, float *sorted, uint8_t *ranks, uint32_t c)
{
	uint32_t class_of[ESKEL_LEVELS_MAX];
	for (uint32_t i = 0; i < k; i++) {
		uint32_t at = i;
		for (; at > 0 && numbers[class_of[at - 1]] > numbers[i]; at--)
			class_of[at] = class_of[at - 1];
		class_of[at] = i;
	}
	for (uint32_t rank = 0; rank < k; rank++) {
		sorted[rank] = numbers[class_of[rank]];
		put_rank(ranks, k, c * k + class_of[rank], rank);
	}
}

static void put_level(esk_columns *columns, uint32_t slot, const eskel_signature *signature, double unit, uint32_t k)
{
	double(*rows)[ESKEL_SIGNATURE_NUMBERS] = signature->rows + ESKEL_NODES(k - 1);
	float *sorted = columns->levels[k - 1] + (size_t)slot * ESK_NUMBERS_MAX * k;
	uint8_t *ranks = columns->ranks[k - 1] + slot * rank_bytes(k);
	memset(ranks, 0, rank_bytes(k));
	for (uint32_t c = 0; c < ESK_NUMBERS_MAX; c++) {
		float numbers[ESKEL_LEVELS_MAX];
		for (uint32_t i = 0; i < k; i++) {
			double number = c < ESK_PAPER_NUMBERS ? rows[i][c] / unit : rows[i][c];
			numbers[i] = (float)esk_elementary_log(number + offset);
		}
		put_row(numbers, k, sorted + c * k, ranks, c);
	}
}

static void put_means(esk_columns *columns, uint32_t slot, eskel_signature_kind kind)
{
	const esk_shape shape = {columns, slot};
	uint32_t numbers = esk_numbers(kind), depth = esk_shape_level_count(shape);
	if (depth > ESK_SUMMED_LEVELS)
		depth = ESK_SUMMED_LEVELS;
	double totals[ESK_NUMBERS_MAX] = {0};
	float *means = columns->level_means[kind] + (size_t)slot * ESK_SUMMED_LEVELS * numbers;
	memset(means, 0, ESK_SUMMED_LEVELS * numbers * sizeof *means);
	for (uint32_t k = 1; k <= depth; k++, means += numbers) {
		const float *rows = esk_shape_sorted(shape, k);
		float lengths[ESK_PAPER_NUMBERS * ESK_SUMMED_LEVELS];
		if (kind == ESKEL_SIGNATURE_PAPER) {
			esk_features_lengths(rows, (size_t)numbers * k, 1, lengths);
			rows = lengths;
		}
		for (uint32_t c = 0; c < numbers; c++) {
			double sum = 0;
			for (uint32_t i = 0; i < k; i++)
				sum += (double)rows[c * k + i];
			means[c] = (float)(sum / k);
			totals[c] += sum / k;
		}
	}
	for (uint32_t c = 0; c < numbers; c++)
		columns->total_means[kind][c * columns->capacity + slot] = (float)(totals[c] / depth);
}

eskel_status esk_columns_put(esk_columns *columns, uint32_t slot, const eskel_signature *signature)
{
	eskel_status status = esk_signature_check(signature, NULL);
	if (status == ESKEL_OK)
		status = make_levels(columns, signature->level_count);
	if (status != ESKEL_OK)
		return status;
	double unit = esk_elementary_cbrt(signature->volume);
	columns->level_counts[slot] = (uint8_t)signature->level_count;
	columns->log_volumes[slot] = (float)esk_elementary_log(signature->volume);
	columns->scales[slot] = (float)unit;
	for (uint32_t k = 1; k <= signature->level_count; k++)
		put_level(columns, slot, signature, unit, k);
	put_means(columns, slot, ESKEL_SIGNATURE_LOG);
	put_means(columns, slot, ESKEL_SIGNATURE_PAPER);
	return ESKEL_OK;
}

eskel_status esk_columns_copy(esk_columns *columns, uint32_t slot, esk_shape from)
{
	eskel_status status = make_levels(columns, esk_shape_level_count(from));
	if (status != ESKEL_OK)
		return status;
	columns->level_counts[slot] = (uint8_t)esk_shape_level_count(from);
	columns->log_volumes[slot] = esk_shape_log_volume(from);
	columns->scales[slot] = esk_shape_scale(from);
	for (uint32_t k = 1; k <= esk_shape_level_count(from); k++) {
		memcpy(columns->levels[k - 1] + (size_t)slot * ESK_NUMBERS_MAX * k, esk_shape_sorted(from, k),
			ESK_NUMBERS_MAX * k * sizeof(float));
		memcpy(columns->ranks[k - 1] + slot * rank_bytes(k),
			from.columns->ranks[k - 1] + from.slot * rank_bytes(k), rank_bytes(k));
	}
	put_means(columns, slot, ESKEL_SIGNATURE_LOG);
	put_means(columns, slot, ESKEL_SIGNATURE_PAPER);
	return ESKEL_OK;
}
