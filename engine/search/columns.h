/* What a search reads of every shape of a chunk: columns over its slots, and rows.
 *
 * Scans run over columns at the speed of memory; what they leave is judged by the rows; only then is a shape's
 * own piece of memory (shape.h) touched. Arrays over kinds are indexed by eskel_signature_kind. The paper's numbers are the
 * size-free lengths.
 *
 * Numbers are kept as codes: code c stands for origin + c step. Columns and rows of level 2 take 16 bits a number, which tell
 * distances apart but for a few; a number outside the codes makes its slot odd, and then the shape itself is asked.
 *
 * A row of halves holds those (shape.h) of levels 1..16 in a byte each, and a half outside the codes is moved to the
 * nearest. A byte is enough, because they serve lower bounds only, which allow for the error: the moving brings no two
 * numbers further apart, and what the rounding moved, summed over the row, is kept beside it as the row's slack. */
#ifndef ESK_COLUMNS_H
#define ESK_COLUMNS_H

#include "arena.h"
#include "shape.h"

#include <stdatomic.h>

enum { ESK_HALVES_MAX = 2 * ESK_NUMBERS_MAX, ESK_COLUMNS_HALVES = ESK_SUMMED_LEVELS * ESK_HALVES_MAX };

typedef struct {
	float origin, step, top; /* top: what the last code stands for */
} esk_codes;

typedef struct {
	uint32_t capacity;
	atomic_uint least_levels; /* that a shape has */
	atomic_bool any_odd;
	float *log_volumes;
	float *scales;
	uint16_t *first_level[2];  /* [numbers][capacity]: of level 1 */
	uint16_t *total_halves[2]; /* [numbers][2][capacity]: means of the halves over the levels 1..16 of a shape */
	uint16_t
		*second_level[2]; /* [capacity][2][numbers]: of the two classes of level 2; zeros where there is none */
	uint8_t *halves[2];       /* [capacity][16][numbers][2]; zeros where a shape has no such level */
	uint8_t *slacks[2];       /* in steps, rounded up */
	uint8_t *level_counts;
	uint8_t *odd; /* not 0: a number of its columns or of its row of level 2 has no code */
} esk_columns;

/* What a slot holds of a shape, made apart from the columns. */
typedef struct {
	uint16_t first_level[ESK_NUMBERS_MAX];
	uint16_t total_halves[ESK_HALVES_MAX];
	uint16_t second_level[ESK_HALVES_MAX];
	uint8_t halves[ESK_COLUMNS_HALVES];
	uint8_t slack;
} esk_kind_codes;

typedef struct {
	float log_volume, scale;
	uint8_t level_count, odd;
	esk_kind_codes kinds[2];
} esk_shape_codes;

eskel_status esk_columns_init(esk_columns *columns, uint32_t capacity, esk_arena *arena);
void esk_columns_clear(esk_columns *columns);
void esk_columns_encode(const esk_shape *shape, esk_shape_codes *codes);
void esk_columns_put(esk_columns *columns, uint32_t slot, const esk_shape_codes *codes);

static inline const uint8_t *esk_columns_halves(const esk_columns *columns, uint32_t slot, eskel_signature_kind kind)
{
	return columns->halves[kind] + (size_t)slot * ESK_SUMMED_LEVELS * 2 * esk_numbers(kind);
}

static inline const uint16_t *esk_columns_second(const esk_columns *columns, uint32_t slot, eskel_signature_kind kind)
{
	return columns->second_level[kind] + (size_t)slot * 2 * esk_numbers(kind);
}

static inline uint32_t esk_columns_least_levels(esk_columns *columns)
{
	return atomic_load_explicit(&columns->least_levels, memory_order_relaxed);
}

/* Whether all codes mean what they say, and every shape has so many levels. */
static inline bool esk_columns_are_plain(esk_columns *columns, uint32_t levels)
{
	return !atomic_load_explicit(&columns->any_odd, memory_order_relaxed) &&
	       esk_columns_least_levels(columns) >= levels;
}

/* Logarithms are never below ln 0.02 = -3.9, and 12 is that of a thread 160,000 times as long as the cube of its
 * volume; lengths of 8 are those of a thread of 1 : 1000. */
static inline esk_codes esk_columns_codes(eskel_signature_kind kind)
{
	if (kind == ESKEL_SIGNATURE_PAPER)
		return (esk_codes){.origin = 0, .step = 1.0f / 8192, .top = 65535.0f / 8192};
	return (esk_codes){.origin = -4, .step = 1.0f / 4096, .top = 65535.0f / 4096 - 4};
}

/* Codes of halves of one number. Of compact shapes nearly all halves are inside, of long ones all but rho and the length of the
 * first levels. */
static inline esk_codes esk_columns_half_codes(eskel_signature_kind kind, uint32_t number)
{
	static const float origins[ESK_NUMBERS_MAX] = {-1.0f, -1.27f, -1.27f, -0.6f, -1.0f};
	if (kind == ESKEL_SIGNATURE_PAPER)
		return (esk_codes){.origin = 0, .step = 1.0f / 500, .top = 255.0f / 500};
	return (esk_codes){.origin = origins[number], .step = 1.0f / 200, .top = 255.0f / 200 + origins[number]};
}

#endif
