#include "bound.h"

#include <math.h>
#include <string.h>

/* Rounding must never lift a bound above the distance. A bound is a few hundred float operations on differences, each
 * wrong by at most 2^-24 of its result: 2^-13 of the bound covers them. The numbers that are subtracted carry
 * an error of their own, at most 2^-22 of themselves; where that matters the other's number is about as large as
 * the query's, so 2^-20 of the query's numbers covers both. */
static const double relative_margin = 0x1p-13, absolute_margin = 0x1p-20;

static double safe(double bound, double magnitude)
{
	return bound * (1 - relative_margin) - absolute_margin * magnitude;
}

/* What the mean pair cost, averaged over the levels that count, is worth in the distance (distance.c). */
static double weight(const esk_query *query, uint32_t depth)
{
	return query->signature == ESKEL_SIGNATURE_PAPER ? depth : 1;
}

static double magnitude(const float *numbers, uint32_t count)
{
	double sum = 0;
	for (uint32_t n = 0; n < count; n++)
		sum += fabs((double)numbers[n]);
	return sum;
}

/* Means of the paper's lengths are kept size-free. */
static bool has_unit(const esk_query *query)
{
	return query->signature == ESKEL_SIGNATURE_PAPER && query->size_counts;
}

void esk_bound_init(esk_bound *bound, const esk_query *query)
{
	const uint32_t numbers = esk_numbers(query->signature), levels = query->shape->level_count;
	const float unit = has_unit(query) ? query->shape->scale : 1;
	float means[ESK_SUMMED_LEVELS * ESK_NUMBERS_MAX];
	double sums[ESK_NUMBERS_MAX] = {0};
	*bound = (esk_bound){.query = query};
	esk_shape_level_means(query->shape, query->signature, means);
	for (uint32_t k = 1; k <= levels; k++)
		bound->class_magnitudes[k - 1] = magnitude(query->rows[k - 1], numbers * k) / k;
	for (uint32_t k = 1; k <= levels && k <= ESK_SUMMED_LEVELS; k++) {
		float *level = bound->level_means + (k - 1) * numbers, *total = bound->total_means + (k - 1) * numbers;
		for (uint32_t c = 0; c < numbers; c++) {
			level[c] = means[(k - 1) * numbers + c] * unit;
			sums[c] += (double)level[c];
			total[c] = (float)(sums[c] / k);
		}
		bound->level_magnitudes[k - 1] = magnitude(level, numbers);
		bound->total_magnitudes[k - 1] = magnitude(total, numbers);
	}
}

