#include "scan.h"

#include "lanes.h"

#include <math.h>
#include <string.h>

esk_scan esk_scan_make(const esk_query *query, float weight)
{
	const esk_codes codes = esk_columns_codes(query->signature);
	return (esk_scan){
		.signature = query->signature,
		.metric = query->metric,
		.has_unit = query->signature == ESKEL_SIGNATURE_PAPER && query->size_counts,
		.step = codes.step,
		.origin = codes.origin,
		.weight = weight,
		.size_weight = (float)query->size_weight,
		.log_volume = query->shape->log_volume,
	};
}

/* Each code is off by half a step. All other rounding, of the numbers, of their differences and of the distance that is
 * bounded, is far below a quarter of a step and 2^-18 of the sum. */
ESK_IN_LANES float lower_of(
	const esk_scan *scan, float sum, float differences, float worth, float log_volume, eskel_metric metric)
{
	const float least = sum * (1 - 0x1p-18f), size = fabsf(log_volume - scan->log_volume);
	if (metric == ESKEL_METRIC_ROOT)
		return scan->weight * sqrtf(worth) * least + scan->size_weight * sqrtf(size) * (1 - 0x1p-18f);
	const float lower =
		scan->weight * worth * (least - (differences / 2 + 0.25f)) + scan->size_weight * size * (1 - 0x1p-18f);
	return lower > 0 ? lower : 0;
}

/* What a difference, in steps, adds to a sum. */
ESK_IN_LANES float term_of(float difference, eskel_metric metric)
{
	if (metric == ESKEL_METRIC_ROOT) {
		const float least = difference - ESK_SCAN_ROOT_ERROR;
		return sqrtf(least > 0 ? least : 0);
	}
	return metric == ESKEL_METRIC_EUCLIDEAN ? difference * difference : difference;
}

/* ---- columns */

/* Indices are of size_t: one that may wrap around would have to be gathered. */
ESK_IN_LANES void scan_columns(const esk_scan *scan, const esk_columns *columns, const uint16_t *restrict codes,
	const float *restrict mine, size_t count, float *restrict lower, size_t numbers, size_t each,
	eskel_metric metric, bool has_unit)
{
	const size_t capacity = columns->capacity;
	const float *restrict scales = columns->scales, *restrict log_volumes = columns->log_volumes;
	float above[ESK_HALVES_MAX];
	for (size_t h = 0; h < numbers * each; h++)
		above[h] = (mine[h] - scan->origin) / (has_unit ? 1 : scan->step);
	const esk_scan s = *scan;
	for (size_t slot = 0; slot < count; slot++) {
		const float worth = has_unit ? s.step * scales[slot] : s.step, steps = has_unit ? 1 / worth : 1;
		float sum = 0;
		for (size_t c = 0; c < numbers * each; c += each) {
			float difference = 0;
			for (size_t h = c; h < c + each; h++)
				difference += fabsf((float)codes[h * capacity + slot] - above[h] * steps);
			sum += term_of(difference, metric);
		}
		if (metric == ESKEL_METRIC_EUCLIDEAN)
			sum = sqrtf(sum);
		lower[slot] = lower_of(&s, sum, (float)(numbers * each), worth, log_volumes[slot], metric);
	}
}

ESK_IN_LANES void scan_any_columns(const esk_scan *scan, const esk_columns *columns, const uint16_t *codes, size_t each,
	const float *mine, size_t count, float *lower, eskel_metric metric)
{
	if (scan->signature == ESKEL_SIGNATURE_LOG)
		scan_columns(scan, columns, codes, mine, count, lower, ESK_NUMBERS_MAX, each, metric, false);
	else
		scan_columns(scan, columns, codes, mine, count, lower, ESK_PAPER_NUMBERS, each, metric, scan->has_unit);
}

ESK_EVERY_WIDTH void esk_scan_columns(const esk_scan *scan, const esk_columns *columns, const uint16_t *codes,
	bool halves, const float *mine, uint32_t count, float *lower)
{
	const size_t each = halves ? 2 : 1;
	if (scan->metric == ESKEL_METRIC_ROOT)
		scan_any_columns(scan, columns, codes, 1, mine, count, lower, ESKEL_METRIC_ROOT);
	else if (scan->metric == ESKEL_METRIC_EUCLIDEAN)
		scan_any_columns(scan, columns, codes, each, mine, count, lower, ESKEL_METRIC_EUCLIDEAN);
	else if (halves)
		scan_any_columns(scan, columns, codes, 2, mine, count, lower, ESKEL_METRIC_MANHATTAN);
	else
		scan_any_columns(scan, columns, codes, 1, mine, count, lower, ESKEL_METRIC_MANHATTAN);
}

