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

/* What the lower bound of a mean pair cost, averaged over the levels that count, is worth in the distance. */
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

/* The factor that brings size-free means to the query's units. */
static float unit_of(const esk_query *query, esk_shape shape)
{
	return query->signature == ESKEL_SIGNATURE_PAPER && query->size_counts ? esk_shape_scale(shape) : 1;
}

void esk_bound_init(esk_bound *bound, const esk_query *query)
{
	const uint32_t numbers = esk_numbers(query->signature), levels = esk_shape_level_count(query->shape);
	const float *means = esk_shape_level_means(query->shape, query->signature);
	const float unit = unit_of(query, query->shape);
	double sums[ESK_NUMBERS_MAX] = {0};
	*bound = (esk_bound){.query = query};
	for (uint32_t k = 1; k <= levels; k++)
		bound->magnitudes[k - 1] = magnitude(query->rows[k - 1], numbers * k) / k;
	for (uint32_t k = 1; k <= levels && k <= ESK_SUMMED_LEVELS; k++) {
		for (uint32_t c = 0; c < numbers; c++) {
			float mean = means[(k - 1) * numbers + c] * unit;
			sums[c] += (double)mean;
			bound->level_means[k - 1][c] = mean;
			bound->total_means[k - 1][c] = (float)(sums[c] / k);
		}
		bound->level_magnitudes[k - 1] = magnitude(bound->level_means[k - 1], numbers);
		bound->total_magnitudes[k - 1] = magnitude(bound->total_means[k - 1], numbers);
	}
}

/* The norm, in the query's metric, of the differences of two means. */
static double mean_cost(const esk_query *query, const float *mine, const float *theirs, float unit)
{
	float sum = 0;
	for (uint32_t c = 0; c < esk_numbers(query->signature); c++) {
		float difference = theirs[c] * unit - mine[c];
		sum += query->euclidean ? difference * difference : fabsf(difference);
	}
	return (double)(query->euclidean ? sqrtf(sum) : sum);
}

double esk_bound_by_means(const esk_bound *bound, esk_shape other)
{
	const esk_query *query = bound->query;
	const uint32_t depth = esk_query_depth(query, other), first = query->summed ? 1 : depth;
	const float *theirs = esk_shape_level_means(other, query->signature), unit = unit_of(query, other);
	double cost = 0, magnitudes = 0;
	for (uint32_t k = first; k <= depth && k <= ESK_SUMMED_LEVELS; k++) {
		cost += mean_cost(
			query, bound->level_means[k - 1], theirs + (k - 1) * esk_numbers(query->signature), unit);
		magnitudes += bound->level_magnitudes[k - 1];
	}
	const double each = weight(query, depth) / (depth - first + 1);
	return safe(each * cost + esk_query_size_term(query, other), each * magnitudes);
}

/* The means over levels 1..16 of a shape are of use only when all those levels count. */
static double total_bound(const esk_bound *bound, esk_shape other)
{
	const esk_query *query = bound->query;
	const uint32_t depth = esk_query_depth(query, other), capacity = other.columns->capacity;
	const uint32_t theirs = esk_shape_level_count(other);
	double size = esk_query_size_term(query, other);
	if (depth < theirs && depth < ESK_SUMMED_LEVELS)
		return safe(size, 0);
	float means[ESK_NUMBERS_MAX];
	for (uint32_t c = 0; c < esk_numbers(query->signature); c++)
		means[c] = other.columns->total_means[query->signature][c * capacity + other.slot];
	double cost = mean_cost(query, bound->total_means[depth - 1], means, unit_of(query, other));
	double each = weight(query, depth);
	return safe(each * cost + size, each * bound->total_magnitudes[depth - 1]);
}

void esk_bound_scan(const esk_bound *bound, const esk_columns *columns, uint32_t count, float *bounds)
{
	for (uint32_t slot = 0; slot < count; slot++) {
		const esk_shape other = {columns, slot};
		double lower = bound->query->summed ? total_bound(bound, other) : esk_bound_by_means(bound, other);
		bounds[slot] = (float)lower;
	}
}

/* The least cost of a level if each number could choose its own bijection. */
static double sorted_cost(const esk_query *query, uint32_t level, const float *mine, const float *theirs)
{
	double cost = 0;
	for (uint32_t c = 0; c < esk_numbers(query->signature); c++) {
		float sum = 0;
		for (uint32_t i = 0; i < level; i++)
			sum += fabsf(mine[c * level + i] - theirs[c * level + i]);
		cost += query->euclidean ? (double)sum * (double)sum : (double)sum;
	}
	return query->euclidean ? sqrt(cost) : cost;
}

double esk_bound_of_levels(const esk_query *query, esk_shape other, const double *levels)
{
	return safe(esk_query_combine(query, other, levels), 0);
}

double esk_bound_by_sorting(const esk_bound *bound, esk_shape other, double *levels)
{
	const esk_query *query = bound->query;
	const uint32_t depth = esk_query_depth(query, other), first = query->summed ? 1 : depth;
	float scratch[ESK_LEVEL_FLOATS_MAX];
	for (uint32_t k = first; k <= depth; k++) {
		const float *theirs = esk_query_sorted(query, other, k, scratch);
		double each = query->signature == ESKEL_SIGNATURE_LOG ? 1.0 / k : 1;
		double cost = sorted_cost(query, k, query->sorted[k - 1], theirs);
		levels[k - 1] = safe(each * cost, each * k * bound->magnitudes[k - 1]);
	}
	return esk_bound_of_levels(query, other, levels);
}
