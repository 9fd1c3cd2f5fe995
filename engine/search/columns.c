#include "columns.h"

#include "lanes.h"

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

/* Of a number that has one: it is not below the origin, so cutting off rounds down. */
static inline int32_t nearest_code(float origin, float step, float number)
{
	return (int32_t)((number - origin) / step + 0.5f);
}

/* Returns whether there is a code for each; what has none gets 0. */
static inline __attribute__((always_inline)) bool encode(
	eskel_signature_kind kind, const float *numbers, size_t count, uint16_t *codes)
{
	const esk_codes of_kind = esk_columns_codes(kind);
	int outside = 0;
	for (size_t n = 0; n < count; n++) {
		const bool inside = numbers[n] >= of_kind.origin && numbers[n] <= of_kind.top;
		codes[n] = (uint16_t)nearest_code(of_kind.origin, of_kind.step, inside ? numbers[n] : of_kind.origin);
		outside |= !inside;
	}
	return !outside;
}

/* Halves of the first levels, one level after the other, and what their codes reach from and to. */
typedef struct {
	float numbers[ESK_COLUMNS_HALVES], origins[ESK_COLUMNS_HALVES], tops[ESK_COLUMNS_HALVES];
} level_halves;

static inline __attribute__((always_inline)) void take_halves(
	const float *features, eskel_signature_kind kind, uint32_t depth, level_halves *halves)
{
	const uint32_t row = 2 * esk_numbers(kind);
	double sums[ESK_COLUMNS_HALVES], levels[ESK_COLUMNS_HALVES];
	size_t count = 0;
	for (uint32_t k = 1; k <= depth; k++) {
		esk_shape_half_sums(features + ESK_NUMBERS_MAX * ESKEL_NODES(k - 1), kind, k, sums + count);
		for (uint32_t h = 0; h < row; h++, count++) {
			const esk_codes codes = esk_columns_half_codes(kind, h / 2);
			levels[count] = k;
			halves->origins[count] = codes.origin;
			halves->tops[count] = codes.top;
		}
	}
	for (size_t n = 0; n < count; n++)
		halves->numbers[n] = (float)(sums[n] / levels[n]);
}

/* Returns the sum of the rounding's errors, in steps. */
static inline __attribute__((always_inline)) double encode_halves(
	const level_halves *halves, eskel_signature_kind kind, size_t count, uint8_t *codes)
{
	const float step = esk_columns_half_codes(kind, 0).step;
	double errors[ESK_COLUMNS_HALVES], sum = 0;
	for (size_t n = 0; n < count; n++) {
		const float half = halves->numbers[n], origin = halves->origins[n], top = halves->tops[n];
		const float raised = half < origin ? origin : half, inside = raised > top ? top : raised;
		const int32_t code = nearest_code(origin, step, inside);
		codes[n] = (uint8_t)code;
		errors[n] = fabs((double)(origin + (float)code * step) - (double)inside) / (double)step;
	}
	for (size_t n = 0; n < count; n++)
		sum += errors[n];
	return sum;
}

static void mean_halves(const level_halves *halves, uint32_t numbers, uint32_t depth, float *means)
{
	double sums[ESK_HALVES_MAX] = {0};
	for (uint32_t k = 0; k < depth; k++)
		for (uint32_t h = 0; h < 2 * numbers; h++)
			sums[h] += (double)halves->numbers[k * 2 * numbers + h];
	for (uint32_t h = 0; h < 2 * numbers; h++)
		means[h] = (float)(sums[h] / depth);
}

/* Of level 2, class after class. */
static inline __attribute__((always_inline)) bool encode_second_level(
	const esk_shape *shape, const float *features, eskel_signature_kind kind, uint16_t *codes)
{
	const uint32_t numbers = esk_numbers(kind);
	float rows[2 * ESK_NUMBERS_MAX], classes[2 * ESK_NUMBERS_MAX];
	esk_shape_unsort(shape, 2, features + ESK_NUMBERS_MAX, numbers, rows);
	for (uint32_t c = 0; c < numbers; c++)
		for (uint32_t i = 0; i < 2; i++)
			classes[i * numbers + c] = rows[2 * c + i];
	return encode(kind, classes, 2 * (size_t)numbers, codes);
}

