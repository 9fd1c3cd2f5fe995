/* Scans over the codes of columns and of rows of level 2 (columns.h): distances within a stated error.
 *
 * All is counted in steps of the codes, so that a code needs only a conversion; the query's numbers, which are few, are
 * scaled. Where size counts in the paper's signature, a step is worth step * scale of the slot.
 *
 * What is scanned lies between lower and lower + esk_scan_width, unless the slot is odd. */
#ifndef ESK_SCAN_H
#define ESK_SCAN_H

#include "columns.h"
#include "distance.h"

/* How far a difference is off at most, in steps: a code is by half a step, and rounding by far less than a sixteenth. It
 * is taken off before a root, which is then too small by sqrt(x + e) - sqrt(max(x - e, 0)) <= sqrt(2 e), the most at x = e. */
#define ESK_SCAN_ROOT_ERROR 0.5625f

/* The query's side of a scan. */
typedef struct {
	eskel_signature_kind signature;
	eskel_metric metric;
	bool has_unit;
	float step, origin;
	float weight;      /* what the sum of differences is worth in the distance */
	float size_weight; /* 0: sizes add nothing */
	float log_volume;
} esk_scan;

esk_scan esk_scan_make(const esk_query *query, float weight);

/* For the first count slots: weight times the sum over numbers of the differences between a column and one of mine, or of
 * their roots, plus the size term. With halves there are two columns a number; of halves no roots are taken. */
void esk_scan_columns(const esk_scan *scan, const esk_columns *columns, const uint16_t *codes, bool halves,
	const float *mine, uint32_t count, float *lower);
/* For each of these slots, which have level 2: the same for the least matching of its two classes with the two of mine,
 * whose rows hold a number of both classes each. */
void esk_scan_pairs(const esk_scan *scan, const esk_columns *columns, const float *mine, const uint16_t *slots,
	uint32_t count, float *lower);

/* Of a sum of so many differences up to lower, in a slot of this scale. */
static inline float esk_scan_width(const esk_scan *scan, float differences, float lower, float scale)
{
	const float worth = scan->has_unit ? scan->step * scale : scan->step, rounding = 2.01f * 0x1p-18f * lower;
	if (scan->metric == ESKEL_METRIC_ROOT)
		return 1.01f * scan->weight * sqrtf(worth) * differences * sqrtf(2 * ESK_SCAN_ROOT_ERROR) + rounding;
	return 2.01f * scan->weight * worth * (differences / 2 + 0.25f) + rounding;
}

#endif
