/* Lower bounds of a distance, from cheap to tight: never above what esk_query_distance returns.
 *
 * A level's least matching costs no less than a matching that is free to choose another bijection for each number, and
 * on one number the best bijection joins sorted values. That costs no less than the differences of the sums of the lower
 * and of the upper half of the values, nor these than the difference of the whole sums; and over levels the mean of
 * such differences is no less than the difference of their means.
 * For the Euclidean metric the same holds with the Euclidean norm over numbers in place of the sum:
 * sum_i ||d_i|| >= ||sum_i |d_i||| (triangle inequality). */
#ifndef ESK_BOUND_H
#define ESK_BOUND_H

#include "columns.h"
#include "distance.h"

typedef struct {
	const esk_query *query;
	/* For levels 1..16: the halves (shape.h) of level k, and the means of the numbers over classes and levels 1..k. */
	float halves[ESK_SUMMED_LEVELS * ESK_HALVES_MAX], total_means[ESK_SUMMED_LEVELS * ESK_NUMBERS_MAX];
	/* Sums of absolute numbers: of the halves of levels 1..k, of total_means, of the mean class of any level. */
	double halves_magnitudes[ESK_SUMMED_LEVELS + 1], total_magnitudes[ESK_SUMMED_LEVELS];
	double class_magnitudes[ESKEL_LEVELS_MAX];
} esk_bound;

void esk_bound_init(esk_bound *bound, const esk_query *query);

/* For the first count slots by the means over all levels: a scan of a few columns. When levels are not summed, by the
 * halves of the level. */
void esk_bound_scan(const esk_bound *bound, const esk_columns *columns, uint32_t count, float *bounds);
/* By the halves of each level that counts. */
double esk_bound_by_halves(const esk_bound *bound, const esk_columns *columns, uint32_t slot);
/* Of D_k alone, by its halves. */
double esk_bound_of_level(const esk_bound *bound, const esk_columns *columns, uint32_t slot, uint32_t level);
/* By sorted numbers, level after level in place of halves, until the bound exceeds enough. Then or at the end
 * levels[k - 1] is a bound of D_k for each level that counts. */
double esk_bound_by_sorting(const esk_bound *bound, const esk_columns *columns, uint32_t slot, const esk_shape *shape,
	double enough, double *levels);
/* From a D_k or a lower bound of it for each level that counts. */
double esk_bound_of_levels(const esk_query *query, const esk_shape *other, const double *levels);

#endif
