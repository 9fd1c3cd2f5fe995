#include "metric.h"

#include "eigen.h"

#include <math.h>
#include <stdlib.h>

enum { FORM_BITS = 40 };

/* c and 2 b . u stay below 2^44: with g inside the box, |c| <= sum |T_rc| half_r half_c and 2 |b . u| at most twice
 * that. Their roundings add at most 1.5 sum half_r + 1 < 2^19. */
static int score_shift(const esk_metric *metric)
{
	double most = 0;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			most += 3 * (double)llabs(metric->form[r][c]) * metric->half[r] * metric->half[c];
	return most > 0 ? 43 - ilogb(most) : 0;
}

/* form = map^T map, scaled so that its greatest entry, which is on the diagonal, is exactly 2^FORM_BITS, and then
 * every entry rounded to about that many bits of its natural size, the root of T_rr T_cc. Rounding is symmetric
 * about 0, so a mirrored cloud has the mirrored form. */
static void set_form(esk_metric *metric, int bits)
{
	const double *const m[3] = {metric->map.m[0], metric->map.m[1], metric->map.m[2]};
	double t[3][3], greatest = 0;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			t[r][c] = m[0][r] * m[0][c] + m[1][r] * m[1][c] + m[2][r] * m[2][c];
			greatest = fmax(greatest, t[r][c]);
		}
	int size[3]; /* of each axis: floor(log2 sqrt(T_rr)), after scaling */
	for (int r = 0; r < 3; r++)
		size[r] = t[r][r] > 0 ? ilogb(sqrt(t[r][r] / greatest)) : -FORM_BITS;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			int unit = FORM_BITS + size[r] + size[c] - bits; /* log2 of what is kept of 2^FORM_BITS */
			if (unit < 0)
				unit = 0;
			int64_t kept = greatest > 0 ? llround(ldexp(t[r][c] / greatest, FORM_BITS - unit)) : 0;
			metric->form[r][c] = kept * ((int64_t)1 << unit);
		}
	metric->shift = score_shift(metric);
}

static void set_half(esk_metric *metric, const eskel_cloud *cloud)
{
	for (int r = 0; r < 3; r++)
		metric->half[r] = cloud->extent[r] - 1;
}

/* 20 bits: affines come rounded to float (24 bits), and that noise must not tell a rotated header from a straight
 * one. What is left off moves no class border by more than 1e-6 of the object's size. */
void esk_metric_euclidean(const eskel_cloud *cloud, esk_metric *metric)
{
	metric->map = esk_segments_world(cloud);
	set_half(metric, cloud);
	set_form(metric, 20);
}

/* No header here, so no noise, and all bits are kept: an elongated cloud needs them. */
eskel_status esk_metric_mahalanobis(const eskel_cloud *cloud, const esk_moments *moments, esk_metric *metric)
{
	double covariance[3][3];
	esk_eigen eigen;
	esk_moments_scatter(moments, covariance);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			covariance[r][c] /= (double)moments->sums.weight;
	eskel_status status = esk_eigen_symmetric((const double(*)[3])covariance, &eigen);
	if (status)
		return status;
	metric->map = (eskel_affine){0};
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			metric->map.m[r][c] = eigen.values[r] > 0 ? eigen.axes[r][c] / sqrt(eigen.values[r]) : 0;
	set_half(metric, cloud);
	set_form(metric, FORM_BITS);
	return ESKEL_OK;
}
