#include "bound.h"

#include <math.h>
#include <string.h>

/* Compiled for wide registers too, chosen at run time. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
	!defined(__SANITIZE_THREAD__)
#define ESK_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ESK_WIDE
#endif

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
	const float bottom = esk_columns_codes(query->signature).origin;
	double sums[ESK_NUMBERS_MAX] = {0};
	*bound = (esk_bound){.query = query};
	for (uint32_t k = 1; k <= levels; k++)
		bound->class_magnitudes[k - 1] = magnitude(query->rows[k - 1], numbers * k) / k;
	for (uint32_t k = 1; k <= levels && k <= ESK_SUMMED_LEVELS; k++) {
		float *halves = bound->halves + (k - 1) * 2 * numbers, *total = bound->total_means + (k - 1) * numbers;
		esk_shape_halves(query->shape, query->signature, k, halves);
		for (uint32_t h = 0; h < 2 * numbers; h++) {
			halves[h] *= unit;
			sums[h / 2] += (double)halves[h];
			halves[h] = fmaxf(halves[h], bottom);
		}
		for (uint32_t c = 0; c < numbers; c++)
			total[c] = (float)(sums[c] / k);
		bound->halves_magnitudes[k] = bound->halves_magnitudes[k - 1] + magnitude(halves, 2 * numbers);
		bound->total_magnitudes[k - 1] = magnitude(total, numbers);
	}
}

/* Rows of halves against the query's, in its units. Theirs stand for origin + code * step, and the query's are brought
 * below top as theirs were (columns.h); from below it has been done before. */
typedef struct {
	float origin, step, top;
} scaled_codes;

static inline __attribute__((always_inline)) float halves_difference(
	const scaled_codes *codes, const float *mine, const uint8_t *theirs)
{
	const float inside = *mine < codes->top ? *mine : codes->top;
	return fabsf(inside - (codes->origin + (float)*theirs * codes->step));
}

/* In sixteen lanes: the same sum, and so the same shapes discarded, on any processor. */
ESK_WIDE static float sum_of_halves(const scaled_codes *codes, const float *mine, const uint8_t *theirs, uint32_t count)
{
	float lanes[16] = {0};
	uint32_t n = 0;
	for (; n + 16 <= count; n += 16)
		for (uint32_t lane = 0; lane < 16; lane++)
			lanes[lane] += halves_difference(codes, mine + n + lane, theirs + n + lane);
	for (uint32_t lane = 0; n < count; n++, lane++)
		lanes[lane] += halves_difference(codes, mine + n, theirs + n);
	for (uint32_t width = 8; width > 0; width /= 2)
		for (uint32_t lane = 0; lane < width; lane++)
			lanes[lane] += lanes[lane + width];
	return lanes[0];
}

static float euclidean_halves(const scaled_codes *codes, const float *mine, const uint8_t *theirs, uint32_t numbers)
{
	float squares = 0;
	for (uint32_t h = 0; h < 2 * numbers; h += 2) {
		float difference = halves_difference(codes, mine + h, theirs + h) +
				   halves_difference(codes, mine + h + 1, theirs + h + 1);
		squares += difference * difference;
	}
	return sqrtf(squares);
}

/* The cost of levels first..last, per class, summed; less what rounding may have added. */
static double halves_cost(
	const esk_bound *bound, const esk_columns *columns, uint32_t slot, uint32_t first, uint32_t last)
{
	const esk_query *query = bound->query;
	const uint32_t row = 2 * esk_numbers(query->signature), skipped = (first - 1) * row;
	const esk_codes plain = esk_columns_codes(query->signature);
	const float unit = has_unit(query) ? columns->scales[slot] : 1;
	const scaled_codes codes = {plain.origin, plain.step * unit, plain.top * unit};
	const float *mine = bound->halves + skipped;
	const uint8_t *theirs = esk_columns_halves(columns, slot, query->signature) + skipped;
	const uint32_t count = (last - first + 1) * row, most = count / 2;
	double cost = 0;
	if (!query->euclidean)
		cost = (double)sum_of_halves(&codes, mine, theirs, count);
	else
		for (uint32_t n = 0; n < count; n += row)
			cost += (double)euclidean_halves(&codes, mine + n, theirs + n, row / 2);
	/* A rounding is at most half a step. */
	const uint32_t slack = columns->slacks[query->signature][slot];
	return cost - (double)(slack < most ? slack : most) * (double)codes.step;
}

/* Of the levels first..last that are among 1..16, together. */
static double by_halves(
	const esk_bound *bound, const esk_columns *columns, uint32_t slot, uint32_t first, uint32_t last, double each)
{
	if (last > ESK_SUMMED_LEVELS)
		return 0;
	const double cost = halves_cost(bound, columns, slot, first, last);
	const double magnitudes = bound->halves_magnitudes[last] - bound->halves_magnitudes[first - 1];
	return fmax(0, safe(each * cost, each * magnitudes));
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

double esk_bound_by_halves(const esk_bound *bound, const esk_columns *columns, uint32_t slot)
{
	const esk_query *query = bound->query;
	const uint32_t depth = esk_query_depth_at(query, columns->level_counts[slot]),
		       first = query->summed ? 1 : depth;
	const double size = esk_query_size_term(query, columns->log_volumes[slot]);
	return by_halves(bound, columns, slot, first, depth, weight(query, depth) / (depth - first + 1)) +
	       safe(size, 0);
}

double esk_bound_of_level(const esk_bound *bound, const esk_columns *columns, uint32_t slot, uint32_t level)
{
	return by_halves(bound, columns, slot, level, level, weight(bound->query, level));
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
			bounds[slot] = (float)esk_bound_by_halves(bound, columns, slot);
	}
}

void esk_bound_scan(const esk_bound *bound, const esk_columns *columns, uint32_t count, float *bounds)
{
	if (bound->query->summed)
		scan_totals(bound, columns, count, bounds);
	else
		for (uint32_t slot = 0; slot < count; slot++)
			bounds[slot] = (float)esk_bound_by_halves(bound, columns, slot);
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
		levels[k - 1] = esk_bound_of_level(bound, columns, slot, k);
	double lower = 0;
	for (uint32_t k = first; k <= depth && lower <= enough; k++) {
		levels[k - 1] = level_by_sorting(bound, shape, k);
		lower = esk_bound_of_levels(query, shape, levels);
	}
	return lower;
}
