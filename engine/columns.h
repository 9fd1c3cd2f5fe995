/* What a search reads of every shape of a chunk: columns over its slots, and rows of halves.
 *
 * Scans run over columns at the speed of memory; what they leave is judged by the rows; only then is a shape's
 * own piece of memory (shape.h) touched. Arrays over kinds are indexed by eskel_signature_kind. The paper's numbers are the
 * size-free lengths.
 *
 * A row holds the halves (shape.h) of levels 1..16 in a byte each: code b stands for origin + b step, and a half outside
 * the codes is moved to the nearest. A byte is enough, because bounds allow for its error: the moving brings no two
 * numbers further apart, and what the rounding moved, summed over the row, is kept beside it as the row's slack. */
#ifndef ESK_COLUMNS_H
#define ESK_COLUMNS_H

#include "arena.h"
#include "shape.h"

enum { ESK_HALVES_MAX = 2 * ESK_NUMBERS_MAX };

typedef struct {
	float origin, step, top; /* top: the last code's half */
} esk_codes;

typedef struct {
	uint32_t capacity;
	float *log_volumes;
	float *scales;
	float *first_level;    /* [5][capacity]: the features of level 1 */
	float *total_means[2]; /* [numbers][capacity]: means over classes, and over the levels 1..16 of a shape */
	uint8_t *halves[2];    /* [capacity][16][numbers][2]; zeros where a shape has no such level */
	uint8_t *slacks[2];    /* in steps, rounded up */
	uint8_t *level_counts;
} esk_columns;

eskel_status esk_columns_init(esk_columns *columns, uint32_t capacity, esk_arena *arena);
void esk_columns_clear(esk_columns *columns);
void esk_columns_put(esk_columns *columns, uint32_t slot, const esk_shape *shape);

static inline const uint8_t *esk_columns_halves(const esk_columns *columns, uint32_t slot, eskel_signature_kind kind)
{
	return columns->halves[kind] + (size_t)slot * ESK_SUMMED_LEVELS * 2 * esk_numbers(kind);
}

/* Typical halves are -1.3 to 0.2 of the logarithms and 0 to 0.7 of the lengths. */
static inline esk_codes esk_columns_codes(eskel_signature_kind kind)
{
	esk_codes codes = {.origin = kind == ESKEL_SIGNATURE_PAPER ? 0 : -2,
		.step = kind == ESKEL_SIGNATURE_PAPER ? 1.0f / 320 : 1.0f / 100};
	codes.top = codes.origin + 255 * codes.step;
	return codes;
}

/* sums[slot] += |theirs[slot] units[slot] - mine|, or the square of it; units may be NULL. */
void esk_columns_add_differences(
	const float *theirs, const float *units, float mine, bool squared, uint32_t count, float *sums);

#endif
