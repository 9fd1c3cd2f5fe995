#include "bound.h"

#include "class_costs.h"
#include "halves.h"
#include "lanes.h"

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

/* Lengths are kept size-free. */
static bool has_unit(const esk_query *query)
{
	return query->signature == ESKEL_SIGNATURE_PAPER && query->size_counts;
}

typedef struct {
	uint32_t first, last;
	double each; /* what a level's mean pair cost is worth */
} level_range;

static level_range levels_that_count(const esk_query *query, uint32_t their_levels)
{
	const uint32_t depth = esk_query_depth_at(query, their_levels), first = query->summed ? 1 : depth;
	return (level_range){first, depth, weight(query, depth) / (depth - first + 1)};
}

/* ---- the query's side */

static double magnitude(const float *numbers, uint32_t count)
{
	double sum = 0;
	for (uint32_t n = 0; n < count; n++)
		sum += fabs((double)numbers[n]);
	return sum;
}

static void prepare_halves(esk_bound *bound, uint32_t k)
{
	const esk_query *query = bound->query;
	const uint32_t numbers = esk_numbers(query->signature), depth = esk_query_depth_at(query, ESK_SUMMED_LEVELS);
	const float unit = has_unit(query) ? query->shape->scale : 1;
	float *halves = bound->halves + (k - 1) * 2 * numbers;
	esk_shape_halves(query->shape, query->signature, k, halves);
	for (uint32_t h = 0; h < 2 * numbers; h++) {
		halves[h] *= unit;
		bound->total_halves[h] += k <= depth ? halves[h] / (float)depth : 0;
	}
	bound->halves_magnitudes[k] = bound->halves_magnitudes[k - 1] + magnitude(halves, 2 * numbers);
	for (uint32_t h = 0; h < 2 * numbers; h++)
		halves[h] = fmaxf(halves[h] - esk_columns_half_codes(query->signature, h / 2).origin, 0);
	for (uint32_t c = 0; c < numbers; c++)
		bound->root_worths[(k - 1) * numbers + c] = 1 / sqrtf((float)k);
}

static void prepare_sorted(esk_bound *bound, uint32_t k)
{
	const esk_query *query = bound->query;
	const uint32_t numbers = esk_numbers(query->signature) * k,
		       first = ESK_NUMBERS_MAX * (uint32_t)ESKEL_NODES(k - 1);
	memcpy(bound->sorted + first, query->sorted[k - 1], numbers * sizeof *bound->sorted);
	for (uint32_t n = 0; n < numbers; n++)
		bound->worths[first + n] = 1 / (float)k;
}

void esk_bound_init(esk_bound *bound, const esk_query *query)
{
	const uint32_t numbers = esk_numbers(query->signature), levels = query->shape->level_count;
	const uint32_t depth = esk_query_depth_at(query, ESK_SUMMED_LEVELS);
	*bound = (esk_bound){.query = query,
		.over_levels = query->summed && query->metric != ESKEL_METRIC_ROOT,
		.scan = esk_scan_make(query, (float)weight(query, depth))};
	for (uint32_t k = 1; k <= levels; k++)
		bound->class_magnitudes[k] =
			bound->class_magnitudes[k - 1] + magnitude(query->rows[k - 1], numbers * k) / k;
	for (uint32_t k = 1; k <= levels && k <= ESK_SUMMED_LEVELS; k++) {
		prepare_halves(bound, k);
		prepare_sorted(bound, k);
	}
}

/* ---- sums */

enum { LANES = 16 };

/* Always in sixteen lanes: the same sum, and so the same shapes discarded, on any processor. Indices are of size_t: one that
 * may wrap around would have to be gathered. */
ESK_IN_LANES float sum_of_lanes(float *lanes)
{
	for (size_t width = LANES / 2; width > 0; width /= 2)
		for (size_t lane = 0; lane < width; lane++)
			lanes[lane] += lanes[lane + width];
	return lanes[0];
}

/* ---- halves, counted in steps of their codes */

static float euclidean_halves(const float *mine, size_t count, const uint8_t *theirs, float steps, uint32_t numbers)
{
	float sum = 0;
	for (size_t n = 0; n < count; n += (size_t)2 * numbers) {
		float squares = 0;
		for (size_t h = n; h < n + (size_t)2 * numbers; h += 2) {
			const float difference = fabsf(fminf(mine[h] * steps, 255) - (float)theirs[h]) +
						 fabsf(fminf(mine[h + 1] * steps, 255) - (float)theirs[h + 1]);
			squares += difference * difference;
		}
		sum += sqrtf(squares);
	}
	return sum;
}

ESK_IN_LANES float at_most(float number, float most)
{
	return number < most ? number : most;
}

