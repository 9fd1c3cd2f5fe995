#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "mesh_file.h"
#include "synthetic.h"
#include "volume_decode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* By 40 degrees about (1, 2, 3), and away from the origin. */
static const double turned[3][4] = {
	{0.7827490, -0.4818116, 0.3936247, 20.3},
	{0.5486550, 0.8328888, -0.0715442, -31.7},
	{-0.2933764, 0.2719625, 0.9164838, 512.9},
};

static eskel_volume *decoded(const mesh_file *mesh, mesh_format format, const char *comment, double spacing)
{
	size_t size;
	uint8_t *bytes = mesh_write(mesh, format, comment, &size);
	eskel_volume *volume;
	eskel_error error;
	if (volume_decode(bytes, size, size, &(eskel_volume_options){.spacing = spacing}, &volume, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	free(bytes);
	return volume;
}

static eskel_cloud *cloud_of(const eskel_volume *volume)
{
	eskel_cloud *cloud = NULL;
	eskel_error error;
	assert_int_equal(eskel_volume_label_count(volume), 1);
	assert_int_equal(eskel_volume_label(volume, 0), 1);
	if (eskel_volume_cloud(volume, 1, &cloud, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
	return cloud;
}

static eskel_cloud *voxelised(const mesh_file *mesh, double spacing)
{
	eskel_volume *volume = decoded(mesh, MESH_STL_BINARY, "", spacing);
	eskel_cloud *cloud = cloud_of(volume);
	eskel_volume_free(volume);
	return cloud;
}

static void round_to_floats(mesh_file *mesh)
{
	for (size_t i = 0; i < mesh->vertex_count; i++)
		for (int r = 0; r < 3; r++)
			mesh->vertices[i][r] = (double)(float)mesh->vertices[i][r];
}

/* ---------------------------------------------------------------------------------------------- volumes */

/* Frees the mesh. */
static void assert_volume(mesh_file mesh, double spacing, double volume)
{
	eskel_cloud *cloud = voxelised(&mesh, spacing);
	double got = eskel_cloud_volume(cloud);
	if (fabs(got - volume) > 0.01 * volume)
		fail_msg("the volume is %g, expected %g", got, volume);
	if (spacing == 0 && (cloud->voxels < 99000 || cloud->voxels > 101000))
		fail_msg("there are %llu voxels", (unsigned long long)cloud->voxels);
	eskel_cloud_free(cloud);
	mesh_free(&mesh);
}

static mesh_file moved(mesh_file mesh)
{
	mesh_move(&mesh, turned);
	return mesh;
}

static void solids_have_the_volume_of_their_formula(void **state)
{
	(void)state;
	const double zero[3] = {0, 0, 0}, end[3] = {10, 20, 40};
	assert_volume(mesh_sphere(25, 100), 0, 4.0 / 3 * pi * 25 * 25 * 25);
	assert_volume(moved(mesh_sphere(25, 100)), 0, 4.0 / 3 * pi * 25 * 25 * 25);
	assert_volume(mesh_torus(30, 10, 100), 0, 2 * pi * pi * 30 * 10 * 10);
	assert_volume(moved(mesh_torus(30, 10, 100)), 0, 2 * pi * pi * 30 * 10 * 10);
	assert_volume(mesh_box(zero, end), 0.25, 8000);
	assert_volume(mesh_box(zero, end), 0, 8000);
	assert_volume(moved(mesh_box(zero, end)), 0, 8000);
}

static mesh_file turned_inside_out(mesh_file mesh)
{
	for (size_t i = 0; i < mesh.face_count; i++) {
		const unsigned second = mesh.faces[i][1];
		mesh.faces[i][1] = mesh.faces[i][3];
		mesh.faces[i][3] = second;
	}
	return mesh;
}

/* Plates and hollow boxes, down to where walls are half a voxel thick: layers along the axes would be up to 30 % off. */
static void thin_walls_along_the_axes_keep_their_volume(void **state)
{
	(void)state;
	const double zero[3] = {0, 0, 0};
	for (double thickness = 20; thickness > 0.5; thickness /= 1.3) {
		const double plate[3] = {200, 150, thickness}, outer[3] = {100, 110, 90};
		const double from[3] = {thickness, thickness, thickness},
			     to[3] = {100 - thickness, 110 - thickness, 90 - thickness};
		const double cavity = (100 - 2 * thickness) * (110 - 2 * thickness) * (90 - 2 * thickness);
		assert_volume(mesh_box(zero, plate), 0, 200 * 150 * thickness);
		assert_volume(mesh_join(mesh_box(zero, outer), turned_inside_out(mesh_box(from, to))), 0,
			100 * 110 * 90 - cavity);
	}
}

static void a_mesh_turned_inside_out_is_the_same_solid(void **state)
{
	(void)state;
	static const double mirror[3][4] = {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
	mesh_file mesh = mesh_sphere(10, 50);
	mesh_move(&mesh, mirror);
	assert_volume(mesh, 0, 4.0 / 3 * pi * 1000);
}

static void parts_that_overlap_or_touch_unite(void **state)
{
	(void)state;
	const double zero[3] = {0, 0, 0}, end[3] = {10, 10, 10}, from[3] = {5, 2, 0}, to[3] = {15, 10, 10};
	assert_volume(mesh_join(mesh_box(zero, end), mesh_box(from, to)), 0.25, 1400);
	assert_volume(moved(mesh_join(mesh_box(zero, end), mesh_box(from, to))), 0.25, 1400);
	/* The common face goes through the centres of voxels. */
	const double middle[3] = {4.5, 9, 9}, start[3] = {4.5, 0, 0}, last[3] = {9, 9, 9};
	mesh_file touching = mesh_join(mesh_box(zero, middle), mesh_box(start, last));
	eskel_cloud *cloud = voxelised(&touching, 1);
	assert_int_equal(cloud->voxels, 729);
	assert_int_equal(cloud->run_count, 81);
	eskel_cloud_free(cloud);
	mesh_free(&touching);
}

/* ---------------------------------------------------------------------------------------------- winding numbers */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The solid angle of a triangle seen from the origin (Van Oosterom and Strackee 1983). */
static double solid_angle(double corners[3][3], bool *on_surface)
{
	const double *a = corners[0], *b = corners[1], *c = corners[2];
	double volume = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
			a[2] * (b[0] * c[1] - b[1] * c[0]);
	double la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
	double other = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
	*on_surface |= fabs(volume) < 1e-9 && other < 1e-9;
	return 2 * atan2(volume, other);
}

static double winding_number(const mesh_file *mesh, const double at[3], bool *on_surface)
{
	double sum = 0;
	*on_surface = false;
	for (size_t t = 0; t < 2 * mesh->face_count; t++) {
		const unsigned *face = mesh->faces[t / 2];
		if (face[1 + t % 2] == face[2 + t % 2])
			continue;
		double corners[3][3];
		for (size_t c = 0; c < 3; c++)
			for (int r = 0; r < 3; r++)
				corners[c][r] = mesh->vertices[face[c ? c + t % 2 : 0]][r] - at[r];
		sum += solid_angle(corners, on_surface);
	}
	return sum / (4 * pi);
}

/* Of voxels of 1 mm in a box of less than 10 mm. */
static void paint(const eskel_cloud *cloud, const eskel_affine *grid, bool painted[10][10][10])
{
	unsigned offset[3];
	for (int r = 0; r < 3; r++)
		offset[r] = (unsigned)lround(cloud->affine.m[r][3] - grid->m[r][3]);
	memset(painted, 0, 1000);
	for (size_t i = 0; i < cloud->run_count; i++)
		for (unsigned x = cloud->runs[i].x_first; x <= cloud->runs[i].x_last; x++)
			painted[cloud->runs[i].z + offset[2]][cloud->runs[i].y + offset[1]][x + offset[0]] = true;
}

/* Returns how many centres were on no surface. */
static unsigned compare_with_winding_numbers(const mesh_file *mesh, const eskel_volume *volume)
{
	static bool painted[10][10][10];
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	eskel_cloud *cloud = cloud_of(volume);
	unsigned compared = 0;
	paint(cloud, &info->affine, painted);
	for (unsigned k = 0; k < info->extent[2]; k++)
		for (unsigned j = 0; j < info->extent[1]; j++)
			for (unsigned i = 0; i < info->extent[0]; i++) {
				const double at[3] = {
					i + info->affine.m[0][3], j + info->affine.m[1][3], k + info->affine.m[2][3]};
				bool on_surface, inside = fabs(winding_number(mesh, at, &on_surface)) > 0.5;
				if (!on_surface && inside != painted[k][j][i])
					fail_msg("voxel (%u, %u, %u) is %s", i, j, k, inside ? "inside" : "outside");
				compared += !on_surface;
			}
	eskel_cloud_free(cloud);
	return compared;
}

/* Corners are whole multiples of unit. */
static mesh_file random_tetrahedra(uint64_t *seed, unsigned count, double unit)
{
	mesh_file mesh = {0};
	for (unsigned n = 0; n < count; n++) {
		double corners[4][3];
		for (int i = 0; i < 4; i++)
			for (int r = 0; r < 3; r++)
				corners[i][r] = unit * floor(synthetic_uniform(seed) * 9 / unit);
		mesh_file next = mesh_tetrahedron(corners);
		mesh = n == 0 ? next : mesh_join(mesh, next);
	}
	return mesh;
}

/* Halves lay vertices and edges on the rows and centres of voxels. The voxeliser rounds to 1024ths of a voxel from the grid's
 * corner, which lies at halves of the unit: 512ths it does not round. */
static void voxels_are_inside_as_winding_numbers_by_solid_angles_say(void **state)
{
	(void)state;
	static const double units[] = {1, 0.5, 1.0 / 512};
	uint64_t seed = 5;
	unsigned compared = 0, solids = 0;
	for (unsigned n = 0; n < 600; n++) {
		mesh_file mesh = random_tetrahedra(&seed, 1 + n % 4, units[n % 3]);
		size_t size;
		uint8_t *bytes = mesh_write(&mesh, MESH_PLY_LITTLE_ENDIAN, "", &size);
		eskel_volume *volume = NULL;
		eskel_status status =
			volume_decode(bytes, size, size, &(eskel_volume_options){.spacing = 1}, &volume, NULL);
		assert_true(status == ESKEL_OK || status == ESKEL_EMPTY);
		if (status == ESKEL_OK) {
			compared += compare_with_winding_numbers(&mesh, volume);
			solids++;
		}
		eskel_volume_free(volume);
		free(bytes);
		mesh_free(&mesh);
	}
	assert_true(solids > 500);
	assert_true(compared > 100000);
}

/* ---------------------------------------------------------------------------------------------- files */

static void assert_same_cloud(const eskel_cloud *a, const eskel_cloud *b)
{
	uint8_t *bytes[2];
	size_t sizes[2];
	assert_int_equal(eskel_cloud_encode(a, &bytes[0], &sizes[0]), ESKEL_OK);
	assert_int_equal(eskel_cloud_encode(b, &bytes[1], &sizes[1]), ESKEL_OK);
	assert_int_equal(sizes[0], sizes[1]);
	assert_memory_equal(bytes[0], bytes[1], sizes[0]);
	free(bytes[0]);
	free(bytes[1]);
}

static void every_format_gives_the_same_cloud_however_it_is_cut(void **state)
{
	(void)state;
	static const char *const names[] = {"STL", "STL", "PLY", "PLY", "PLY", "OBJ"};
	static const size_t pieces[] = {1, 49, 1000};
	mesh_file mesh = moved(mesh_torus(20, 7, 12));
	round_to_floats(&mesh);
	eskel_cloud *expected = voxelised(&mesh, 0.5);
	for (mesh_format format = 0; format < MESH_FORMAT_COUNT; format++) {
		size_t size;
		uint8_t *bytes = mesh_write(&mesh, format, "solid", &size);
		for (int p = 0; p < 3; p++) {
			eskel_error error;
			eskel_volume *volume;
			if (volume_decode(bytes, size, pieces[p], &(eskel_volume_options){.spacing = 0.5}, &volume,
				    &error) != ESKEL_OK)
				fail_msg("%s: %s", names[format], error.text);
			assert_string_equal(eskel_volume_get_info(volume)->format, names[format]);
			eskel_cloud *cloud = cloud_of(volume);
			assert_same_cloud(cloud, expected);
			eskel_cloud_free(cloud);
			eskel_volume_free(volume);
		}
		free(bytes);
	}
	eskel_cloud_free(expected);
	mesh_free(&mesh);
}

static void a_binary_stl_may_begin_with_solid_or_with_zeros(void **state)
{
	(void)state;
	mesh_file mesh = mesh_sphere(10, 8);
	size_t size;
	uint8_t *bytes = mesh_write(&mesh, MESH_STL_BINARY, "solid binary", &size);
	eskel_volume *volume;
	assert_int_equal(volume_decode(bytes, size, size, NULL, &volume, NULL), ESKEL_OK);
	eskel_volume_free(volume);
	memset(bytes, 0, 80);
	assert_int_equal(volume_decode(bytes, size, size, NULL, &volume, NULL), ESKEL_OK);
	eskel_volume_free(volume);
	free(bytes);
	mesh_free(&mesh);
}

/* A box off the origin; only its affine tells the spaces apart. */
static void comments_name_the_space(void **state)
{
	(void)state;
	const double least[3] = {10, 20, 30}, greatest[3] = {14, 26, 38};
	mesh_file mesh = mesh_box(least, greatest);
	for (mesh_format format = 0; format < MESH_FORMAT_COUNT; format++) {
		static const struct {
			const char *comment;
			double x, y;
			size_t warnings;
		} spaces[] = {{"", 10.5, 20.5, 2}, {"3D Slicer output. SPACE=RAS", 10.5, 20.5, 1},
			{"3D Slicer output. SPACE=LPS", -13.5, -25.5, 1}};
		for (int s = 0; s < 3; s++) {
			eskel_volume *volume = decoded(&mesh, format, spaces[s].comment, 1);
			const eskel_volume_info *info = eskel_volume_get_info(volume);
			assert_int_equal(info->warning_count, spaces[s].warnings);
			assert_int_equal(info->warnings[0].code, ESKEL_WARNING_UNIT_ASSUMED);
			if (spaces[s].warnings > 1)
				assert_int_equal(info->warnings[1].code, ESKEL_WARNING_NO_ORIENTATION);
			eskel_cloud *cloud = cloud_of(volume);
			assert_true(cloud->affine.m[0][3] == spaces[s].x);
			assert_true(cloud->affine.m[1][3] == spaces[s].y);
			assert_true(cloud->affine.m[2][3] == 30.5);
			assert_int_equal(cloud->voxels, 4 * 6 * 8);
			unsigned sides;
			assert_int_equal(eskel_volume_border(volume, 1, &sides), ESKEL_OK);
			assert_int_equal(sides, 0);
			eskel_cloud_free(cloud);
			eskel_volume_free(volume);
		}
	}
	mesh_free(&mesh);
}

/* ---------------------------------------------------------------------------------------------- warnings */

static void assert_last_warning(mesh_file mesh, double spacing, const char *code, const char *text)
{
	eskel_volume *volume = decoded(&mesh, MESH_PLY_ASCII, "SPACE=RAS", spacing);
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	const eskel_warning *last = &info->warnings[info->warning_count - 1];
	if (strcmp(eskel_warning_name(last->code), code) != 0 || strcmp(last->text, text) != 0)
		fail_msg("%s: %s", eskel_warning_name(last->code), last->text);
	eskel_volume_free(volume);
	mesh_free(&mesh);
}

static void warnings_say_how_voxels_differ_from_the_mesh(void **state)
{
	(void)state;
	const double zero[3] = {0, 0, 0}, end[3] = {10, 10, 10}, from[3] = {5, 2, 0}, to[3] = {15, 10, 10};
	const double third[3] = {10.4, 10, 10};
	assert_last_warning(
		mesh_box(zero, end), 1, "unit_assumed", "a mesh does not say its unit: millimetres are assumed");
	assert_last_warning(mesh_join(mesh_box(zero, end), mesh_box(from, to)), 1, "self_intersecting",
		"of 1400 mm^3 within the mesh, 400 are enclosed more than once and 0 inside out: parts overlap or "
		"the "
		"surface crosses itself; all are inside");
	assert_last_warning(mesh_join(mesh_box(zero, end), turned_inside_out(mesh_box(from, to))), 1,
		"self_intersecting",
		"of 1000 mm^3 within the mesh, 0 are enclosed more than once and 400 inside out: parts overlap or the "
		"surface crosses itself; all are inside");
	assert_last_warning(mesh_box(zero, third), 1, "volume_differs",
		"the voxels hold 1000 mm^3, the mesh 1040, -3.8 %: a finer spacing follows it closer");
}

/* ---------------------------------------------------------------------------------------------- refusals */

static void assert_refused(
	const void *bytes, size_t size, const eskel_volume_options *options, eskel_status status, const char *text)
{
	const size_t pieces[] = {size, 1, 7};
	for (int p = 0; p < 3; p++) {
		eskel_error error = {0};
		eskel_volume *volume;
		eskel_status got = volume_decode(bytes, size, pieces[p], options, &volume, &error);
		if (got != status || error.status != status || strcmp(error.text, text) != 0)
			fail_msg("%s: %s\nexpected %s: %s", eskel_status_text(got), error.text,
				eskel_status_text(status), text);
	}
}

#define SOLID "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\n"

static void a_spacing_is_for_meshes_and_weights_are_not(void **state)
{
	(void)state;
	static const char nrrd[] = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n"
				   "space: right-anterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n\n\1";
	static const char mesh[] = SOLID "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
	assert_refused(nrrd, sizeof nrrd - 1, &(eskel_volume_options){.spacing = 1}, ESKEL_BAD_GEOMETRY,
		"the spacing of 1 mm is for meshes, a NRRD file has its own: expected none");
	assert_refused(mesh, sizeof mesh - 1, &(eskel_volume_options){.weights = true}, ESKEL_UNSUPPORTED,
		"the file is a mesh, expected a volume of weights");
}

/* As a few kilobytes of gzip unfold to. */
static void what_unfolds_without_end_is_refused(void **state)
{
	(void)state;
	static const char *const lines[] = {"v 0 0 0\n", "#\n"};
	static char blank[1 << 20];
	memset(blank, '\n', sizeof blank);
	for (int i = 0; i < 2; i++) {
		eskel_volume *volume;
		eskel_error error = {0};
		eskel_status status = ESKEL_OK;
		unsigned pieces = 0;
		assert_int_equal(eskel_volume_new(NULL, &volume), ESKEL_OK);
		status = eskel_volume_feed(volume, lines[i], strlen(lines[i]), &error);
		for (; status == ESKEL_OK && pieces < 1000; pieces++)
			status = eskel_volume_feed(volume, blank, sizeof blank, &error);
		assert_int_equal(pieces, 8); /* lines count as 32 bytes */
		assert_int_equal(status, i == 0 ? ESKEL_TOO_LARGE : ESKEL_NOT_VOLUME);
		if (i == 0)
			assert_string_equal(
				error.text, "the mesh takes more than 268435456 bytes of text or binary values");
		eskel_volume_free(volume);
	}
}

static void limits_are_kept(void **state)
{
	(void)state;
	const double least[3] = {0, 0, 0}, greatest[3] = {4, 6, 8};
	mesh_file mesh = mesh_box(least, greatest);
	size_t size;
	uint8_t *bytes = mesh_write(&mesh, MESH_STL_BINARY, "", &size);
	const int32_t two = 2;
	assert_refused(bytes, size, &(eskel_volume_options){.spacing = 1, .most_voxels = 191}, ESKEL_TOO_LARGE,
		"the grid has 4 x 6 x 8 = 192 voxels, expected at most 191");
	assert_refused(bytes, size, &(eskel_volume_options){.spacing = 1, .most_runs = 47}, ESKEL_TOO_LARGE,
		"the mesh crosses the rows of voxels more than 94 times");
	assert_refused(bytes, size, &(eskel_volume_options){.spacing = 1, .labels = &two, .label_count = 1},
		ESKEL_EMPTY, "no voxel has a wanted label");
	assert_refused(bytes, size, &(eskel_volume_options){.spacing = 1.1e-4}, ESKEL_TOO_LARGE,
		"the mesh is 8 mm long, 72727 voxels of 0.00011 mm, expected at most 65535");
	assert_refused(bytes, size, &(eskel_volume_options){.spacing = 1e5}, ESKEL_BAD_GEOMETRY,
		"the voxel spacing along axis 0 is 100000 mm, expected 0.0001 to 10000 mm");
	mesh_file ring = mesh_torus(20, 5, 20);
	size_t ring_size;
	uint8_t *ring_bytes = mesh_write(&ring, MESH_STL_BINARY, "", &ring_size);
	assert_refused(ring_bytes, ring_size, &(eskel_volume_options){.spacing = 100}, ESKEL_EMPTY,
		"no voxel of 100 mm has its centre inside the mesh");
	free(ring_bytes);
	mesh_free(&ring);
	assert_refused(bytes, size - 1, NULL, ESKEL_TRUNCATED, "the file ends before the end of its STL mesh");
	assert_int_equal(
		eskel_volume_new(&(eskel_volume_options){.spacing = -1}, &(eskel_volume *){NULL}), ESKEL_INVALID);
	uint8_t *longer = realloc(bytes, size + 1);
	assert_non_null(longer);
	longer[size] = 0;
	assert_refused(longer, size + 1, NULL, ESKEL_MALFORMED, "the file goes on after its last triangle");
	const uint8_t too_many[4] = {1, 0, 0, 1};
	memcpy(longer + 80, too_many, 4);
	assert_refused(
		longer, size, NULL, ESKEL_TOO_LARGE, "the mesh has 16777217 triangles, expected at most 4194304");
	free(longer);
	mesh_free(&mesh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(solids_have_the_volume_of_their_formula),
		cmocka_unit_test(thin_walls_along_the_axes_keep_their_volume),
		cmocka_unit_test(a_mesh_turned_inside_out_is_the_same_solid),
		cmocka_unit_test(parts_that_overlap_or_touch_unite),
		cmocka_unit_test(voxels_are_inside_as_winding_numbers_by_solid_angles_say),
		cmocka_unit_test(every_format_gives_the_same_cloud_however_it_is_cut),
		cmocka_unit_test(a_binary_stl_may_begin_with_solid_or_with_zeros),
		cmocka_unit_test(comments_name_the_space),
		cmocka_unit_test(warnings_say_how_voxels_differ_from_the_mesh),
		cmocka_unit_test(a_spacing_is_for_meshes_and_weights_are_not),
		cmocka_unit_test(what_unfolds_without_end_is_refused),
		cmocka_unit_test(limits_are_kept),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