/* Features of the first levels: size-free lengths for the paper. Returns whether all numbers have a code. */
static inline __attribute__((always_inline)) bool encode_kind(
	const esk_shape *shape, const float *features, eskel_signature_kind kind, esk_kind_codes *codes)
{
	const uint32_t numbers = esk_numbers(kind);
	const uint32_t depth = shape->level_count < ESK_SUMMED_LEVELS ? shape->level_count : ESK_SUMMED_LEVELS;
	level_halves halves;
	float means[ESK_HALVES_MAX];
	take_halves(features, kind, depth, &halves);
	mean_halves(&halves, numbers, depth, means);
	bool coded = encode(kind, features, numbers, codes->first_level);
	if (shape->level_count >= 2)
		coded &= encode_second_level(shape, features, kind, codes->second_level);
	coded &= encode(kind, means, 2 * (size_t)numbers, codes->total_halves);
	/* At most half a step for each of 160. */
	codes->slack = (uint8_t)ceil(encode_halves(&halves, kind, (size_t)depth * 2 * numbers, codes->halves));
	return coded;
}

ESK_EVERY_WIDTH void esk_columns_encode(const esk_shape *shape, esk_shape_codes *codes)
{
	const uint32_t depth = shape->level_count < ESK_SUMMED_LEVELS ? shape->level_count : ESK_SUMMED_LEVELS;
	float lengths[ESK_NUMBERS_MAX * ESKEL_NODES(ESK_SUMMED_LEVELS)];
	esk_shape_lengths(shape->numbers, ESK_NUMBERS_MAX * ESKEL_NODES(depth), 1, lengths);
	memset(codes, 0, sizeof *codes);
	codes->level_count = (uint8_t)shape->level_count;
	codes->log_volume = shape->log_volume;
	codes->scale = shape->scale;
	bool coded = encode_kind(shape, shape->numbers, ESKEL_SIGNATURE_LOG, &codes->kinds[ESKEL_SIGNATURE_LOG]);
	coded &= encode_kind(shape, lengths, ESKEL_SIGNATURE_PAPER, &codes->kinds[ESKEL_SIGNATURE_PAPER]);
	codes->odd = !coded;
}

static void put_kind(esk_columns *columns, uint32_t slot, eskel_signature_kind kind, const esk_kind_codes *codes)
{
	const uint32_t numbers = esk_numbers(kind);
	const size_t row = (size_t)ESK_SUMMED_LEVELS * 2 * numbers;
	for (uint32_t c = 0; c < numbers; c++)
		columns->first_level[kind][c * columns->capacity + slot] = codes->first_level[c];
	for (uint32_t h = 0; h < 2 * numbers; h++)
		columns->total_halves[kind][h * columns->capacity + slot] = codes->total_halves[h];
	memcpy(columns->second_level[kind] + (size_t)slot * 2 * numbers, codes->second_level,
		2 * numbers * sizeof *codes->second_level);
	memcpy(columns->halves[kind] + slot * row, codes->halves, row);
	columns->slacks[kind][slot] = codes->slack;
}

void esk_columns_put(esk_columns *columns, uint32_t slot, const esk_shape_codes *codes)
{
	columns->level_counts[slot] = codes->level_count;
	columns->log_volumes[slot] = codes->log_volume;
	columns->scales[slot] = codes->scale;
	columns->odd[slot] = codes->odd;
	for (eskel_signature_kind kind = ESKEL_SIGNATURE_LOG; kind <= ESKEL_SIGNATURE_PAPER; kind++)
		put_kind(columns, slot, kind, &codes->kinds[kind]);
	if (codes->odd)
		atomic_store_explicit(&columns->any_odd, true, memory_order_relaxed);
	if (codes->level_count < atomic_load_explicit(&columns->least_levels, memory_order_relaxed))
		atomic_store_explicit(&columns->least_levels, codes->level_count, memory_order_relaxed);
}
