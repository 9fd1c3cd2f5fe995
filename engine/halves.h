/* Sums of differences between a query's halves and rows of codes (columns.h): what a search spends most of its time on. */
#ifndef ESK_HALVES_H
#define ESK_HALVES_H

#include <stddef.h>
#include <stdint.h>

/* Rows are read up to so many bytes past their end, and mine as many floats. */
enum { ESK_HALVES_PAST = 15 };

/* sums[i] = sum over n < count of |min(mine[n] steps[i], 255) - rows[i][n]|, in sixteen lanes on every processor: the
 * same to the last bit. */
void esk_halves_sum(
	const float *mine, size_t count, const uint8_t *const *rows, const float *steps, size_t row_count, float *sums);

#endif
