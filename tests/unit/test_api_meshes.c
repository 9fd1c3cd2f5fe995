#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"
#include "mesh_file.h"

#include <stdlib.h>
#include <string.h>

static answer post_mesh(eskel_api *api, const mesh_file *mesh, mesh_format format, const char *target)
{
	volume_file file;
	file.bytes = mesh_write(mesh, format, "SPACE=RAS", &file.size);
	answer a = post_volume(api, &file, "%s", target);
	free(file.bytes);
	return a;
}

static void a_mesh_is_a_volume_with_one_label(void **state)
{
	api_fixture *f = *state;
	mesh_file mesh = mesh_torus(20, 8, 40);
	answer a = post_mesh(f->api, &mesh, MESH_STL_BINARY, "/shapes?name=ring");
	assert_status(&a, 201);
	assert_true(number_at(&a, "shapes.0.label") == 1);
	assert_in_range((unsigned)number_at(&a, "shapes.0.voxels"), 99500, 100500);
	assert_int_equal(json_array_size(at(&a, "shapes.0.warnings")), 1);
	assert_string_equal(text_at(&a, "shapes.0.warnings.0.code"), "unit_assumed");
	answer_free(&a);

	a = post_mesh(f->api, &mesh, MESH_OBJ, "/recognize?label.1.name=ring");
	assert_status(&a, 200);
	assert_string_equal(text_at(&a, "results.0.neighbours.0.name"), "ring");
	assert_true(number_at(&a, "results.0.neighbours.0.distance") < 0.01);
	answer_free(&a);

	a = post_mesh(f->api, &mesh, MESH_PLY_BIG_ENDIAN, "/check?name=ring");
	assert_status(&a, 200);
	answer_free(&a);
	mesh_free(&mesh);
}

static void spacing_is_that_of_the_voxels(void **state)
{
	api_fixture *f = *state;
	const double least[3] = {0, 0, 0}, greatest[3] = {10, 20, 30};
	mesh_file mesh = mesh_box(least, greatest);
	answer a = post_mesh(f->api, &mesh, MESH_PLY_ASCII, "/shapes?spacing=0.5");
	assert_status(&a, 201);
	assert_true(number_at(&a, "shapes.0.voxels") == 20 * 40 * 60);
	assert_true(number_at(&a, "shapes.0.volume_mm3") == 6000);
	answer_free(&a);
	static const char *const wrong[] = {"0", "-1", "1001", "0.0001", "x", "1e0", ""};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char target[40] = "/shapes?spacing=";
		a = post_mesh(f->api, &mesh, MESH_STL_ASCII, strcat(target, wrong[i]));
		assert_says(&a, 400, "expected millimetres, 0.001 to 1000");
		answer_free(&a);
	}
	mesh_free(&mesh);
}

static void an_open_mesh_is_refused_with_where_it_is_open(void **state)
{
	api_fixture *f = *state;
	const double least[3] = {1, 2, 3}, greatest[3] = {10, 20, 30};
	mesh_file mesh = mesh_box(least, greatest);
	mesh.face_count--;
	answer a = post_mesh(f->api, &mesh, MESH_STL_BINARY, "/shapes");
	assert_says(&a, 422,
		"the mesh is open: 4 edges are not shared by opposite triangles, the first from (1, 2, 30) to (1, 20, "
		"30) mm");
	answer_free(&a);
	mesh_free(&mesh);
}

/* The lattice has its origin in the middle of the box, which is a ring's hole. */
static void a_step_that_leaps_over_the_surface_is_refused(void **state)
{
	api_fixture *f = *state;
	mesh_file mesh = mesh_torus(20, 5, 40);
	answer ring = post_mesh(f->api, &mesh, MESH_STL_BINARY, "/shapes?spacing=1");
	assert_status(&ring, 201);
	answer a = get(f->api, "/shapes/%s/mesh?step=1000", text_at(&ring, "shapes.0.id"));
	assert_says(&a, 422, "no surface was met from 16 seeds");
	answer_free(&a);
	answer_free(&ring);
	mesh_free(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_mesh_is_a_volume_with_one_label),
		api_test(spacing_is_that_of_the_voxels),
		api_test(an_open_mesh_is_refused_with_where_it_is_open),
		api_test(a_step_that_leaps_over_the_surface_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
