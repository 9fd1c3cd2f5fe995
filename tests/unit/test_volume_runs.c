#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"

#include <string.h>

static const eskel_volume_info grid = {.format = "made",
	.extent = {10, 8, 6},
	.affine = {{{2, 0, 0, 5}, {0, 2, 0, 6}, {0, 0, 3, 7}}},
	.warning_count = 1,
	.warnings = {{ESKEL_WARNING_UNIT_ASSUMED, "a guess"}}};

static eskel_volume *begun(const eskel_volume_options *options)
{
	eskel_volume *volume = NULL;
	assert_int_equal(eskel_volume_new(options, &volume), ESKEL_OK);
	assert_int_equal(eskel_volume_begin_runs(volume, &grid, NULL), ESKEL_OK);
	return volume;
}

static void add(eskel_volume *volume, int32_t label, eskel_run run)
{
	eskel_error error;
	if (eskel_volume_add_run(volume, label, run, &error) != ESKEL_OK)
		fail_msg("%s", error.text);
}

static void runs_in_any_order_become_labels_that_may_overlap(void **state)
{
	(void)state;
	eskel_volume *volume = begun(NULL);
	eskel_cloud *cloud = NULL;
	unsigned sides = 0;
	add(volume, 7, (eskel_run){4, 9, 3, 5});
	add(volume, 3, (eskel_run){4, 6, 3, 5});
	add(volume, 7, (eskel_run){1, 2, 0, 1});
	add(volume, 7, (eskel_run){3, 3, 0, 1}); /* goes on where the last one ends */
	assert_int_equal(eskel_volume_finish(volume, NULL), ESKEL_OK);
	assert_int_equal(eskel_volume_label_count(volume), 2);
	assert_int_equal(eskel_volume_label(volume, 0), 3);
	assert_int_equal(eskel_volume_label(volume, 1), 7);
	assert_int_equal(eskel_volume_border(volume, 7, &sides), ESKEL_OK);
	assert_int_equal(sides, 1 << 1 | 1 << 2 | 1 << 5);
	assert_int_equal(eskel_volume_cloud(volume, 7, &cloud, NULL), ESKEL_OK);
	assert_int_equal(cloud->voxels, 9);
	assert_int_equal(cloud->run_count, 2);
	assert_int_equal(cloud->runs[0].z, 0);
	assert_int_equal(cloud->runs[0].x_last, 2);
	eskel_cloud_free(cloud);
	eskel_volume_free(volume);
}

static void what_is_said_of_runs_is_kept(void **state)
{
	(void)state;
	eskel_volume *volume = begun(NULL);
	add(volume, 7, (eskel_run){0, 9, 3, 5});
	assert_int_equal(eskel_volume_name_label(volume, 7, "talus left", NULL), ESKEL_OK);
	assert_int_equal(eskel_volume_finish(volume, NULL), ESKEL_OK);
	const eskel_volume_info *info = eskel_volume_get_info(volume);
	assert_string_equal(info->format, "made");
	assert_memory_equal(&info->affine, &grid.affine, sizeof grid.affine);
	assert_int_equal(info->warning_count, 1);
	assert_string_equal(info->warnings[0].text, "a guess");
	assert_string_equal(eskel_volume_label_name(volume, 7), "talus left");
	eskel_volume_free(volume);
}

static void limits_and_kept_labels_hold_for_runs(void **state)
{
	(void)state;
	const int32_t label = 3;
	eskel_error error;
	eskel_volume *volume = begun(&(eskel_volume_options){.labels = &label, .label_count = 1, .most_runs = 2});
	add(volume, 7, (eskel_run){0, 9, 3, 5});
	add(volume, 3, (eskel_run){0, 1, 0, 0});
	add(volume, 3, (eskel_run){0, 1, 1, 0});
	assert_int_equal(eskel_volume_add_run(volume, 3, (eskel_run){0, 1, 2, 0}, &error), ESKEL_TOO_LARGE);
	assert_string_equal(error.text, "the labels have more than 2 runs of voxels");
	assert_int_equal(eskel_volume_finish(volume, NULL), ESKEL_TOO_LARGE);
	eskel_volume_free(volume);

	volume = begun(NULL);
	assert_int_equal(eskel_volume_finish(volume, &error), ESKEL_EMPTY);
	eskel_volume_free(volume);

	assert_int_equal(eskel_volume_new(&(eskel_volume_options){.most_voxels = 479}, &volume), ESKEL_OK);
	assert_int_equal(eskel_volume_begin_runs(volume, &grid, &error), ESKEL_TOO_LARGE);
	assert_string_equal(error.text, "the grid has 10 x 8 x 6 = 480 voxels, expected at most 479");
	eskel_volume_free(volume);
}

static void runs_outside_the_grid_are_refused(void **state)
{
	(void)state;
	static const eskel_run outside[] = {{0, 10, 0, 0}, {0, 1, 8, 0}, {0, 1, 0, 6}, {2, 1, 0, 0}};
	for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
		eskel_volume *volume = begun(NULL);
		assert_int_equal(eskel_volume_add_run(volume, 1, outside[i], NULL), ESKEL_INVALID);
		assert_int_equal(eskel_volume_finish(volume, NULL), ESKEL_INVALID);
		eskel_volume_free(volume);
	}
}

static void runs_and_bytes_do_not_mix(void **state)
{
	(void)state;
	eskel_volume *volume = begun(NULL);
	assert_int_equal(eskel_volume_feed(volume, "NRRD0004", 8, NULL), ESKEL_INVALID);
	eskel_volume_free(volume);
	assert_int_equal(eskel_volume_new(NULL, &volume), ESKEL_OK);
	assert_int_equal(eskel_volume_feed(volume, "NR", 2, NULL), ESKEL_OK);
	assert_int_equal(eskel_volume_begin_runs(volume, &grid, NULL), ESKEL_INVALID);
	eskel_volume_free(volume);
	assert_int_equal(eskel_volume_new(NULL, &volume), ESKEL_OK);
	assert_int_equal(eskel_volume_add_run(volume, 1, (eskel_run){0, 0, 0, 0}, NULL), ESKEL_INVALID);
	eskel_volume_free(volume);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(runs_in_any_order_become_labels_that_may_overlap),
		cmocka_unit_test(what_is_said_of_runs_is_kept),
		cmocka_unit_test(limits_and_kept_labels_hold_for_runs),
		cmocka_unit_test(runs_outside_the_grid_are_refused),
		cmocka_unit_test(runs_and_bytes_do_not_mix),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
