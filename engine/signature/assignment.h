/* Minimum-cost perfect matching between two sets of k classes (section 5.2.2). */
#ifndef ESK_ASSIGNMENT_H
#define ESK_ASSIGNMENT_H

#include "eskel.h"

/* Rows of costs can be padded to 8, 16, 32 or 64 columns, so that they fill vector registers. */
static inline uint32_t esk_assignment_width(uint32_t k)
{
	return k <= 8 ? 8 : k <= 16 ? 16 : k <= 32 ? 32 : ESKEL_LEVELS_MAX;
}

enum {
	ESK_ASSIGNMENT_ALIGNMENT = 32, /* bytes */
	ESK_ASSIGNMENT_COSTS_MAX = ESKEL_LEVELS_MAX * ESKEL_LEVELS_MAX
};

/* costs[i * k + j] >= 0 and finite is the cost of giving row i column j; 1 <= k <= ESKEL_LEVELS_MAX; any 2 k of
 * them can be added without overflow. Writes column_of_row[k] and returns the sum of the chosen costs, added in row
 * order in double. Among matchings of equal cost always the same one is chosen, on every processor. Debug builds prove
 * optimality by dual feasibility. O(k^3). */
double esk_assignment_solve(uint32_t k, const float *costs, uint32_t *column_of_row);

/* The same for costs where they are: aligned, in rows of esk_assignment_width(k), INFINITY after the k-th. */
double esk_assignment_solve_padded(uint32_t k, const float *costs, uint32_t *column_of_row);

#endif
