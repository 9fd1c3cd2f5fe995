/* Minimum-cost perfect matching between two sets of k classes (section 5.2.2). */
#ifndef ESK_ASSIGNMENT_H
#define ESK_ASSIGNMENT_H

#include <stdint.h>

/* costs[i * k + j] >= 0 and finite is the cost of giving row i column j; 1 <= k <= ESKEL_LEVELS_MAX.
 * Writes column_of_row[k] and returns the sum of the chosen costs, added in row order in double. Among matchings of
 * equal cost always the same one is chosen. Debug builds prove optimality by dual feasibility. O(k^3). */
double esk_assignment_solve(uint32_t k, const float *costs, uint32_t *column_of_row);

#endif
