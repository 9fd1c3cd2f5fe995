/* Lower bounds of a distance, from cheap to tight: never above what esk_query_distance returns.
 *
 * A level's least matching costs no less than a matching that is free to choose another bijection for each number, and
 * on one number the best bijection joins sorted values. That costs no less than the differences of the sums of the lower
 * and of the upper half of the values; and over levels the mean of such differences is no less than the difference of
 * their means. For the Euclidean metric the same holds with the Euclidean norm over numbers in place of the sum:
 * sum_i ||d_i|| >= ||sum_i |d_i||| (triangle inequality). For sums of square roots it holds with the root of each
 * number's sum: sum_i sqrt |d_i| >= sqrt(sum_i |d_i|). That is loose at deep levels, and over all levels it would say
 * nothing, so with roots the scan is by the halves of each level. */
#ifndef ESK_BOUND_H
#define ESK_BOUND_H

#include "columns.h"
#include "distance.h"
#include "scan.h"

enum { ESK_SUMMED_NUMBERS = ESK_NUMBERS_MAX * ESKEL_NODES(ESK_SUMMED_LEVELS) };

/* The query's side, of its levels 1..16. */
typedef struct {
	const esk_query *query;
	bool over_levels; /* halves over all levels are scanned */
	esk_scan scan;    /* of total_halves */
	float total_halves[ESK_HALVES_MAX];
	float halves[ESK_SUMMED_LEVELS * ESK_HALVES_MAX];       /* above the origin of their codes */
	float root_worths[ESK_SUMMED_LEVELS * ESK_NUMBERS_MAX]; /* 1 / sqrt(k) for each number of level k */
	/* Sorted numbers as a shape has them, 5 rows a level, and what a difference is worth in the level's mean pair cost: 1 / k,
	 * or 0 for a row that the signature does not use. */
	float sorted[ESK_SUMMED_NUMBERS], worths[ESK_SUMMED_NUMBERS];
	/* Sums over levels 1..k of the absolute numbers of the mean class, and of the halves. */
	double class_magnitudes[ESKEL_LEVELS_MAX + 1], halves_magnitudes[ESK_SUMMED_LEVELS + 1];
} esk_bound;

void esk_bound_init(esk_bound *bound, const esk_query *query);

/* For the first count slots: by the halves over all levels, or else what esk_bound_by_halves finds. */
void esk_bound_scan(const esk_bound *bound, esk_columns *columns, uint32_t count, float *bounds);
/* For each of these slots: by the halves of each level that counts. */
void esk_bound_by_halves(
	const esk_bound *bound, esk_columns *columns, const uint16_t *slots, uint32_t count, float *bounds);
/* By sorted numbers, a few levels at a time, and halves of the deeper ones: adds what levels first..last come to, of those
 * that count, to *sorted, which is 0 at first. */
double esk_bound_by_sorting(const esk_bound *bound, const esk_columns *columns, uint32_t slot, const esk_shape *shape,
	uint32_t first, uint32_t last, double *sorted);
/* By sorted numbers: levels[k - 1] is a bound of D_k for each level that counts. */
void esk_bound_levels(const esk_bound *bound, const esk_shape *shape, double *levels);
/* From a D_k or a lower bound of it for each level that counts. */
double esk_bound_of_levels(const esk_query *query, const esk_shape *other, const double *levels);

#endif
