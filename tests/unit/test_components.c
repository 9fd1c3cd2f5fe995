#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "synthetic.h"

#include <stdlib.h>
#include <string.h>

static const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

/* The oracle floods a grid of this extent, whose outermost layer is background. */
enum { MOST = 14, VOXELS = MOST * MOST * MOST };

typedef struct {
	unsigned char voxels[MOST][MOST][MOST]; /* [z][y][x]; 1: object */
} grid;

static eskel_cloud *cloud_of(const grid *g)
{
	eskel_run *runs = calloc(VOXELS, sizeof *runs);
	size_t count = 0;
	for (uint16_t z = 0; z < MOST; z++)
		for (uint16_t y = 0; y < MOST; y++)
			for (uint16_t x = 0; x < MOST; x++)
				if (g->voxels[z][y][x])
					runs[count++] = (eskel_run){x, x, y, z};
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(runs, NULL, count, &identity, &cloud, NULL), ESKEL_OK);
	free(runs);
	return cloud;
}

/* Empties the piece of value that holds a voxel, over faces alone or also edges and corners; its size. */
static uint64_t flood(grid *g, int z, int y, int x, unsigned char value, bool faces_only)
{
	static int stack[VOXELS][3];
	int depth = 0;
	uint64_t size = 0;
	stack[depth][0] = z, stack[depth][1] = y, stack[depth++][2] = x;
	g->voxels[z][y][x] = 2;
	while (depth > 0) {
		int at[3] = {stack[depth - 1][0], stack[depth - 1][1], stack[depth - 1][2]};
		depth--;
		size++;
		for (int n = 0; n < 27; n++) {
			int d[3] = {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
			int to[3] = {at[0] + d[0], at[1] + d[1], at[2] + d[2]};
			if ((faces_only && abs(d[0]) + abs(d[1]) + abs(d[2]) > 1) || to[0] < 0 || to[1] < 0 ||
				to[2] < 0 || to[0] >= MOST || to[1] >= MOST || to[2] >= MOST ||
				g->voxels[to[0]][to[1]][to[2]] != value)
				continue;
			g->voxels[to[0]][to[1]][to[2]] = 2;
			memcpy(stack[depth++], to, sizeof to);
		}
	}
	return size;
}

/* Sizes of all pieces of a value, found voxel by voxel, not sorted. */
static size_t flood_all(const grid *original, unsigned char value, bool faces_only, uint64_t *sizes)
{
	grid g = *original;
	size_t count = 0;
	for (int z = 0; z < MOST; z++)
		for (int y = 0; y < MOST; y++)
			for (int x = 0; x < MOST; x++)
				if (g.voxels[z][y][x] == value)
					sizes[count++] = flood(&g, z, y, x, value, faces_only);
	return count;
}

static int compare_descending(const void *a, const void *b)
{
	return *(const uint64_t *)a < *(const uint64_t *)b ? 1 : *(const uint64_t *)a > *(const uint64_t *)b ? -1 : 0;
}

static void assert_sizes(const eskel_components *found, uint64_t *sizes, size_t count)
{
	uint64_t voxels = 0;
	qsort(sizes, count, sizeof *sizes, compare_descending);
	assert_int_equal(found->count, count);
	for (size_t i = 0; i < count; i++) {
		assert_int_equal(found->sizes[i], sizes[i]);
		voxels += sizes[i];
	}
	assert_int_equal(found->voxels, voxels);
}

static void assert_as_flooded(const grid *g)
{
	static uint64_t sizes[VOXELS];
	eskel_cloud *cloud = cloud_of(g);
	eskel_components *components = NULL, *cavities = NULL;
	assert_int_equal(eskel_cloud_components(cloud, &components), ESKEL_OK);
	assert_int_equal(eskel_cloud_cavities(cloud, &cavities), ESKEL_OK);
	assert_sizes(components, sizes, flood_all(g, 1, false, sizes));
	/* The piece with the corner is the outside: its layer is the first to be flooded. */
	size_t count = flood_all(g, 0, true, sizes);
	assert_sizes(cavities, sizes + 1, count - 1);
	eskel_components_free(components);
	eskel_components_free(cavities);
	eskel_cloud_free(cloud);
}

static void pieces_and_cavities_of_random_grids_are_those_of_a_flood_fill(void **state)
{
	(void)state;
	uint64_t random = 7;
	size_t grids = 0;
	for (int round = 0; round < 600; round++) {
		const double filled = 0.02 + 0.96 * synthetic_uniform(&random);
		const int extent = 1 + round % (MOST - 2);
		grid g = {0};
		size_t voxels = 0;
		for (int z = 1; z <= extent; z++)
			for (int y = 1; y <= extent; y++)
				for (int x = 1; x < MOST - 1; x++)
					voxels += g.voxels[z][y][x] = synthetic_uniform(&random) < filled;
		if (voxels == 0)
			continue;
		assert_as_flooded(&g);
		grids++;
	}
	assert_true(grids > 500);
}

static void voxels_that_share_a_corner_are_one_piece(void **state)
{
	(void)state;
	grid g = {0};
	g.voxels[1][1][1] = g.voxels[2][2][2] = g.voxels[3][1][3] = 1;
	assert_as_flooded(&g);
	g.voxels[3][1][3] = 0;
	g.voxels[4][2][2] = 1;
	assert_as_flooded(&g);
}

/* A ring is no cavity, a box is one, and a box whose wall lacks an edge still is: the background needs a face. */
static void a_cavity_is_closed_over_faces(void **state)
{
	(void)state;
	grid g = {0};
	for (int z = 1; z <= 5; z++)
		for (int y = 1; y <= 5; y++)
			for (int x = 1; x <= 5; x++)
				g.voxels[z][y][x] = z == 1 || z == 5 || y == 1 || y == 5 || x == 1 || x == 5;
	assert_as_flooded(&g);
	for (int z = 1; z <= 5; z++)
		g.voxels[z][1][1] = 0;
	assert_as_flooded(&g);
	g.voxels[1][3][3] = 0;
	assert_as_flooded(&g);
}

static void runs_of_different_weights_touch(void **state)
{
	(void)state;
	const eskel_run runs[] = {{0, 4, 0, 0}, {5, 9, 0, 0}, {12, 13, 0, 0}};
	const uint32_t weights[] = {1, 2, 3};
	eskel_cloud *cloud = NULL;
	eskel_components *found = NULL;
	assert_int_equal(eskel_cloud_new(runs, weights, 3, &identity, &cloud, NULL), ESKEL_OK);
	assert_int_equal(eskel_cloud_components(cloud, &found), ESKEL_OK);
	assert_int_equal(found->count, 2);
	assert_int_equal(found->sizes[0], 10);
	assert_int_equal(found->sizes[1], 2);
	eskel_components_free(found);
	eskel_cloud_free(cloud);
}

/* Two voxels at opposite ends of the largest grid: work is by the runs, not by the rows between. */
static void an_empty_grid_between_two_voxels_costs_nothing(void **state)
{
	(void)state;
	const eskel_run runs[] = {{0, 0, 0, 0}, {65534, 65534, 65534, 65534}};
	eskel_cloud *cloud = NULL;
	eskel_components *components = NULL, *cavities = NULL;
	assert_int_equal(eskel_cloud_new(runs, NULL, 2, &identity, &cloud, NULL), ESKEL_OK);
	assert_int_equal(eskel_cloud_components(cloud, &components), ESKEL_OK);
	assert_int_equal(eskel_cloud_cavities(cloud, &cavities), ESKEL_OK);
	assert_int_equal(components->count, 2);
	assert_int_equal(cavities->count, 0);
	assert_int_equal(cavities->voxels, 0);
	eskel_components_free(components);
	eskel_components_free(cavities);
	eskel_cloud_free(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pieces_and_cavities_of_random_grids_are_those_of_a_flood_fill),
		cmocka_unit_test(voxels_that_share_a_corner_are_one_piece),
		cmocka_unit_test(a_cavity_is_closed_over_faces),
		cmocka_unit_test(runs_of_different_weights_touch),
		cmocka_unit_test(an_empty_grid_between_two_voxels_costs_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
