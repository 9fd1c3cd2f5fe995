#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 6 };

typedef struct {
	unsigned char voxels[MOST][MOST][MOST]; /* [z][y][x] */
} grid;

static eskel_cloud *cloud_of(const grid *g, const eskel_affine *affine)
{
	eskel_run runs[MOST * MOST * MOST];
	size_t count = 0;
	for (uint16_t z = 0; z < MOST; z++)
		for (uint16_t y = 0; y < MOST; y++)
			for (uint16_t x = 0; x < MOST; x++)
				if (g->voxels[z][y][x])
					runs[count++] = (eskel_run){x, x, y, z};
	eskel_cloud *cloud = NULL;
	assert_int_equal(eskel_cloud_new(runs, NULL, count, affine, &cloud, NULL), ESKEL_OK);
	return cloud;
}

static eskel_mesh *mesh_of(const eskel_cloud *cloud, eskel_mesh_check_result *r)
{
	eskel_mesh *mesh = NULL;
	assert_int_equal(eskel_cloud_mesh(cloud, &mesh, NULL), ESKEL_OK);
	assert_int_equal(eskel_mesh_check(mesh, r), ESKEL_OK);
	if (!r->is_manifold)
		fail_msg("%zu boundary edges, %zu crowded edges, %zu crowded vertices, %zu turned edges",
			r->boundary_edges, r->crowded_edges, r->crowded_vertices, r->turned_edges);
	return mesh;
}

static int is_voxel(const grid *g, int z, int y, int x)
{
	const int least = x < y ? (x < z ? x : z) : (y < z ? y : z);
	const int greatest = x > y ? (x > z ? x : z) : (y > z ? y : z);
	return least >= 0 && greatest < MOST && g->voxels[z][y][x];
}

/* Faces of the grid's surface. */
static int count_faces(const grid *g)
{
	int count = 0;
	for (int z = 0; z < MOST; z++)
		for (int y = 0; y < MOST; y++)
			for (int x = 0; x < MOST; x++)
				if (g->voxels[z][y][x])
					count += 6 - is_voxel(g, z - 1, y, x) - is_voxel(g, z + 1, y, x) -
						 is_voxel(g, z, y - 1, x) - is_voxel(g, z, y + 1, x) -
						 is_voxel(g, z, y, x - 1) - is_voxel(g, z, y, x + 1);
	return count;
}

static const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static void one_voxel_is_a_box_in_the_world(void **state)
{
	(void)state;
	const grid g = {{{{1}}}};
	const eskel_affine affine = {{{2, 0, 0, 10}, {0, 3, 0, 20}, {0, 0, 4, 30}}};
	eskel_cloud *cloud = cloud_of(&g, &affine);
	eskel_mesh_check_result r;
	eskel_mesh *mesh = mesh_of(cloud, &r);
	assert_int_equal(mesh->vertex_count, 8);
	assert_int_equal(mesh->triangle_count, 12);
	assert_int_equal(r.euler, 2);
	assert_true(eskel_mesh_volume(mesh) == 24);
	for (size_t v = 0; v < 8; v++)
		for (int a = 0; a < 3; a++) {
			const double centre = 10 * (a + 1), half = 1 + a / 2.0;
			assert_true(fabs(mesh->vertices[v][a] - centre) == half);
			assert_true((mesh->normals[v][a] > 0) == (mesh->vertices[v][a] > centre));
		}
	eskel_mesh_free(mesh);
	eskel_cloud_free(cloud);
}

/* Every grid of voxels that touch in every way has a closed manifold, of the area and volume of its faces and voxels. */
static void any_voxels_have_a_closed_manifold(void **state)
{
	(void)state;
	uint64_t random = 5;
	for (int trial = 0; trial < 500; trial++) {
		grid g = {0};
		const int side = 2 + trial % (MOST - 1);
		const double share = 0.2 + 0.6 * synthetic_uniform(&random);
		for (int z = 0; z < side; z++)
			for (int y = 0; y < side; y++)
				for (int x = 0; x < side; x++)
					g.voxels[z][y][x] = synthetic_uniform(&random) < share;
		g.voxels[0][0][0] = 1;
		eskel_cloud *cloud = cloud_of(&g, &identity);
		eskel_mesh_check_result r;
		eskel_mesh *mesh = mesh_of(cloud, &r);
		assert_true(fabs(eskel_mesh_volume(mesh) - (double)cloud->voxels) < 1e-4);
		assert_true(fabs(eskel_mesh_area(mesh) - count_faces(&g)) < 1e-3);
		eskel_mesh_free(mesh);
		eskel_cloud_free(cloud);
	}
}

static void voxels_that_touch_in_an_edge_or_corner_are_apart(void **state)
{
	(void)state;
	const grid pairs[2] = {{{{{1}, {0, 1}}}}, {{{{1}}, {{0}, {0, 1}}}}};
	for (int p = 0; p < 2; p++) {
		eskel_cloud *cloud = cloud_of(&pairs[p], &identity);
		eskel_mesh_check_result r;
		eskel_mesh *mesh = mesh_of(cloud, &r);
		assert_int_equal(mesh->vertex_count, 16);
		assert_int_equal(r.components, 2);
		assert_int_equal(r.euler, 4);
		eskel_mesh_free(mesh);
		eskel_cloud_free(cloud);
	}
}

/* Two holes of a plate that touch along an edge are one hole, pinched; covered on both sides, one cavity. */
static void pinched_holes_stay_manifold(void **state)
{
	(void)state;
	for (int covered = 0; covered < 2; covered++) {
		grid g = {0};
		for (int z = 1 - covered; z < 2 + covered; z++)
			for (int y = 0; y < 4; y++)
				for (int x = 0; x < 4; x++)
					g.voxels[z][y][x] = z != 1 || !((x == 1 && y == 1) || (x == 2 && y == 2));
		eskel_cloud *cloud = cloud_of(&g, &identity);
		eskel_mesh_check_result r;
		eskel_mesh *mesh = mesh_of(cloud, &r);
		assert_int_equal(r.components, covered ? 2 : 1);
		assert_int_equal(r.euler, covered ? 4 : 0);
		eskel_mesh_free(mesh);
		eskel_cloud_free(cloud);
	}
}

static void left_handed_affines_turn_nothing_inside_out(void **state)
{
	(void)state;
	const grid g = {{{{1, 1}, {0, 1}}, {{0, 1}}}};
	eskel_cloud *cloud = cloud_of(&g, &identity);
	/* No affine that eskel_cloud_new makes canonical stays left-handed unless it is oblique. */
	cloud->affine = (eskel_affine){{{0, 2, 0, 1}, {3, 0, 0, 2}, {0, 0.5, 1, 3}}};
	eskel_mesh_check_result r;
	eskel_mesh *mesh = mesh_of(cloud, &r);
	assert_true(fabs(eskel_mesh_volume(mesh) - 4 * 6) < 1e-5);
	eskel_mesh_free(mesh);
	eskel_cloud_free(cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_voxel_is_a_box_in_the_world),
		cmocka_unit_test(any_voxels_have_a_closed_manifold),
		cmocka_unit_test(voxels_that_touch_in_an_edge_or_corner_are_apart),
		cmocka_unit_test(pinched_holes_stay_manifold),
		cmocka_unit_test(left_handed_affines_turn_nothing_inside_out),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
