#include "moments.h"

#include "affine.h"

void esk_segments_from_cloud(const eskel_cloud *cloud, esk_segment *segments)
{
	const int32_t x = cloud->extent[0] - 1, y = cloud->extent[1] - 1, z = cloud->extent[2] - 1;
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *run = &cloud->runs[i];
		segments[i] = (esk_segment){
			.x_first = 2 * run->x_first - x,
			.x_last = 2 * run->x_last - x,
			.y = 2 * run->y - y,
			.z = 2 * run->z - z,
			.weight = cloud->weights ? cloud->weights[i] : 1,
		};
	}
}

/* x = (u + extent - 1) / 2 */
eskel_affine esk_segments_world(const eskel_cloud *cloud)
{
	eskel_affine world = cloud->affine;
	const double middle[3] = {
		(cloud->extent[0] - 1) / 2.0, (cloud->extent[1] - 1) / 2.0, (cloud->extent[2] - 1) / 2.0};
	double centre[3];
	esk_affine_apply(&cloud->affine, middle, centre);
	for (int r = 0; r < 3; r++) {
		for (int c = 0; c < 3; c++)
			world.m[r][c] /= 2;
		world.m[r][3] = centre[r];
	}
	return world;
}

/* n coordinates with mean m and step 2 have the squares' sum n m^2 + 4 n (n^2 - 1) / 12. */
void esk_moments_add(esk_moments *moments, const esk_segment *s)
{
	int64_t n = (int64_t)esk_segment_voxels(s), mean = (s->x_first + s->x_last) / 2;
	esk_int128 each = (esk_int128)s->weight, all = each * n;
	moments->voxels += (uint64_t)n;
	esk_sums_add(&moments->sums, s);
	moments->second[0][0] += each * (n * mean * mean + n * (n * n - 1) / 3);
	moments->second[0][1] += all * (mean * s->y);
	moments->second[0][2] += all * (mean * s->z);
	moments->second[1][1] += all * ((int64_t)s->y * s->y);
	moments->second[1][2] += all * ((int64_t)s->y * s->z);
	moments->second[2][2] += all * ((int64_t)s->z * s->z);
}

/* w sum(w u v) - sum(w u) sum(w v) is w times the scatter, and exact. */
void esk_moments_scatter(const esk_moments *moments, double scatter[3][3])
{
	const esk_sums *sums = &moments->sums;
	for (int r = 0; r < 3; r++)
		for (int c = r; c < 3; c++) {
			esk_int128 numerator = (esk_int128)sums->weight * moments->second[r][c] -
					       (esk_int128)sums->first[r] * sums->first[c];
			scatter[r][c] = scatter[c][r] = (double)numerator / (double)sums->weight;
		}
}

double esk_moments_inertia(const esk_moments *moments, const int64_t form[3][3])
{
	double scatter[3][3], sum = 0;
	esk_moments_scatter(moments, scatter);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			sum += scatter[r][c] * (double)form[r][c];
	return sum;
}