/* sum |theirs[n] unit - mine[n]| in eight lanes: the same sum, and so the same shapes discarded, on any processor. */
static float sum_of_differences(const float *mine, const float *theirs, float unit, uint32_t count)
{
	float lanes[8] = {0};
	uint32_t n = 0;
	for (; n + 8 <= count; n += 8)
		for (uint32_t lane = 0; lane < 8; lane++)
			lanes[lane] += fabsf(theirs[n + lane] * unit - mine[n + lane]);
	for (uint32_t lane = 0; n < count; n++, lane++)
		lanes[lane] += fabsf(theirs[n] * unit - mine[n]);
	return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

static double euclidean_difference(const float *mine, const float *theirs, float unit, uint32_t numbers)
{
	float sum = 0;
	for (uint32_t c = 0; c < numbers; c++)
		sum += (theirs[c] * unit - mine[c]) * (theirs[c] * unit - mine[c]);
	return (double)sqrtf(sum);
}

/* The difference of two rows of means in the query's metric, summed over rows. */
static double mean_cost(const esk_query *query, const float *mine, const float *theirs, float unit, uint32_t rows)
{
	const uint32_t numbers = esk_numbers(query->signature);
	if (!query->euclidean)
		return (double)sum_of_differences(mine, theirs, unit, rows * numbers);
	double cost = 0;
	for (uint32_t row = 0; row < rows; row++)
		cost += euclidean_difference(mine + row * numbers, theirs + row * numbers, unit, numbers);
	return cost;
}

double esk_bound_by_means(const esk_bound *bound, const esk_columns *columns, uint32_t slot)
{
	const esk_query *query = bound->query;
	const uint32_t depth = esk_query_depth_at(query, columns->level_counts[slot]);
	const uint32_t first = query->summed ? 1 : depth, skipped = (first - 1) * esk_numbers(query->signature);
	const float *theirs = esk_columns_level_means(columns, slot, query->signature);
	const float unit = has_unit(query) ? columns->scales[slot] : 1;
	double cost = 0, magnitudes = 0;
	if (depth <= ESK_SUMMED_LEVELS)
		cost = mean_cost(query, bound->level_means + skipped, theirs + skipped, unit, depth - first + 1);
	for (uint32_t k = first; k <= depth && k <= ESK_SUMMED_LEVELS; k++)
		magnitudes += bound->level_magnitudes[k - 1];
	const double each = weight(query, depth) / (depth - first + 1);
	return safe(each * cost + esk_query_size_term(query, columns->log_volumes[slot]), each * magnitudes);
}

/* A shape's means over its levels 1..16 can be compared with the query's over the same levels only. */
static void scan_totals(const esk_bound *bound, const esk_columns *columns, uint32_t count, float *bounds)
{
	const esk_query *query = bound->query;
	const uint32_t numbers = esk_numbers(query->signature), depth = esk_query_depth_at(query, ESK_SUMMED_LEVELS);
	const float *mine = bound->total_means + (depth - 1) * numbers;
	const float *units = has_unit(query) ? columns->scales : NULL;
	const double each = weight(query, depth), magnitudes = each * bound->total_magnitudes[depth - 1];
	memset(bounds, 0, count * sizeof *bounds);
	for (uint32_t c = 0; c < numbers; c++)
		esk_columns_add_differences(columns->total_means[query->signature] + c * columns->capacity, units,
			mine[c], query->euclidean, count, bounds);
	for (uint32_t slot = 0; slot < count; slot++) {
		const uint32_t theirs = columns->level_counts[slot];
		double cost = query->euclidean ? sqrt((double)bounds[slot]) : (double)bounds[slot];
		double size = esk_query_size_term(query, columns->log_volumes[slot]);
		if (theirs == depth || (theirs > depth && depth == ESK_SUMMED_LEVELS))
			bounds[slot] = (float)safe(each * cost + size, magnitudes);
		else
			bounds[slot] = (float)esk_bound_by_means(bound, columns, slot);
	}
}

void esk_bound_scan(const esk_bound *bound, const esk_columns *columns, uint32_t count, float *bounds)
{
	if (bound->query->summed)
		scan_totals(bound, columns, count, bounds);
	else
		for (uint32_t slot = 0; slot < count; slot++)
			bounds[slot] = (float)esk_bound_by_means(bound, columns, slot);
}

/* The least cost of a level if each number could choose its own bijection. */
static double sorted_cost(const esk_query *query, uint32_t level, const float *mine, const float *theirs)
{
	const uint32_t numbers = esk_numbers(query->signature);
	if (!query->euclidean)
		return (double)sum_of_differences(mine, theirs, 1, numbers * level);
	double squares = 0;
	for (uint32_t c = 0; c < numbers; c++) {
		double cost = (double)sum_of_differences(mine + c * level, theirs + c * level, 1, level);
		squares += cost * cost;
	}
	return sqrt(squares);
}

double esk_bound_of_levels(const esk_query *query, const esk_shape *other, const double *levels)
{
	return safe(esk_query_combine(query, other, levels), 0);
}

/* Bounds of D_k by means, and by sorted numbers. */
static double level_by_means(const esk_bound *bound, const esk_columns *columns, uint32_t slot, uint32_t k)
{
	const esk_query *query = bound->query;
	const uint32_t skipped = (k - 1) * esk_numbers(query->signature);
	if (k > ESK_SUMMED_LEVELS)
		return 0;
	const float *theirs = esk_columns_level_means(columns, slot, query->signature) + skipped;
	const float unit = has_unit(query) ? columns->scales[slot] : 1;
	const double each = weight(query, k);
	return safe(each * mean_cost(query, bound->level_means + skipped, theirs, unit, 1),
		each * bound->level_magnitudes[k - 1]);
}

static double level_by_sorting(const esk_bound *bound, const esk_shape *shape, uint32_t k)
{
	const esk_query *query = bound->query;
	float scratch[ESK_LEVEL_FLOATS_MAX];
	const float *theirs = esk_query_sorted(query, shape, k, scratch);
	const double each = weight(query, k);
	return safe(
		each / k * sorted_cost(query, k, query->sorted[k - 1], theirs), each * bound->class_magnitudes[k - 1]);
}

double esk_bound_by_sorting(const esk_bound *bound, const esk_columns *columns, uint32_t slot, const esk_shape *shape,
	double enough, double *levels)
{
	const esk_query *query = bound->query;
	const uint32_t depth = esk_query_depth(query, shape), first = query->summed ? 1 : depth;
	for (uint32_t k = first; k <= depth; k++)
		levels[k - 1] = level_by_means(bound, columns, slot, k);
	double lower = 0;
	for (uint32_t k = first; k <= depth && lower <= enough; k++) {
		levels[k - 1] = level_by_sorting(bound, shape, k);
		lower = esk_bound_of_levels(query, shape, levels);
	}
	return lower;
}