/* A level's mean pair cost is at least sqrt(k m) / k for a number with k m in its k differences, of which the halves
 * show m or less. A byte is off by at most half a step, so the halves of a number by one; all other rounding is far below
 * a sixteenth. */
ESK_IN_LANES float root_of_halves(const float *mine, const uint8_t *theirs, float steps)
{
	const float difference = fabsf(at_most(mine[0] * steps, 255) - (float)theirs[0]) +
				 fabsf(at_most(mine[1] * steps, 255) - (float)theirs[1]) - 1.0625f;
	return sqrtf(difference > 0 ? difference : 0);
}

ESK_EVERY_WIDTH static float rooted_halves(
	const float *mine, const float *worths, size_t count, const uint8_t *theirs, float steps)
{
	float lanes[LANES] = {0};
	size_t n = 0;
	for (; n + LANES <= count; n += LANES)
		for (size_t lane = 0; lane < LANES; lane++)
			lanes[lane] += root_of_halves(mine + 2 * (n + lane), theirs + 2 * (n + lane), steps) *
				       worths[n + lane];
	for (size_t lane = 0; n < count; n++, lane++)
		lanes[lane] += root_of_halves(mine + 2 * n, theirs + 2 * n, steps) * worths[n];
	return sum_of_lanes(lanes);
}

enum { AT_ONCE = 64 };

/* For each of these slots: what the levels, which all have, add to the distance at least. */
static void by_halves(const esk_bound *bound, const esk_columns *columns, const uint16_t *slots, uint32_t count,
	level_range levels, float *bounds)
{
	const esk_query *query = bound->query;
	const eskel_signature_kind kind = query->signature;
	const uint32_t numbers = esk_numbers(kind);
	const size_t row = ESK_SUMMED_LEVELS * (size_t)2 * numbers;
	const size_t begin = (levels.first - 1) * (size_t)2 * numbers, end = levels.last * (size_t)2 * numbers;
	const float step = esk_columns_half_codes(kind, 0).step, most = (float)(end - begin) / 2;
	const double magnitudes = bound->halves_magnitudes[levels.last] - bound->halves_magnitudes[levels.first - 1];
	const float each = (float)(levels.each * (1 - relative_margin));
	const float margin = (float)(levels.each * absolute_margin * magnitudes);
	const uint8_t *rows[AT_ONCE];
	float worths[AT_ONCE], steps[AT_ONCE], sums[AT_ONCE], slacks[AT_ONCE];
	for (uint32_t i = 0; i < count; i++) {
		worths[i] = has_unit(query) ? step * columns->scales[slots[i]] : step;
		slacks[i] = columns->slacks[kind][slots[i]];
		rows[i] = esk_columns_halves(columns, slots[i], kind);
	}
	for (size_t i = 0; i < count; i++)
		steps[i] = 1 / worths[i];
	if (query->metric == ESKEL_METRIC_MANHATTAN)
		esk_halves_sum(bound->halves, begin, end, row, rows, steps, count, sums);
	for (uint32_t i = 0; query->metric == ESKEL_METRIC_EUCLIDEAN && i < count; i++)
		sums[i] = euclidean_halves(bound->halves + begin, end - begin, rows[i] + begin, steps[i], numbers);
	for (uint32_t i = 0; query->metric == ESKEL_METRIC_ROOT && i < count; i++) {
		sums[i] = rooted_halves(bound->halves + begin, bound->root_worths + begin / 2, (end - begin) / 2,
			rows[i] + begin, steps[i]);
		worths[i] = sqrtf(worths[i]);
		slacks[i] = 0;
	}
	for (size_t i = 0; i < count; i++) {
		/* A rounding is at most half a step. */
		const float least = (sums[i] - (slacks[i] < most ? slacks[i] : most)) * worths[i];
		const float lower = each * least - margin;
		bounds[i] = lower > 0 ? lower : 0;
	}
}

/* How many of these slots' shapes, from the first on, share the same levels with the query. */
static uint32_t count_alike(const esk_bound *bound, esk_columns *columns, const uint16_t *slots, uint32_t count)
{
	const uint32_t depth = esk_query_depth_at(bound->query, columns->level_counts[slots[0]]),
		       most = count < AT_ONCE ? count : AT_ONCE;
	uint32_t alike = 1;
	if (esk_query_depth_at(bound->query, esk_columns_least_levels(columns)) ==
		esk_query_depth_at(bound->query, ESKEL_LEVELS_MAX))
		return most;
	while (alike < most && esk_query_depth_at(bound->query, columns->level_counts[slots[alike]]) == depth)
		alike++;
	return alike;
}

