#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "boundary.h"
#include "fit_points.h"
#include "shapes.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>

/* Sheared, uneven and left-handed. */
static const eskel_affine skewed = {{{-1.5, 0.25, 0, 7}, {0, 1, 0.5, -3}, {0.125, 0, 2, 11}}};

enum { SIDE = 9 };

static bool is_set(const bool *grid, int x, int y, int z)
{
	return x >= 0 && y >= 0 && z >= 0 && x < SIDE && y < SIDE && z < SIDE && grid[(z * SIDE + y) * SIDE + x];
}

/* Random voxels, each alone in its runs' eyes; two corners make the box whole. */
static eskel_cloud *random_cloud(uint64_t seed, bool *grid)
{
	uint16_t voxels[SIDE * SIDE * SIDE][3];
	size_t count = 0;
	for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
		grid[i] = i == 0 || i == SIDE * SIDE * SIDE - 1 || synthetic_uniform(&seed) < 0.4;
		if (grid[i]) {
			voxels[count][0] = (uint16_t)(i % SIDE);
			voxels[count][1] = (uint16_t)(i / SIDE % SIDE);
			voxels[count++][2] = (uint16_t)(i / SIDE / SIDE);
		}
	}
	return shapes_voxels((const uint16_t(*)[3])voxels, count, &shapes_identity);
}

static void faces_are_those_between_voxels_and_others(void **state)
{
	(void)state;
	static const int steps[6][3] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
	bool grid[SIDE * SIDE * SIDE];
	for (uint64_t seed = 1; seed < 6; seed++) {
		eskel_cloud *cloud = random_cloud(seed, grid);
		esk_boundary *b = NULL;
		size_t expected = 0;
		assert_int_equal(esk_boundary_new(cloud, &b, NULL), ESKEL_OK);
		for (int i = 0; i < SIDE * SIDE * SIDE; i++)
			for (int d = 0; d < 6 && grid[i]; d++)
				expected += !is_set(grid, i % SIDE + steps[d][0], i / SIDE % SIDE + steps[d][1],
					i / SIDE / SIDE + steps[d][2]);
		assert_int_equal(b->count, expected);
		for (size_t f = 0; f < b->count; f++) {
			int in[3], out[3];
			for (int r = 0; r < 3; r++) {
				in[r] = (int)lround(b->points[f][r] - b->normals[b->directions[f]][r] / 2);
				out[r] = in[r] + steps[b->directions[f]][r];
			}
			assert_true(is_set(grid, in[0], in[1], in[2]) && !is_set(grid, out[0], out[1], out[2]));
		}
		esk_boundary_free(b);
		eskel_cloud_free(cloud);
	}
}

/* Flux of (x, 0, 0) + (0, y, 0) + (0, 0, z) through a closed surface is three times the volume. */
static void normals_point_outward_under_any_affine(void **state)
{
	(void)state;
	const eskel_affine affines[] = {shapes_identity, skewed};
	for (int a = 0; a < 2; a++) {
		eskel_cloud *cloud = shapes_cloud(&shapes_hamate, &affines[a]);
		esk_boundary *b = NULL;
		double flux = 0;
		assert_int_equal(esk_boundary_new(cloud, &b, NULL), ESKEL_OK);
		for (size_t f = 0; f < b->count; f++)
			for (int r = 0; r < 3; r++)
				flux += b->points[f][r] * b->normals[b->directions[f]][r] *
					b->areas[b->directions[f] / 2];
		assert_true(fabs(flux / 3 / eskel_cloud_volume(cloud) - 1) < 1e-9);
		esk_boundary_free(b);
		eskel_cloud_free(cloud);
	}
}

/* A fine grid over every face in the place of the closest-point formula. */
static double sampled_distance(const esk_boundary *b, const double point[3])
{
	enum { STEPS = 8 };
	double least = INFINITY;
	for (size_t f = 0; f < b->count; f++)
		for (int s = -STEPS; s <= STEPS; s++)
			for (int t = -STEPS; t <= STEPS; t++) {
				double square = 0;
				for (int r = 0; r < 3; r++) {
					const double(*e)[3] = (const double(*)[3])b->edges[b->directions[f] / 2];
					const double at = b->points[f][r] + e[0][r] * s / STEPS + e[1][r] * t / STEPS;
					square += (at - point[r]) * (at - point[r]);
				}
				least = fmin(least, square);
			}
	return sqrt(least);
}

static void distances_are_those_of_points_all_over_the_faces(void **state)
{
	(void)state;
	const shapes_rod rod = {{5, 5, 5}, {9, 7, 6}, 4, 3};
	const shapes_solid solid = {&rod, 1, 1, {14, 12, 11}};
	uint64_t seed = 3;
	const eskel_affine affines[] = {shapes_identity, skewed};
	for (int a = 0; a < 2; a++) {
		eskel_cloud *cloud = shapes_cloud(&solid, &affines[a]);
		esk_boundary *b = NULL;
		assert_int_equal(esk_boundary_new(cloud, &b, NULL), ESKEL_OK);
		for (int i = 0; i < 60; i++) {
			double point[3];
			uint32_t face;
			for (int r = 0; r < 3; r++)
				point[r] = b->points[(size_t)i % b->count][r] + 12 * (synthetic_uniform(&seed) - 0.5);
			const double distance = esk_boundary_distance(b, point, &face),
				     sampled = sampled_distance(b, point);
			assert_true(face < b->count);
			assert_true(distance <= sampled + 1e-12 && distance > sampled - 0.2);
		}
		esk_boundary_free(b);
		eskel_cloud_free(cloud);
	}
}

