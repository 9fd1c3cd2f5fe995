#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "bytes.h"
#include "mesh.h"

#include <stdlib.h>
#include <string.h>

/* A tetrahedron of 2, 3 and 4 mm. */
static eskel_mesh *tetrahedron(void)
{
	static const float vertices[4][3] = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
	static const uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
	eskel_mesh *mesh = esk_mesh_new(4, 4);
	assert_non_null(mesh);
	memcpy(mesh->vertices, vertices, sizeof vertices);
	memcpy(mesh->triangles, triangles, sizeof triangles);
	assert_int_equal(esk_mesh_complete_normals(mesh), ESKEL_OK);
	return mesh;
}

typedef struct {
	uint8_t bytes[4096];
	size_t size, calls, most_calls; /* 0: any number */
} file;

static bool append(void *context, const uint8_t *bytes, size_t size)
{
	file *f = context;
	assert_true(size <= sizeof f->bytes - f->size);
	memcpy(f->bytes + f->size, bytes, size);
	f->size += size;
	return ++f->calls != f->most_calls;
}

static file written(eskel_mesh_format format, eskel_frame frame)
{
	file f = {.size = 0};
	eskel_mesh *mesh = tetrahedron();
	assert_int_equal(eskel_mesh_write(mesh, format, frame, append, &f), ESKEL_OK);
	eskel_mesh_free(mesh);
	f.bytes[f.size] = 0;
	return f;
}

static void stl_holds_triangles_and_says_its_frame(void **state)
{
	(void)state;
	const file ras = written(ESKEL_MESH_STL, ESKEL_FRAME_RAS), lps = written(ESKEL_MESH_STL, ESKEL_FRAME_LPS);
	assert_int_equal(ras.size, 84 + 4 * 50);
	assert_non_null(strstr((const char *)ras.bytes, "SPACE=RAS"));
	assert_non_null(strstr((const char *)lps.bytes, "SPACE=LPS"));
	assert_int_equal(esk_bytes_get_u32(ras.bytes + 80), 4);
	/* The first triangle: normal (0, 0, -1), then corners 0, 2 and 1. */
	const float expected[12] = {0, 0, -1, 0, 0, 0, 0, 3, 0, 2, 0, 0};
	for (size_t i = 0; i < 12; i++) {
		const float sign = i % 3 == 2 ? 1 : -1;
		assert_true(esk_bytes_get_f32(ras.bytes + 84 + 4 * i) == expected[i]);
		assert_true(esk_bytes_get_f32(lps.bytes + 84 + 4 * i) == sign * expected[i]);
	}
}

static void ply_and_obj_hold_normals_and_say_their_frame(void **state)
{
	(void)state;
	const file ply = written(ESKEL_MESH_PLY, ESKEL_FRAME_LPS), obj = written(ESKEL_MESH_OBJ, ESKEL_FRAME_LPS);
	const char *header = (const char *)ply.bytes, *end = strstr(header, "end_header\n");
	assert_non_null(strstr(header, "\ncomment SPACE=LPS\n"));
	assert_non_null(end);
	assert_int_equal(ply.size, (size_t)(end - header) + strlen("end_header\n") + 4 * 24 + 4 * 13);
	const char *text = (const char *)obj.bytes;
	assert_non_null(strstr(text, "# SPACE=LPS\n"));
	assert_non_null(strstr(text, "\nv -2 0 0\nv 0 -3 0\nv 0 0 4\nvn "));
	assert_non_null(strstr(text, "\nf 2//2 3//3 4//4\n"));
}

static void glb_is_made_of_aligned_chunks(void **state)
{
	(void)state;
	const file glb = written(ESKEL_MESH_GLB, ESKEL_FRAME_RAS);
	const uint32_t json = esk_bytes_get_u32(glb.bytes + 12);
	assert_memory_equal(glb.bytes, "glTF", 4);
	assert_int_equal(esk_bytes_get_u32(glb.bytes + 8), glb.size);
	assert_int_equal(json % 4, 0);
	assert_memory_equal(glb.bytes + 20 + json + 4, "BIN", 4);
	assert_int_equal(esk_bytes_get_u32(glb.bytes + 20 + json), 4 * 24 + 4 * 12);
	assert_int_equal(glb.size, 28 + json + 4 * 24 + 4 * 12);
}

static void a_sink_may_stop(void **state)
{
	(void)state;
	eskel_mesh *mesh = tetrahedron();
	for (int format = 0; format < ESKEL_MESH_FORMAT_COUNT; format++) {
		file f = {.most_calls = 1};
		assert_int_equal(eskel_mesh_write(mesh, (eskel_mesh_format)format, ESKEL_FRAME_RAS, append, &f),
			ESKEL_CANCELLED);
	}
	file f = {.size = 0};
	assert_int_equal(eskel_mesh_write(mesh, ESKEL_MESH_FORMAT_COUNT, ESKEL_FRAME_RAS, append, &f), ESKEL_INVALID);
	mesh->triangle_count = 0;
	assert_int_equal(eskel_mesh_write(mesh, ESKEL_MESH_GLB, ESKEL_FRAME_RAS, append, &f), ESKEL_EMPTY);
	assert_int_equal(f.size, 0);
	eskel_mesh_free(mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(stl_holds_triangles_and_says_its_frame),
		cmocka_unit_test(ply_and_obj_hold_normals_and_say_their_frame),
		cmocka_unit_test(glb_is_made_of_aligned_chunks),
		cmocka_unit_test(a_sink_may_stop),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
