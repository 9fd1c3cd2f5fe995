#include "columns.h"

#include <math.h>
#include <string.h>

/* A chunk's columns are one block of memory: all of floats, then all of bytes. */
static size_t floats_per_slot(void)
{
	return 2 + ESK_NUMBERS_MAX + ESK_NUMBERS_MAX + ESK_PAPER_NUMBERS;
}

static size_t bytes_per_slot(void)
{
	return 2 * (ESK_NUMBERS_MAX + ESK_PAPER_NUMBERS) * ESK_SUMMED_LEVELS + 2 + 1;
}

eskel_status esk_columns_init(esk_columns *columns, uint32_t capacity, esk_arena *arena)
{
	float *floats = esk_arena_take(arena, capacity * (floats_per_slot() * sizeof *floats + bytes_per_slot()));
	if (!floats)
		return ESKEL_NO_MEMORY;
	esk_columns made = {.capacity = capacity, .log_volumes = floats};
	made.scales = made.log_volumes + capacity;
	made.first_level = made.scales + capacity;
	made.total_means[ESKEL_SIGNATURE_LOG] = made.first_level + ESK_NUMBERS_MAX * capacity;
	made.total_means[ESKEL_SIGNATURE_PAPER] = made.total_means[ESKEL_SIGNATURE_LOG] + ESK_NUMBERS_MAX * capacity;
	uint8_t *bytes = (uint8_t *)(floats + floats_per_slot() * capacity);
	for (int kind = 0; kind < 2; kind++) {
		made.halves[kind] = bytes;
		bytes += (size_t)capacity * ESK_SUMMED_LEVELS * 2 * esk_numbers((eskel_signature_kind)kind);
	}
	made.slacks[ESKEL_SIGNATURE_LOG] = bytes;
	made.slacks[ESKEL_SIGNATURE_PAPER] = bytes + capacity;
	made.level_counts = bytes + 2 * capacity;
	*columns = made;
	return ESKEL_OK;
}

void esk_columns_clear(esk_columns *columns)
{
	esk_arena_give_back(columns->log_volumes);
	*columns = (esk_columns){0};
}

/* Returns the rounding's error in steps. */
static double encode(esk_codes codes, float half, uint8_t *code)
{
	const float inside = fminf(fmaxf(half, codes.origin), codes.top);
	const int nearest = (int)((inside - codes.origin) / codes.step + 0.5f);
	*code = (uint8_t)(nearest < 255 ? nearest : 255);
	return fabs((double)(codes.origin + (float)*code * codes.step) - (double)inside) / (double)codes.step;
}

static void put_halves(esk_columns *columns, uint32_t slot, const esk_shape *shape, eskel_signature_kind kind)
{
	const uint32_t numbers = esk_numbers(kind);
	const uint32_t depth = shape->level_count < ESK_SUMMED_LEVELS ? shape->level_count : ESK_SUMMED_LEVELS;
	const size_t row_size = (size_t)ESK_SUMMED_LEVELS * 2 * numbers;
	uint8_t *row = columns->halves[kind] + slot * row_size;
	double sums[ESK_NUMBERS_MAX] = {0}, error = 0;
	memset(row, 0, row_size);
	for (uint32_t k = 1; k <= depth; k++) {
		float halves[ESK_HALVES_MAX];
		esk_shape_halves(shape, kind, k, halves);
		for (uint32_t h = 0; h < 2 * numbers; h++) {
			error += encode(esk_columns_codes(kind), halves[h], row++);
			sums[h / 2] += (double)halves[h];
		}
	}
	/* At most half a step for each of 160. */
	columns->slacks[kind][slot] = (uint8_t)ceil(error);
	for (uint32_t c = 0; c < numbers; c++)
		columns->total_means[kind][c * columns->capacity + slot] = (float)(sums[c] / depth);
}

void esk_columns_put(esk_columns *columns, uint32_t slot, const esk_shape *shape)
{
	columns->level_counts[slot] = (uint8_t)shape->level_count;
	columns->log_volumes[slot] = shape->log_volume;
	columns->scales[slot] = shape->scale;
	for (uint32_t c = 0; c < ESK_NUMBERS_MAX; c++)
		columns->first_level[c * columns->capacity + slot] = esk_shape_sorted(shape, 1)[c];
	put_halves(columns, slot, shape, ESKEL_SIGNATURE_LOG);
	put_halves(columns, slot, shape, ESKEL_SIGNATURE_PAPER);
}

void esk_columns_add_differences(
	const float *theirs, const float *units, float mine, bool squared, uint32_t count, float *sums)
{
	for (uint32_t slot = 0; slot < count; slot++) {
		float difference = (units ? theirs[slot] * units[slot] : theirs[slot]) - mine;
		sums[slot] += squared ? difference * difference : fabsf(difference);
	}
}