void esk_bound_by_halves(
	const esk_bound *bound, esk_columns *columns, const uint16_t *slots, uint32_t count, float *bounds)
{
	const esk_query *query = bound->query;
	for (uint32_t i = 0, alike; i < count; i += alike) {
		const level_range levels = levels_that_count(query, columns->level_counts[slots[i]]);
		alike = count_alike(bound, columns, slots + i, count - i);
		if (levels.last <= ESK_SUMMED_LEVELS)
			by_halves(bound, columns, slots + i, alike, levels, bounds + i);
		else
			memset(bounds + i, 0, alike * sizeof *bounds);
	}
	const float size_weight = (float)(query->size_weight * (1 - relative_margin)),
		    log_volume = query->shape->log_volume;
	for (size_t i = 0; size_weight > 0 && i < count; i++) {
		const float difference = fabsf(columns->log_volumes[slots[i]] - log_volume);
		bounds[i] += size_weight * (query->metric == ESKEL_METRIC_ROOT ? sqrtf(difference) : difference);
	}
}

static double level_by_halves(const esk_bound *bound, const esk_columns *columns, uint32_t slot, level_range levels)
{
	float lower = 0;
	if (levels.last <= ESK_SUMMED_LEVELS)
		by_halves(bound, columns, (uint16_t[]){(uint16_t)slot}, 1, levels, &lower);
	return (double)lower;
}

/* ---- scan */

/* A shape's halves over its levels 1..16 can be compared with the query's over the same levels only. */
static bool has_totals(const esk_bound *bound, uint32_t their_levels)
{
	const uint32_t depth = esk_query_depth_at(bound->query, ESK_SUMMED_LEVELS);
	return depth == ESK_SUMMED_LEVELS ? their_levels >= depth : their_levels == depth;
}

static void scan_totals(const esk_bound *bound, esk_columns *columns, uint32_t count, float *bounds)
{
	esk_scan_columns(&bound->scan, columns, columns->total_halves[bound->query->signature], true,
		bound->total_halves, count, bounds);
	if (has_totals(bound, ESK_SUMMED_LEVELS) && esk_columns_are_plain(columns, ESK_SUMMED_LEVELS))
		return;
	for (uint32_t slot = 0; slot < count; slot++) {
		const uint16_t slots[1] = {(uint16_t)slot};
		if (columns->odd[slot] || !has_totals(bound, columns->level_counts[slot]))
			esk_bound_by_halves(bound, columns, slots, 1, &bounds[slot]);
	}
}

static void ask_level(const esk_bound *bound, const esk_columns *columns, uint32_t begin, uint32_t end)
{
	const uint32_t level = esk_query_depth_at(bound->query, ESK_SUMMED_LEVELS);
	const size_t size = (size_t)2 * esk_numbers(bound->query->signature);
	for (uint32_t slot = begin; slot < end && slot < columns->capacity; slot++) {
		const uint8_t *halves = esk_columns_halves(columns, slot, bound->query->signature) + (level - 1) * size;
		__builtin_prefetch(halves);
		__builtin_prefetch(halves + size - 1);
	}
}

void esk_bound_scan(const esk_bound *bound, esk_columns *columns, uint32_t count, float *bounds)
{
	if (bound->over_levels) {
		scan_totals(bound, columns, count, bounds);
		return;
	}
	uint16_t slots[AT_ONCE];
	for (uint32_t slot = 0; slot < count; slot += AT_ONCE) {
		const uint32_t some = count - slot < AT_ONCE ? count - slot : AT_ONCE;
		for (uint32_t i = 0; i < some; i++)
			slots[i] = (uint16_t)(slot + i);
		if (!bound->query->summed)
			ask_level(bound, columns, slot + AT_ONCE, slot + 2 * AT_ONCE);
		esk_bound_by_halves(bound, columns, slots, some, bounds + slot);
	}
}

/* ---- sorted numbers */

ESK_IN_LANES float number_of(float feature, bool are_lengths, float unit)
{
	return are_lengths ? esk_shape_length(feature) * unit : feature;
}

ESK_IN_LANES float sum_of_differences(
	const float *mine, const float *worths, const float *features, size_t count, bool are_lengths, float unit)
{
	float lanes[LANES] = {0};
	size_t n = 0;
	for (; n + LANES <= count; n += LANES)
		for (size_t lane = 0; lane < LANES; lane++)
			lanes[lane] += fabsf(number_of(features[n + lane], are_lengths, unit) - mine[n + lane]) *
				       worths[n + lane];
	for (size_t lane = 0; n < count; n++, lane++)
		lanes[lane] += fabsf(number_of(features[n], are_lengths, unit) - mine[n]) * worths[n];
	return sum_of_lanes(lanes);
}

