/* Exact moments of sets of voxels (section 2.1).
 *
 * Coordinates are doubled and centred: u = 2 x - (extent - 1), so that the origin is the exact centre of the cloud's
 * box, every u is an integer, and mirroring a cloud only negates u. All sums are integers and therefore the same for
 * any order of summation, any number of threads and any machine. */
#ifndef ESK_MOMENTS_H
#define ESK_MOMENTS_H

#include "eskel.h"

__extension__ typedef __int128 esk_int128;

/* Consecutive voxels along x, each of the same weight; both ends included. */
typedef struct {
	int32_t x_first, x_last, y, z; /* doubled and centred, so neighbours along x differ by 2 */
	uint64_t weight;
} esk_segment;

typedef struct {
	uint64_t weight;
	int64_t first[3]; /* sum of w u */
} esk_sums;

/* A cloud's bounds (at most 2^33 voxels, a weight sum of at most 2^44, |u| < 2^16) bound first by 2^60, second by
 * 2^76 and the products in a scatter matrix by 2^120. */
typedef struct {
	uint64_t voxels;
	esk_sums sums;
	esk_int128 second[3][3]; /* sum of w u_r u_c, for r <= c */
} esk_moments;

/* Writes the cloud's runs as run_count segments. */
void esk_segments_from_cloud(const eskel_cloud *cloud, esk_segment *segments);

/* Doubled centred coordinates to world mm. */
eskel_affine esk_segments_world(const eskel_cloud *cloud);

static inline uint64_t esk_segment_voxels(const esk_segment *s)
{
	return (uint64_t)(s->x_last - s->x_first) / 2 + 1;
}

static inline void esk_sums_add(esk_sums *sums, const esk_segment *s)
{
	int64_t weight = (int64_t)(s->weight * esk_segment_voxels(s));
	sums->weight += (uint64_t)weight;
	sums->first[0] += weight * ((s->x_first + s->x_last) / 2); /* both ends have one parity: the mean is exact */
	sums->first[1] += weight * s->y;
	sums->first[2] += weight * s->z;
}

static inline void esk_sums_remove(esk_sums *sums, const esk_segment *s)
{
	esk_sums part = {0};
	esk_sums_add(&part, s);
	sums->weight -= part.weight;
	for (int r = 0; r < 3; r++)
		sums->first[r] -= part.first[r];
}

void esk_moments_add(esk_moments *moments, const esk_segment *segment);

/* The scatter matrix, sum of w (u - g)(u - g)^T = weight times covariance: exact integers rounded twice, once to
 * double and once by the division. The weight is not 0. */
void esk_moments_scatter(const esk_moments *moments, double scatter[3][3]);

/* Weight times variance in the metric T = form: sum of T_rc S_rc over the scatter matrix S. */
double esk_moments_inertia(const esk_moments *moments, const int64_t form[3][3]);

#endif
