#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"
#include "nifti_file.h"

#include <stdlib.h>
#include <string.h>

enum { extent = 24, voxel_count = extent * extent * extent, uint8 = 2, float32 = 16 };

/* A cube of 12 voxels, from 4 on, around a cavity of 2, and beside it a piece of 3 voxels. */
static void fill_cube(double *values)
{
	memset(values, 0, voxel_count * sizeof *values);
	for (int i = 0; i < voxel_count; i++) {
		const int at[3] = {i % extent, i / extent % extent, i / (extent * extent)};
		bool inside = true, cavity = true;
		for (int a = 0; a < 3; a++) {
			inside = inside && at[a] >= 4 && at[a] < 16;
			cavity = cavity && at[a] >= 9 && at[a] < 11;
		}
		values[i] = (inside && !cavity) || (at[2] == 20 && at[1] == 20 && at[0] >= 18 && at[0] < 21);
	}
}

static volume_file written(const nifti_file *file, const double *values)
{
	volume_file made;
	made.bytes = nifti_file_write(file, values, voxel_count, &made.size);
	return made;
}

static const char *text_of(const answer *a, const char *code)
{
	const json_t *warnings = at(a, "shapes.0.warnings");
	size_t i;
	json_t *warning;
	json_array_foreach (warnings, i, warning)
		if (strcmp(json_string_value(json_object_get(warning, "code")), code) == 0)
			return json_string_value(json_object_get(warning, "text"));
	fail_msg("no warning %s among %zu", code, json_array_size(warnings));
	return NULL;
}

static void the_grid_and_the_pieces_are_warned_of_with_numbers(void **state)
{
	api_fixture *f = *state;
	double values[voxel_count];
	fill_cube(values);
	nifti_file nifti = nifti_file_new(1, false, uint8, extent, extent, extent);
	nifti.srow[0][1] = .25;
	nifti.srow[2][2] = 3;
	volume_file file = written(&nifti, values);
	answer a = post_volume(f->api, &file, "/shapes");
	assert_status(&a, 201);
	assert_int_equal(json_array_size(at(&a, "shapes.0.warnings")), 4);
	assert_string_equal(text_of(&a, "anisotropic"),
		"the voxels are 1 x 1.031 x 3 mm: what is thinner than the longest edge is lost");
	assert_string_equal(text_of(&a, "not_orthogonal"),
		"two axes of the grid meet at 76.0 degrees, not at right angles: this is kept, but is it meant?");
	assert_string_equal(text_of(&a, "fragmented"),
		"the object is in 2 pieces: the largest has 1720 of 1723 voxels, the next 3");
	assert_string_equal(text_of(&a, "holes"), "the object encloses 1 cavity of 8 voxels");
	answer_free(&a);
	volume_free(&file);
}

static void weights_make_one_object_and_weigh_its_voxels(void **state)
{
	api_fixture *f = *state;
	double values[voxel_count];
	fill_cube(values);
	for (int i = 0; i < voxel_count; i++)
		values[i] *= i % extent < 10 ? .25 : .75;
	const nifti_file nifti = nifti_file_new(1, false, float32, extent, extent, extent);
	volume_file file = written(&nifti, values);
	answer labels = post_volume(f->api, &file, "/shapes");
	assert_status(&labels, 422);
	answer a = post_volume(f->api, &file, "/shapes?weights=true&name=femur_left");
	assert_status(&a, 201);
	assert_int_equal(json_array_size(at(&a, "shapes")), 1);
	assert_string_equal(text_at(&a, "shapes.0.side"), "left");
	assert_true(number_at(&a, "shapes.0.voxels") == 1723);
	/* Sums over x = 4..9 of weight 1 and x = 10..15 of weight 3, 864 voxels each but for the cavity and the piece. */
	const double weight = 860 + 3 * (860 + 3), moment = 864 * 6.5 - 4 * 9 + 3 * (864 * 12.5 - 4 * 10 + 57);
	assert_true(number_at(&a, "shapes.0.centre_mm.0") - moment / weight < 1e-3);
	assert_true(moment / weight - number_at(&a, "shapes.0.centre_mm.0") < 1e-3);
	answer same = post_volume(f->api, &file, "/recognize?weights=true");
	assert_status(&same, 200);
	assert_true(number_at(&same, "results.0.neighbours.0.distance") == 0);
	answer bad = post_volume(f->api, &file, "/shapes?weights=yes");
	assert_status(&bad, 400);
	answer_free(&labels);
	answer_free(&a);
	answer_free(&same);
	answer_free(&bad);
	volume_free(&file);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(the_grid_and_the_pieces_are_warned_of_with_numbers),
		api_test(weights_make_one_object_and_weigh_its_voxels),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
