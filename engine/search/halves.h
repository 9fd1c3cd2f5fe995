/* Sums of differences between a query's halves and rows of codes (columns.h): what a search spends most of its time on. */
#ifndef ESK_HALVES_H
#define ESK_HALVES_H

#include <stddef.h>
#include <stdint.h>

/* sums[i] = sum over begin <= n < end of |min(mine[n] steps[i], 255) - rows[i][n]|, in sixteen lanes on every processor:
 * the same to the last bit. Rows have size numbers, at least 16, and end is at most size. */
void esk_halves_sum(const float *mine, size_t begin, size_t end, size_t size, const uint8_t *const *rows,
	const float *steps, size_t row_count, float *sums);

#endif
