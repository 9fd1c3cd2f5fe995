#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "moments.h"
#include "shapes.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MANY = 500 };

/* Voxel by voxel. */
static void add_voxels(esk_moments *moments, const esk_segment *s)
{
	for (int64_t x = s->x_first; x <= s->x_last; x += 2) {
		const int64_t u[3] = {x, s->y, s->z};
		moments->voxels++;
		moments->sums.weight += s->weight;
		for (int r = 0; r < 3; r++) {
			moments->sums.first[r] += (int64_t)s->weight * u[r];
			for (int c = r; c < 3; c++)
				moments->second[r][c] += (esk_int128)s->weight * (u[r] * u[c]);
		}
	}
}

static void assert_same(const esk_moments *a, const esk_moments *b)
{
	assert_int_equal(a->voxels, b->voxels);
	assert_int_equal(a->sums.weight, b->sums.weight);
	for (int r = 0; r < 3; r++) {
		assert_int_equal(a->sums.first[r], b->sums.first[r]);
		for (int c = r; c < 3; c++)
			if (a->second[r][c] != b->second[r][c])
				fail_msg("second moment %d,%d is %g, expected %g", r, c, (double)a->second[r][c],
					(double)b->second[r][c]);
	}
}

static esk_segment random_segment(uint64_t *random, int half, uint64_t most_weight)
{
	int32_t ends[2];
	for (int i = 0; i < 2; i++)
		ends[i] = 2 * (int32_t)(synthetic_random(random) % (unsigned)half) - half + 1;
	return (esk_segment){
		.x_first = ends[0] < ends[1] ? ends[0] : ends[1],
		.x_last = ends[0] < ends[1] ? ends[1] : ends[0],
		.y = (int32_t)(synthetic_random(random) % (2 * (unsigned)half)) - half,
		.z = (int32_t)(synthetic_random(random) % (2 * (unsigned)half)) - half,
		.weight = 1 + synthetic_random(random) % most_weight,
	};
}

static void moments_of_a_segment_equal_those_of_its_voxels(void **state)
{
	(void)state;
	uint64_t random = 1;
	for (int i = 0; i < MANY; i++) {
		esk_segment s = random_segment(&random, i % 2 ? 40 : 4000, i % 3 ? 1 : 1000000);
		esk_moments fast = {0}, slow = {0};
		esk_moments_add(&fast, &s);
		add_voxels(&slow, &s);
		assert_same(&fast, &slow);
	}
}

static void moments_at_the_bounds_of_a_cloud_are_exact(void **state)
{
	(void)state;
	/* 2^44 in one row at the corner of the largest box */
	esk_segment s = {-65534, 65534, 65534, -65534, (uint64_t)1 << 28};
	esk_moments fast = {0}, slow = {0};
	esk_moments_add(&fast, &s);
	add_voxels(&slow, &s);
	assert_same(&fast, &slow);
	double scatter[3][3];
	esk_moments_scatter(&fast, scatter);
	const double expected = (double)s.weight * 65535. * (65535. * 65535 - 1) / 3;
	if (fabs(scatter[0][0] - expected) > 1e-14 * expected)
		fail_msg("scatter along x is %.17g, expected %.17g", scatter[0][0], expected);
	assert_true(scatter[1][1] == 0 && scatter[2][2] == 0 && scatter[0][1] == 0 && scatter[1][2] == 0);
}

static void removing_a_segment_undoes_adding_it(void **state)
{
	(void)state;
	uint64_t random = 3;
	esk_sums sums = {0};
	esk_segment first = random_segment(&random, 300, 5), second = random_segment(&random, 300, 5);
	esk_sums_add(&sums, &first);
	const esk_sums before = sums;
	esk_sums_add(&sums, &second);
	esk_sums_remove(&sums, &second);
	assert_int_equal(sums.weight, before.weight);
	assert_memory_equal(sums.first, before.first, sizeof sums.first);
}

