#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "mesh.h"

#include <math.h>
#include <string.h>

static const float corners[8][3] = {
	{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {2, 3, 0}, {0, 0, 4}, {2, 0, 4}, {0, 3, 4}, {2, 3, 4}};
static const uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4}, {2, 6, 3},
	{3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

/* Boxes of 2 by 3 by 4 mm, of which the second has its first corner in that vertex of the first. */
static eskel_mesh *boxes(int count, int shared)
{
	eskel_mesh *mesh = esk_mesh_new((size_t)(8 * count), (size_t)(12 * count));
	assert_non_null(mesh);
	for (int b = 0; b < count; b++) {
		for (int v = 0; v < 8; v++)
			for (int a = 0; a < 3; a++)
				mesh->vertices[8 * b + v][a] = corners[v][a] + (b && shared ? corners[shared][a] : 0);
		for (int t = 0; t < 12; t++)
			for (int c = 0; c < 3; c++)
				mesh->triangles[12 * b + t][c] = b && shared && !faces[t][c]
									 ? (uint32_t)shared
									 : faces[t][c] + (uint32_t)(8 * b);
	}
	return mesh;
}

static eskel_mesh_check_result check(const eskel_mesh *mesh)
{
	eskel_mesh_check_result r;
	assert_int_equal(eskel_mesh_check(mesh, &r), ESKEL_OK);
	return r;
}

static void a_box_is_measured(void **state)
{
	(void)state;
	eskel_mesh *mesh = boxes(1, 0);
	assert_true(fabs(eskel_mesh_area(mesh) - 52) < 1e-12);
	assert_true(fabs(eskel_mesh_volume(mesh) - 24) < 1e-12);
	const eskel_mesh_check_result r = check(mesh);
	assert_true(r.is_manifold);
	assert_int_equal(r.components, 1);
	assert_int_equal(r.euler, 2);
	assert_true(fabs(r.least_angle - atan(0.5) * 180 / 3.14159265358979323846) < 1e-9);
	eskel_mesh_free(mesh);
}

static void normals_that_are_not_known_are_those_of_the_triangles(void **state)
{
	(void)state;
	eskel_mesh *mesh = boxes(1, 0);
	mesh->normals[0][0] = 1;
	mesh->normals[1][1] = NAN;
	assert_int_equal(esk_mesh_complete_normals(mesh), ESKEL_OK);
	assert_true(mesh->normals[0][0] == 1 && mesh->normals[0][1] == 0);
	for (int v = 1; v < 8; v++)
		for (int a = 0; a < 3; a++)
			assert_true((mesh->normals[v][a] > 0) == (corners[v][a] > 0));
	eskel_mesh_free(mesh);
}

static void each_fault_is_counted(void **state)
{
	(void)state;
	eskel_mesh *mesh = boxes(1, 0);
	mesh->triangle_count--;
	eskel_mesh_check_result r = check(mesh);
	assert_int_equal(r.boundary_edges, 3);
	assert_false(r.is_manifold);
	mesh->triangle_count++;

	mesh->triangles[3][0] = faces[3][1], mesh->triangles[3][1] = faces[3][0];
	r = check(mesh);
	assert_int_equal(r.turned_edges, 3);
	assert_int_equal(r.boundary_edges, 0);
	assert_false(r.is_manifold);

	mesh->triangles[3][0] = mesh->triangles[3][1];
	assert_int_equal(eskel_mesh_check(mesh, &r), ESKEL_INVALID);
	mesh->triangles[3][0] = 8;
	assert_int_equal(eskel_mesh_check(mesh, &r), ESKEL_INVALID);
	eskel_mesh_free(mesh);

	mesh = boxes(2, 7);
	r = check(mesh);
	assert_int_equal(r.crowded_vertices, 1);
	assert_int_equal(r.crowded_edges, 0);
	assert_int_equal(r.components, 1);
	assert_false(r.is_manifold);
	eskel_mesh_free(mesh);

	mesh = boxes(2, 0);
	assert_int_equal(check(mesh).components, 2);
	for (int t = 12; t < 24; t++)
		for (int c = 0; c < 3; c++)
			if (mesh->triangles[t][c] == 8 || mesh->triangles[t][c] == 9)
				mesh->triangles[t][c] -= 8;
	r = check(mesh);
	assert_int_equal(r.crowded_edges, 1);
	assert_false(r.is_manifold);
	eskel_mesh_free(mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_box_is_measured),
		cmocka_unit_test(normals_that_are_not_known_are_those_of_the_triangles),
		cmocka_unit_test(each_fault_is_counted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
