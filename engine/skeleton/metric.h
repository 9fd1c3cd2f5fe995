/* The metric of a partition: which distance between voxels counts (sections 2.3 and 2.4.6). */
#ifndef ESK_METRIC_H
#define ESK_METRIC_H

#include "moments.h"

/* The squared distance of u and v is (u - v)^T form (u - v), up to a common factor. form is integer, so that the
 * partition can be exact; map takes u to a space in which that distance is Euclidean, to rounding. */
typedef struct {
	int64_t form[3][3]; /* symmetric; the greatest entry is 2^40 */
	eskel_affine map;
	int half[3]; /* |u_r| <= half[r] */
	int shift;   /* scores are scaled by 2^shift, see scores.h */
} esk_metric;

/* World distance. */
void esk_metric_euclidean(const eskel_cloud *cloud, esk_metric *metric);

/* Distance after whitening the whole cloud, of these moments: every direction of its covariance is brought to
 * variance 1, or to 0 where it is flat. The affine does not matter: M_world = A M A^T gives
 * A^T M_world^-1 A = M^-1. */
eskel_status esk_metric_mahalanobis(const eskel_cloud *cloud, const esk_moments *moments, esk_metric *metric);

#endif