static void the_scatter_equals_that_of_differences_from_the_centre(void **state)
{
	(void)state;
	uint64_t random = 4;
	esk_segment segments[20];
	esk_moments moments = {0};
	for (int i = 0; i < 20; i++) {
		segments[i] = random_segment(&random, 100, 9);
		esk_moments_add(&moments, &segments[i]);
	}
	long double expected[3][3] = {{0}}, centre[3];
	for (int r = 0; r < 3; r++)
		centre[r] = (long double)moments.sums.first[r] / (long double)moments.sums.weight;
	for (int i = 0; i < 20; i++)
		for (int x = segments[i].x_first; x <= segments[i].x_last; x += 2) {
			const long double d[3] = {x - centre[0], segments[i].y - centre[1], segments[i].z - centre[2]};
			for (int r = 0; r < 3; r++)
				for (int c = 0; c < 3; c++)
					expected[r][c] += (long double)segments[i].weight * d[r] * d[c];
		}
	double scatter[3][3];
	esk_moments_scatter(&moments, scatter);
	long double inertia = 0;
	const int64_t form[3][3] = {{5, 1, -2}, {1, 4, 0}, {-2, 0, 7}};
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			if (fabsl(scatter[r][c] - expected[r][c]) > 1e-14L * expected[r][r] + 1e-14L * expected[c][c])
				fail_msg(
					"scatter %d,%d is %.17g, expected %.17Lg", r, c, scatter[r][c], expected[r][c]);
			inertia += expected[r][c] * form[r][c];
		}
	double found = esk_moments_inertia(&moments, form);
	if (fabsl(found - inertia) > 1e-13L * inertia)
		fail_msg("inertia is %.17g, expected %.17Lg", found, inertia);
}

static void a_mirrored_cloud_has_negated_coordinates(void **state)
{
	(void)state;
	const uint16_t voxels[4][3] = {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {5, 1, 3}};
	const uint16_t mirrored[4][3] = {{5, 0, 0}, {4, 0, 0}, {3, 1, 0}, {0, 1, 3}};
	esk_moments moments[2] = {{0}};
	for (int side = 0; side < 2; side++) {
		esk_segment segments[4];
		eskel_cloud *cloud = shapes_voxels(side ? mirrored : voxels, 4, &shapes_identity);
		esk_segments_from_cloud(cloud, segments);
		for (size_t i = 0; i < cloud->run_count; i++)
			esk_moments_add(&moments[side], &segments[i]);
		eskel_cloud_free(cloud);
	}
	assert_int_equal(moments[0].sums.first[0], -moments[1].sums.first[0]);
	assert_int_equal(moments[0].sums.first[1], moments[1].sums.first[1]);
	assert_true(moments[0].second[0][0] == moments[1].second[0][0]);
	assert_true(moments[0].second[0][1] == -moments[1].second[0][1]);
	assert_true(moments[0].second[1][2] == moments[1].second[1][2]);
}

static void the_world_of_segments_is_the_world_of_the_cloud(void **state)
{
	(void)state;
	const eskel_affine sheared = {{{0.5, 0.125, 0, 7}, {0, 2, 0.25, -8}, {0, 0.25, 3, 9}}};
	const uint16_t voxels[3][3] = {{0, 0, 0}, {3, 1, 2}, {6, 4, 1}};
	eskel_cloud *cloud = shapes_voxels(voxels, 3, &sheared);
	const eskel_affine world = esk_segments_world(cloud);
	esk_segment segments[3];
	esk_segments_from_cloud(cloud, segments);
	for (size_t i = 0; i < cloud->run_count; i++)
		for (int r = 0; r < 3; r++) {
			const eskel_run *run = &cloud->runs[i];
			const double(*m)[4] = ((const eskel_affine *)&cloud->affine)->m;
			double expected = m[r][0] * run->x_first + m[r][1] * run->y + m[r][2] * run->z + m[r][3];
			double found = world.m[r][0] * segments[i].x_first + world.m[r][1] * segments[i].y +
				       world.m[r][2] * segments[i].z + world.m[r][3];
			if (fabs(found - expected) > 1e-12)
				fail_msg("coordinate %d of run %zu is %.17g, expected %.17g", r, i, found, expected);
		}
	eskel_cloud_free(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(moments_of_a_segment_equal_those_of_its_voxels),
		cmocka_unit_test(moments_at_the_bounds_of_a_cloud_are_exact),
		cmocka_unit_test(removing_a_segment_undoes_adding_it),
		cmocka_unit_test(the_scatter_equals_that_of_differences_from_the_centre),
		cmocka_unit_test(a_mirrored_cloud_has_negated_coordinates),
		cmocka_unit_test(the_world_of_segments_is_the_world_of_the_cloud),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
