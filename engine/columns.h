/* What a search reads of every shape of a chunk: columns over its slots, and rows of means.
 *
 * Scans run over columns at the speed of memory; what they leave is judged by the rows; only then is a shape's
 * own piece of memory (shape.h) touched. Arrays over kinds are indexed by eskel_signature_kind. The paper's means are those
 * of the size-free lengths. */
#ifndef ESK_COLUMNS_H
#define ESK_COLUMNS_H

#include "shape.h"

typedef struct {
	uint32_t capacity;
	uint8_t *level_counts;
	float *log_volumes;
	float *scales;
	float *first_level;    /* [5][capacity]: the features of level 1 */
	float *total_means[2]; /* [numbers][capacity]: the means of the level means over the levels 1..16 of a shape */
	float *level_means[2]; /* [capacity][16][numbers] */
} esk_columns;

eskel_status esk_columns_init(esk_columns *columns, uint32_t capacity);
void esk_columns_clear(esk_columns *columns);
void esk_columns_put(esk_columns *columns, uint32_t slot, const esk_shape *shape);

static inline const float *esk_columns_level_means(const esk_columns *columns, uint32_t slot, eskel_signature_kind kind)
{
	return columns->level_means[kind] + (size_t)slot * ESK_SUMMED_LEVELS * esk_numbers(kind);
}

/* sums[slot] += |theirs[slot] units[slot] - mine|, or the square of it; units may be NULL. */
void esk_columns_add_differences(
	const float *theirs, const float *units, float mine, bool squared, uint32_t count, float *sums);

#endif
