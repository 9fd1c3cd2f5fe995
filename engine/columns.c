#include "columns.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>

void esk_columns_clear(esk_columns *columns)
{
	free(columns->level_counts);
	free(columns->log_volumes);
	free(columns->scales);
	free(columns->first_level);
	for (int kind = 0; kind < 2; kind++) {
		free(columns->level_means[kind]);
		free(columns->total_means[kind]);
	}
	*columns = (esk_columns){0};
}

eskel_status esk_columns_init(esk_columns *columns, uint32_t capacity)
{
	esk_columns made = {
		.capacity = capacity,
		.level_counts = esk_memory_array(capacity, sizeof *made.level_counts),
		.log_volumes = esk_memory_array(capacity, sizeof(float)),
		.scales = esk_memory_array(capacity, sizeof(float)),
		.first_level = esk_memory_array(capacity, ESK_NUMBERS_MAX * sizeof(float)),
	};
	bool complete = made.level_counts && made.log_volumes && made.scales && made.first_level;
	for (int kind = 0; kind < 2; kind++) {
		size_t numbers = esk_numbers((eskel_signature_kind)kind);
		made.level_means[kind] = esk_memory_array(capacity, numbers * ESK_SUMMED_LEVELS * sizeof(float));
		made.total_means[kind] = esk_memory_array(capacity, numbers * sizeof(float));
		complete = complete && made.level_means[kind] && made.total_means[kind];
	}
	if (!complete) {
		esk_columns_clear(&made);
		return ESKEL_NO_MEMORY;
	}
	*columns = made;
	return ESKEL_OK;
}

static void put_means(esk_columns *columns, uint32_t slot, const esk_shape *shape, eskel_signature_kind kind)
{
	const uint32_t numbers = esk_numbers(kind);
	const uint32_t depth = shape->level_count < ESK_SUMMED_LEVELS ? shape->level_count : ESK_SUMMED_LEVELS;
	float *means = columns->level_means[kind] + (size_t)slot * ESK_SUMMED_LEVELS * numbers;
	esk_shape_level_means(shape, kind, means);
	for (uint32_t c = 0; c < numbers; c++) {
		double sum = 0;
		for (uint32_t k = 0; k < depth; k++)
			sum += (double)means[k * numbers + c];
		columns->total_means[kind][c * columns->capacity + slot] = (float)(sum / depth);
	}
}

void esk_columns_put(esk_columns *columns, uint32_t slot, const esk_shape *shape)
{
	columns->level_counts[slot] = (uint8_t)shape->level_count;
	columns->log_volumes[slot] = shape->log_volume;
	columns->scales[slot] = shape->scale;
	for (uint32_t c = 0; c < ESK_NUMBERS_MAX; c++)
		columns->first_level[c * columns->capacity + slot] = esk_shape_sorted(shape, 1)[c];
	put_means(columns, slot, shape, ESKEL_SIGNATURE_LOG);
	put_means(columns, slot, shape, ESKEL_SIGNATURE_PAPER);
}

void esk_columns_add_differences(
	const float *theirs, const float *units, float mine, bool squared, uint32_t count, float *sums)
{
	for (uint32_t slot = 0; slot < count; slot++) {
		float difference = (units ? theirs[slot] * units[slot] : theirs[slot]) - mine;
		sums[slot] += squared ? difference * difference : fabsf(difference);
	}
}