/* ---- pairs */

enum { LANES = 16 };

/* The codes of sixteen slots, number by number; the last of fewer slots is repeated. */
ESK_IN_LANES void take_rows(const esk_scan *scan, const esk_columns *columns, const uint16_t *slots, size_t count,
	size_t numbers, uint16_t codes[][LANES], float *worths, float *log_volumes)
{
	for (size_t lane = 0; lane < LANES; lane++) {
		const uint16_t slot = slots[lane < count ? lane : count - 1];
		const uint16_t *row = esk_columns_second(columns, slot, scan->signature);
		for (size_t n = 0; n < 2 * numbers; n++)
			codes[n][lane] = row[n];
		worths[lane] = scan->has_unit ? scan->step * columns->scales[slot] : scan->step;
		log_volumes[lane] = columns->log_volumes[slot];
	}
}

/* Between class i of theirs and class j of mine. */
ESK_IN_LANES float class_distance(const esk_scan *scan, uint16_t codes[][LANES], size_t lane, size_t i,
	const float *mine, size_t j, float steps, size_t numbers, eskel_metric metric)
{
	float sum = 0;
	for (size_t c = 0; c < numbers; c++) {
		const float difference = (float)codes[i * numbers + c][lane] - (mine[2 * c + j] - scan->origin) * steps;
		sum += term_of(fabsf(difference), metric);
	}
	return metric == ESKEL_METRIC_EUCLIDEAN ? sqrtf(sum) : sum;
}

ESK_IN_LANES void scan_pairs(const esk_scan *scan, const esk_columns *columns, const float *mine, const uint16_t *slots,
	size_t count, float *lower, size_t numbers, eskel_metric metric)
{
	const esk_scan s = *scan;
	uint16_t codes[2 * ESK_NUMBERS_MAX][LANES];
	float worths[LANES], log_volumes[LANES], found[LANES];
	take_rows(scan, columns, slots, count, numbers, codes, worths, log_volumes);
	for (size_t lane = 0; lane < LANES; lane++) {
		const float steps = 1 / worths[lane];
		const float straight = class_distance(&s, codes, lane, 0, mine, 0, steps, numbers, metric) +
				       class_distance(&s, codes, lane, 1, mine, 1, steps, numbers, metric);
		const float crossed = class_distance(&s, codes, lane, 0, mine, 1, steps, numbers, metric) +
				      class_distance(&s, codes, lane, 1, mine, 0, steps, numbers, metric);
		found[lane] = lower_of(&s, straight < crossed ? straight : crossed, 2 * (float)numbers, worths[lane],
			log_volumes[lane], metric);
	}
	memcpy(lower, found, (count < LANES ? count : LANES) * sizeof *lower);
}

ESK_EVERY_WIDTH void esk_scan_pairs(const esk_scan *scan, const esk_columns *columns, const float *mine,
	const uint16_t *slots, uint32_t count, float *lower)
{
	for (size_t i = 0; i < count; i += LANES) {
		if (scan->signature == ESKEL_SIGNATURE_PAPER)
			scan_pairs(
				scan, columns, mine, slots + i, count - i, lower + i, ESK_PAPER_NUMBERS, scan->metric);
		else if (scan->metric == ESKEL_METRIC_ROOT)
			scan_pairs(scan, columns, mine, slots + i, count - i, lower + i, ESK_NUMBERS_MAX,
				ESKEL_METRIC_ROOT);
		else if (scan->metric == ESKEL_METRIC_EUCLIDEAN)
			scan_pairs(scan, columns, mine, slots + i, count - i, lower + i, ESK_NUMBERS_MAX,
				ESKEL_METRIC_EUCLIDEAN);
		else
			scan_pairs(scan, columns, mine, slots + i, count - i, lower + i, ESK_NUMBERS_MAX,
				ESKEL_METRIC_MANHATTAN);
	}
}