static double to_centre(const void *context, uint32_t item, const double point[3])
{
	const double *c = ((const double(*)[3])context)[item];
	return sqrt((c[0] - point[0]) * (c[0] - point[0]) + (c[1] - point[1]) * (c[1] - point[1]) +
		    (c[2] - point[2]) * (c[2] - point[2]));
}

static void the_nearest_of_many_is_found(void **state)
{
	(void)state;
	static double centres[3000][3];
	uint64_t seed = 5;
	for (size_t count = 1; count <= 3000; count = count * 3 + 1) {
		esk_nearest *nearest = NULL;
		for (size_t i = 0; i < count; i++)
			for (int r = 0; r < 3; r++)
				centres[i][r] = floor(20 * synthetic_uniform(&seed)) / (r + 1); /* many equal */
		assert_int_equal(esk_nearest_new((const double(*)[3])centres, count, &nearest), ESKEL_OK);
		for (int i = 0; i < 200; i++) {
			const double point[3] = {25 * synthetic_uniform(&seed), 15 * synthetic_uniform(&seed), 7};
			double least = INFINITY;
			for (size_t c = 0; c < count; c++)
				least = fmin(least, to_centre(centres, (uint32_t)c, point));
			assert_true(esk_nearest_find(nearest, point, 0, to_centre, centres, NULL) == least);
		}
		esk_nearest_free(nearest);
	}
}

static void voxels_hold_what_is_in_them(void **state)
{
	(void)state;
	eskel_cloud *cloud = shapes_cloud(&shapes_hamate, &skewed);
	esk_boundary *b = NULL;
	assert_int_equal(esk_boundary_new(cloud, &b, NULL), ESKEL_OK);
	for (size_t f = 0; f < b->count; f++) {
		double in[3], out[3];
		for (int r = 0; r < 3; r++) {
			in[r] = b->points[f][r] - 0.01 * b->normals[b->directions[f]][r];
			out[r] = b->points[f][r] + 0.01 * b->normals[b->directions[f]][r];
		}
		assert_true(esk_boundary_holds(b, in) && !esk_boundary_holds(b, out));
	}
	esk_boundary_free(b);
	eskel_cloud_free(cloud);
}

static void samples_are_spread_over_the_whole(void **state)
{
	(void)state;
	eskel_cloud *cloud = shapes_cloud(&shapes_femur, &shapes_identity);
	esk_boundary *b = NULL;
	uint32_t faces[1200];
	double farthest = 0;
	assert_int_equal(esk_boundary_new(cloud, &b, NULL), ESKEL_OK);
	assert_int_equal(esk_boundary_sample(b, 1200, faces), 1200);
	for (size_t f = 0; f < b->count; f += 7) {
		double least = INFINITY;
		for (int s = 0; s < 1200; s++)
			least = fmin(least, to_centre(b->points, faces[s], b->points[f]));
		farthest = fmax(farthest, least);
	}
	/* Each stands for a disc of this radius; a lattice would have it about 1.2 times. */
	const double radius = sqrt(b->area / 1200 / 3.14159);
	if (farthest > 3 * radius)
		fail_msg("a face is %g mm from any sample, the radius of their discs is %g mm", farthest, radius);
	esk_boundary_free(b);
	eskel_cloud_free(cloud);
}

static void points_of_a_fit_are_where_their_kind_says(void **state)
{
	(void)state;
	eskel_cloud *cloud = shapes_cloud(&shapes_hamate, &skewed);
	esk_boundary *b = NULL;
	esk_fit_points *points = NULL;
	double weights[3] = {0};
	assert_int_equal(esk_boundary_new(cloud, &b, NULL), ESKEL_OK);
	assert_int_equal(esk_fit_points_new(b, 500, &points), ESKEL_OK);
	for (size_t g = 0; g < points->group_count; g++)
		for (int l = 0; l < ESK_LANES; l++) {
			const esk_fit_group *group = &points->groups[g];
			const double point[3] = {group->points[0][l], group->points[1][l], group->points[2][l]};
			weights[group->kind] += group->weights[l];
			if (group->kind == ESK_FIT_BOUNDARY)
				assert_true(esk_boundary_distance(b, point, NULL) < 1e-9 && group->margins[l] == 0);
			else
				assert_true(esk_boundary_holds(b, point) == (group->kind == ESK_FIT_INSIDE) &&
					    group->margins[l] <= esk_boundary_distance(b, point, NULL) + 1e-9);
		}
	for (int kind = 0; kind < 3; kind++)
		assert_true(fabs(weights[kind] - 1) < 1e-9);
	esk_fit_points_free(points);
	esk_boundary_free(b);
	eskel_cloud_free(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(faces_are_those_between_voxels_and_others),
		cmocka_unit_test(normals_point_outward_under_any_affine),
		cmocka_unit_test(distances_are_those_of_points_all_over_the_faces),
		cmocka_unit_test(the_nearest_of_many_is_found),
		cmocka_unit_test(voxels_hold_what_is_in_them),
		cmocka_unit_test(samples_are_spread_over_the_whole),
		cmocka_unit_test(points_of_a_fit_are_where_their_kind_says),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
