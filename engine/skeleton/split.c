#include "split.h"

#include "affine.h"
#include "eigen.h"
#include "partition.h"

#include <math.h>

/* The plane a . map (u - g) = 0 has the normal map^T a in u. Scaled so that the greatest component is 2^20 and
 * rounded: the last bits of an eigenvector must not decide where a voxel goes. */
static void plane_normal(const eskel_affine *map, const double axis[3], int64_t normal[3])
{
	double n[3], greatest = 0;
	for (int i = 0; i < 3; i++) {
		n[i] = map->m[0][i] * axis[0] + map->m[1][i] * axis[1] + map->m[2][i] * axis[2];
		greatest = fmax(greatest, fabs(n[i]));
	}
	for (int i = 0; i < 3; i++)
		normal[i] = greatest > 0 ? llround(n[i] / greatest * 0x1p20) : 0;
}

static void cut(esk_partition *partition, const int64_t normal[3], int64_t threshold)
{
	esk_scores scores;
	esk_scores_set_plane(&scores, normal, threshold);
	esk_partition_assign(partition, &scores);
}

static int64_t floor_quotient(esk_int128 numerator, esk_int128 denominator)
{
	esk_int128 quotient = numerator / denominator;
	return (int64_t)(quotient - (numerator % denominator < 0));
}

/* Cuts by the plane normal . u = normal . g. Voxels exactly on it join the lighter side, and the heavier part comes
 * first: neither depends on the sign of the normal, so a mirrored class is cut the same way. */
static void cut_at_centre(esk_partition *partition, const esk_sums *whole, const int64_t normal[3], esk_sums parts[2])
{
	const esk_sums *sums = partition->sums;
	const esk_int128 weight = whole->weight;
	esk_int128 height = 0;
	for (int r = 0; r < 3; r++)
		height += (esk_int128)normal[r] * whole->first[r];
	const int64_t threshold = floor_quotient(height, weight);
	cut(partition, normal, threshold);
	if (height % weight == 0) {
		const uint64_t above = sums[1].weight;
		cut(partition, normal, threshold - 1);
		if (sums[0].weight <= above)
			cut(partition, normal, threshold);
	}
	const bool second_first = sums[1].weight > sums[0].weight;
	parts[0] = sums[second_first];
	parts[1] = sums[!second_first];
}

static eskel_status major_axis_plane(
	const esk_moments *moments, const eskel_affine *map, int64_t normal[3], bool *degenerate)
{
	double scatter[3][3];
	esk_eigen eigen;
	esk_moments_scatter(moments, scatter);
	esk_affine_congruence(map, (const double(*)[3])scatter, scatter);
	eskel_status status = esk_eigen_symmetric((const double(*)[3])scatter, &eigen);
	if (status)
		return status;
	plane_normal(map, eigen.axes[0], normal);
	*degenerate = esk_eigen_is_degenerate(&eigen);
	return ESKEL_OK;
}

/* The decomposition theorem gives the parts' inertia without their second moments:
 * w V = w' V' + w'' V'' + (w' w'' / w) |g' - g''|^2. Rounded well above the noise of doubles, so that equal splits of a
 * symmetric cloud tie however its axes lie. */
static double ratio_of(const esk_sums parts[2], const esk_metric *metric, double inertia)
{
	const double weights[2] = {(double)parts[0].weight, (double)parts[1].weight};
	double d[3], squared = 0;
	for (int r = 0; r < 3; r++)
		d[r] = (double)parts[0].first[r] / weights[0] - (double)parts[1].first[r] / weights[1];
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			squared += (double)metric->form[r][c] * d[r] * d[c];
	double ratio = 1 - weights[0] * weights[1] / (weights[0] + weights[1]) * squared / inertia;
	return fmax(0, nearbyint(ratio * 0x1p32) * 0x1p-32);
}

/* The heavier part first, on a tie the one of larger variance. */
static eskel_status order_parts(const esk_partition *partition, esk_sums parts[2])
{
	const esk_sums *sums = partition->sums;
	bool second_first = sums[1].weight > sums[0].weight;
	if (sums[1].weight == sums[0].weight) {
		esk_labelling labelling = {0};
		esk_moments moments[2] = {{0}};
		eskel_status status = esk_partition_label(partition, &labelling);
		for (size_t i = 0; i < labelling.count; i++)
			esk_moments_add(&moments[labelling.parts[i].class_index], &labelling.parts[i].segment);
		esk_labelling_clear(&labelling);
		if (status)
			return status;
		second_first = esk_moments_inertia(&moments[1], partition->metric->form) >
			       esk_moments_inertia(&moments[0], partition->metric->form);
	}
	parts[0] = sums[second_first];
	parts[1] = sums[!second_first];
	return ESKEL_OK;
}

/* Both parts are never empty: some voxel lies below the plane and some above, unless rounding has made the class flat
 * along the normal; then it is not split. */
static eskel_status split_along(
	esk_partition *partition, const esk_sums *whole, const int64_t normal[3], double inertia, esk_split *split)
{
	esk_sums starts[2];
	cut_at_centre(partition, whole, normal, starts);
	if (!starts[1].weight)
		return ESKEL_OK;
	eskel_status status = esk_partition_converge(partition, starts, 2);
	if (!status)
		status = order_parts(partition, split->parts);
	if (status)
		return status;
	split->possible = true;
	split->ratio = ratio_of(split->parts, partition->metric, inertia);
	return ESKEL_OK;
}

/* The centres of two parts differ in one direction, so a split takes away no more than the variance in that direction, and
 * there is none with more than the major axis: r >= 1 - lambda_1 / (lambda_1 + lambda_2 + lambda_3). With A = q I + p B,
 * q = tr A / 3 and tr B^2 = 6, lambda_1 = q + 2 p cos(acos(det B / 2) / 3). What is taken off covers the form's rounding,
 * 2^-20, which map does not have, and that of doubles. */
double esk_split_least_ratio(const esk_moments *moments, const esk_metric *metric)
{
	double a[3][3], squares = 0;
	esk_moments_scatter(moments, a);
	esk_affine_congruence(&metric->map, (const double(*)[3])a, a);
	const double q = (a[0][0] + a[1][1] + a[2][2]) / 3;
	for (int r = 0; r < 3; r++)
		a[r][r] -= q;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			squares += a[r][c] * a[r][c];
	const double p = sqrt(squares / 6);
	const double det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
			   a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
			   a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
	if (!(q > 0) || !(p > 0))
		return 0;
	const double cosine = fmax(-1, fmin(1, det / (2 * p * p * p)));
	return 1 - (q + 2 * p * cos(acos(cosine) / 3)) / (3 * q) - 1e-5;
}

eskel_status esk_split_class(const esk_segment *segments, size_t segment_count, const esk_moments *moments,
	const esk_metric *metric, const eskel_affine *axes_map, esk_split *split)
{
	esk_split result = {0};
	esk_partition partition = {0};
	int64_t normal[3];
	eskel_status status = ESKEL_OK;
	const double inertia = esk_moments_inertia(moments, metric->form);
	if (inertia > 0) {
		status = major_axis_plane(moments, axes_map, normal, &result.degenerate);
		if (!status)
			status = esk_partition_init(&partition, segments, segment_count, metric, NULL);
		if (!status)
			status = split_along(&partition, &moments->sums, normal, inertia, &result);
		esk_partition_clear(&partition);
	}
	if (!status)
		*split = result;
	return status;
}