/* The mean pair cost of levels first..last of 1..16, summed, if each number could choose its own bijection. */
ESK_EVERY_WIDTH static float sorted_cost(const esk_bound *bound, const esk_shape *shape, uint32_t first, uint32_t last)
{
	const size_t begin = ESK_NUMBERS_MAX * ESKEL_NODES(first - 1),
		     count = ESK_NUMBERS_MAX * ESKEL_NODES(last) - begin;
	const float *mine = bound->sorted + begin, *worths = bound->worths + begin;
	const float *features = esk_shape_sorted(shape, first);
	if (bound->query->signature == ESKEL_SIGNATURE_LOG)
		return sum_of_differences(mine, worths, features, count, false, 1);
	return sum_of_differences(mine, worths, features, count, true, has_unit(bound->query) ? shape->scale : 1);
}

/* The same for any level and metric. */
static float sorted_cost_of_level(const esk_query *query, const esk_shape *shape, uint32_t k)
{
	const uint32_t numbers = esk_numbers(query->signature);
	float scratch[ESK_LEVEL_FLOATS_MAX], sum = 0;
	const float *theirs = esk_query_sorted(query, shape, k, scratch), *mine = query->sorted[k - 1];
	for (uint32_t c = 0; c < numbers; c++) {
		float difference = 0;
		for (uint32_t i = c * k; i < (c + 1) * k; i++)
			difference += fabsf(theirs[i] - mine[i]);
		if (query->metric == ESKEL_METRIC_EUCLIDEAN)
			difference *= difference;
		sum += query->metric == ESKEL_METRIC_ROOT ? sqrtf(difference) : difference;
	}
	return (query->metric == ESKEL_METRIC_EUCLIDEAN ? sqrtf(sum) : sum) / (float)k;
}

/* The mean pair cost of a level if every class were given the nearest of the other shape: for roots, where sorted numbers say
 * little, as the far ones cost little more than the near ones. */
static float nearest_cost_of_level(const esk_query *query, const esk_shape *shape, uint32_t k)
{
	const uint32_t numbers = esk_numbers(query->signature);
	float scratch[ESK_LEVEL_FLOATS_MAX], theirs[ESK_LEVEL_FLOATS_MAX];
	esk_shape_unsort(shape, k, esk_query_sorted(query, shape, k, scratch), numbers, theirs);
	return esk_class_costs_nearest(numbers, k, query->rows[k - 1], theirs) / (float)k;
}

static double sorted_costs(const esk_bound *bound, const esk_shape *shape, uint32_t first, uint32_t last)
{
	if (bound->query->metric == ESKEL_METRIC_MANHATTAN && last <= ESK_SUMMED_LEVELS)
		return (double)sorted_cost(bound, shape, first, last);
	double sum = 0;
	for (uint32_t k = first; k <= last; k++)
		sum += (double)(bound->query->metric == ESKEL_METRIC_ROOT
					? nearest_cost_of_level(bound->query, shape, k)
					: sorted_cost_of_level(bound->query, shape, k));
	return sum;
}

/* What levels first..last add to the distance at least. */
static double by_sorting(const esk_bound *bound, const esk_shape *shape, uint32_t first, uint32_t last, double each)
{
	const double magnitudes = bound->class_magnitudes[last] - bound->class_magnitudes[first - 1];
	return safe(each * sorted_costs(bound, shape, first, last), each * magnitudes);
}

double esk_bound_by_sorting(const esk_bound *bound, const esk_columns *columns, uint32_t slot, const esk_shape *shape,
	uint32_t first, uint32_t last, double *sorted)
{
	level_range counting = levels_that_count(bound->query, shape->level_count);
	const double size = safe(esk_query_size_term(bound->query, shape->log_volume), 0);
	if (first < counting.first)
		first = counting.first;
	if (last > counting.last)
		last = counting.last;
	if (first <= last)
		*sorted += by_sorting(bound, shape, first, last, counting.each);
	if (counting.first <= last)
		counting.first = last + 1;
	return *sorted + size + (counting.first <= counting.last ? level_by_halves(bound, columns, slot, counting) : 0);
}

void esk_bound_levels(const esk_bound *bound, const esk_shape *shape, double *levels)
{
	const level_range counting = levels_that_count(bound->query, shape->level_count);
	for (uint32_t k = counting.first; k <= counting.last; k++)
		levels[k - 1] = by_sorting(bound, shape, k, k, weight(bound->query, k));
}

double esk_bound_of_levels(const esk_query *query, const esk_shape *other, const double *levels)
{
	return safe(esk_query_combine(query, other, levels), 0);
}
