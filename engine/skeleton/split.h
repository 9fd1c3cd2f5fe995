/* Splitting one class in two (section 2.4.2). */
#ifndef ESK_SPLIT_H
#define ESK_SPLIT_H

#include "metric.h"

typedef struct {
	bool possible;     /* false: the class has no variance in the metric, and the rest is unset */
	bool degenerate;   /* the major axis was undefined */
	double ratio;      /* r = (w' V' + w'' V'') / (w V), to 2^-32 */
	esk_sums parts[2]; /* the heavier part first; on a tie the one of larger variance */
} esk_split;

/* No split of a class with these moments has a lesser ratio, on any machine; a class that cannot be split may have any. */
double esk_split_least_ratio(const esk_moments *moments, const esk_metric *metric);

/* The plane through the centre orthogonal to the major axis cuts the class, which is all of segments with the given
 * moments; two-class clustering of the class alone polishes the parts. The major axis is that of the class in the
 * space that axes_map takes u to: metric->map, but for the root of a whitened cloud. */
eskel_status esk_split_class(const esk_segment *segments, size_t segment_count, const esk_moments *moments,
	const esk_metric *metric, const eskel_affine *axes_map, esk_split *split);

#endif
