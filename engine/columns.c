#include "columns.h"

#include <math.h>
#include <string.h>

/* A chunk's columns are one block of memory: rows of halves first, so that none of 160 or 128 bytes lies in more cache lines
 * than it must, then floats, 16-bit codes and bytes. */
enum { HALVES = 2 * ESK_SUMMED_LEVELS, FLOATS = 2, SHORTS = 5 * (ESK_NUMBERS_MAX + ESK_PAPER_NUMBERS), BYTES = 4 };

static size_t bytes_per_slot(void)
{
	return HALVES * (ESK_NUMBERS_MAX + ESK_PAPER_NUMBERS) + FLOATS * sizeof(float) + SHORTS * sizeof(uint16_t) +
	       BYTES;
}

eskel_status esk_columns_init(esk_columns *columns, uint32_t capacity, esk_arena *arena)
{
	uint8_t *block = esk_arena_take(arena, capacity * bytes_per_slot());
	if (!block)
		return ESKEL_NO_MEMORY;
	columns->capacity = capacity;
	columns->halves[ESKEL_SIGNATURE_PAPER] = block;
	columns->halves[ESKEL_SIGNATURE_LOG] = block + (size_t)capacity * HALVES * ESK_PAPER_NUMBERS;
	float *floats =
		(float *)(void *)(columns->halves[ESKEL_SIGNATURE_LOG] + (size_t)capacity * HALVES * ESK_NUMBERS_MAX);
	columns->log_volumes = floats;
	columns->scales = floats + capacity;
	uint16_t *shorts = (uint16_t *)(void *)(floats + FLOATS * (size_t)capacity);
	for (eskel_signature_kind kind = ESKEL_SIGNATURE_LOG; kind <= ESKEL_SIGNATURE_PAPER; kind++) {
		const size_t column = (size_t)capacity * esk_numbers(kind);
		columns->first_level[kind] = shorts;
		columns->total_halves[kind] = shorts + column;
		columns->second_level[kind] = shorts + 3 * column;
		shorts += 5 * column;
	}
	uint8_t *bytes = (uint8_t *)shorts;
	columns->slacks[ESKEL_SIGNATURE_LOG] = bytes;
	columns->slacks[ESKEL_SIGNATURE_PAPER] = bytes + capacity;
	columns->level_counts = bytes + 2 * (size_t)capacity;
	columns->odd = bytes + 3 * (size_t)capacity;
	atomic_init(&columns->least_levels, ESKEL_LEVELS_MAX);
	atomic_init(&columns->any_odd, false);
	return ESKEL_OK;
}

void esk_columns_clear(esk_columns *columns)
{
	esk_arena_give_back(columns->halves[ESKEL_SIGNATURE_PAPER]);
	columns->halves[ESKEL_SIGNATURE_PAPER] = NULL;
}

static float nearest_code(esk_codes codes, float number)
{
	return floorf((number - codes.origin) / codes.step + 0.5f);
}

/* Returns whether there is a code for it. */
static bool encode(eskel_signature_kind kind, float number, uint16_t *code)
{
	const esk_codes codes = esk_columns_codes(kind);
	const bool inside = number >= codes.origin && number <= codes.top;
	*code = inside ? (uint16_t)nearest_code(codes, number) : 0;
	return inside;
}

/* Returns the rounding's error in steps. */
static double encode_half(esk_codes codes, float half, uint8_t *code)
{
	const float inside = fminf(fmaxf(half, codes.origin), codes.top);
	*code = (uint8_t)fminf(nearest_code(codes, inside), 255);
	return fabs((double)(codes.origin + (float)*code * codes.step) - (double)inside) / (double)codes.step;
}

/* Rows of a level by class, in size-free lengths for the paper. */
static void unsorted_rows(const esk_shape *shape, eskel_signature_kind kind, uint32_t level, float *rows)
{
	float lengths[2 * ESK_PAPER_NUMBERS];
	const float *sorted = esk_shape_sorted(shape, level);
	if (kind == ESKEL_SIGNATURE_PAPER) {
		esk_shape_lengths(sorted, (size_t)ESK_PAPER_NUMBERS * level, 1, lengths);
		sorted = lengths;
	}
	esk_shape_unsort(shape, level, sorted, esk_numbers(kind), rows);
}

/* Returns whether all numbers have a code. */
static bool put_first_levels(esk_columns *columns, uint32_t slot, const esk_shape *shape, eskel_signature_kind kind)
{
	const uint32_t numbers = esk_numbers(kind);
	float rows[2 * ESK_NUMBERS_MAX];
	bool coded = true;
	unsorted_rows(shape, kind, 1, rows);
	for (uint32_t c = 0; c < numbers; c++)
		coded &= encode(kind, rows[c], &columns->first_level[kind][c * columns->capacity + slot]);
	uint16_t *second = columns->second_level[kind] + (size_t)slot * 2 * numbers;
	memset(second, 0, 2 * numbers * sizeof *second);
	if (shape->level_count < 2)
		return coded;
	unsorted_rows(shape, kind, 2, rows);
	for (uint32_t c = 0; c < numbers; c++)
		for (uint32_t i = 0; i < 2; i++)
			coded &= encode(kind, rows[2 * c + i], &second[i * numbers + c]);
	return coded;
}

/* Returns whether all means have a code. */
static bool put_halves(esk_columns *columns, uint32_t slot, const esk_shape *shape, eskel_signature_kind kind)
{
	const uint32_t numbers = esk_numbers(kind);
	const uint32_t depth = shape->level_count < ESK_SUMMED_LEVELS ? shape->level_count : ESK_SUMMED_LEVELS;
	const size_t row_size = (size_t)ESK_SUMMED_LEVELS * 2 * numbers;
	uint8_t *row = columns->halves[kind] + slot * row_size;
	double sums[ESK_HALVES_MAX] = {0}, error = 0;
	bool coded = true;
	memset(row, 0, row_size);
	for (uint32_t k = 1; k <= depth; k++) {
		float halves[ESK_HALVES_MAX];
		esk_shape_halves(shape, kind, k, halves);
		for (uint32_t h = 0; h < 2 * numbers; h++) {
			error += encode_half(esk_columns_half_codes(kind, h / 2), halves[h], row++);
			sums[h] += (double)halves[h];
		}
	}
	/* At most half a step for each of 160. */
	columns->slacks[kind][slot] = (uint8_t)ceil(error);
	for (uint32_t h = 0; h < 2 * numbers; h++)
		coded &= encode(
			kind, (float)(sums[h] / depth), &columns->total_halves[kind][h * columns->capacity + slot]);
	return coded;
}

void esk_columns_put(esk_columns *columns, uint32_t slot, const esk_shape *shape)
{
	bool coded = true;
	columns->level_counts[slot] = (uint8_t)shape->level_count;
	columns->log_volumes[slot] = shape->log_volume;
	columns->scales[slot] = shape->scale;
	for (eskel_signature_kind kind = ESKEL_SIGNATURE_LOG; kind <= ESKEL_SIGNATURE_PAPER; kind++) {
		coded &= put_first_levels(columns, slot, shape, kind);
		coded &= put_halves(columns, slot, shape, kind);
	}
	columns->odd[slot] = !coded;
	if (!coded)
		atomic_store_explicit(&columns->any_odd, true, memory_order_relaxed);
	if (shape->level_count < atomic_load_explicit(&columns->least_levels, memory_order_relaxed))
		atomic_store_explicit(&columns->least_levels, shape->level_count, memory_order_relaxed);
}
