#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"
#include "store_sample.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The bones of the feet of two people, each a map of many labels and a table of their names. */
#define MAPS "../shared/data/maps/"
/* Her left talus, and its mirror image. */
#define TALUS "../shared/data/VisibleHuman_Denver/VHF_talus_L.nii.gz"
#define OTHER_TALUS "../shared/data/VisibleHuman_Denver/VHM_talus_L.nii.gz"
#define MIRRORED "../shared/data/io_variants/VHF_talus_L_MIRRORED_x.nii.gz"

/* "&label.1.name=calcaneus_L&label.2..." from a table of label,name,... */
static char *names_of(const char *path)
{
	size_t size;
	char *table = (char *)file_read(path, &size), *query = calloc(1, 4 * size + 1), *end = query;
	assert_non_null(query);
	table[size] = 0;
	strtok(table, "\n");
	for (char *line; (line = strtok(NULL, "\n"));) {
		int label;
		char name[64];
		assert_int_equal(sscanf(line, "%d,%63[^,]", &label, name), 2);
		end += sprintf(end, "&label.%d.name=%s", label, name);
	}
	free(table);
	return query;
}

static void skip_without(const char *path)
{
	if (access(path, R_OK) == 0)
		return;
	print_message("skipped: there is no %s\n", path);
	skip();
}

static volume_file read_volume(const char *path)
{
	volume_file file;
	file.bytes = file_read(path, &file.size);
	return file;
}

static void the_feet_of_one_tell_those_of_another(void **state)
{
	api_fixture *f = *state;
	skip_without(MAPS "VHF_feet.nii.gz");
	volume_file hers = read_volume(MAPS "VHF_feet.nii.gz"), his = read_volume(MAPS "VHM_feet.nii.gz");
	char *her_names = names_of(MAPS "VHF_feet_labels.csv"), *his_names = names_of(MAPS "VHM_feet_labels.csv");
	answer enrolled = post_volume(f->api, &hers, "/shapes?subject=VHF&sex=F%s", her_names);
	assert_status(&enrolled, 201);
	answer a = post_volume(f->api, &his, "/recognize?mode=exact%s", his_names);
	assert_status(&a, 200);

	int known = 0, right_class = 0, right_side = 0, wrong_side = 0;
	size_t i;
	json_t *result;
	json_array_foreach (at(&a, "results"), i, result) {
		const json_t *query = json_object_get(result, "query"), *verdict = json_object_get(result, "verdict");
		const json_t *class = json_object_get(query, "class");
		if (strncmp(json_string_value(class), "metatarsal", 10) == 0) /* only his map has them */
			continue;
		known++;
		right_class += json_equal(class, json_object_get(verdict, "class"));
		right_side += json_is_true(json_object_get(verdict, "agrees"));
		wrong_side += json_is_false(json_object_get(verdict, "agrees"));
	}
	if (right_class < known || right_side < 12 || wrong_side > 0)
		fail_msg("of %d bones %d classes and %d sides are right, %d wrong", known, right_class, right_side,
			wrong_side);
	answer_free(&a);
	answer_free(&enrolled);
	volume_free(&hers);
	volume_free(&his);
	free(her_names);
	free(his_names);
}

static void a_mirrored_bone_is_found_out(void **state)
{
	api_fixture *f = *state;
	skip_without(MIRRORED);
	volume_file other = read_volume(OTHER_TALUS), good = read_volume(TALUS), mirrored = read_volume(MIRRORED);
	answer enrolled = post_volume(f->api, &other, "/shapes?name=talus_left");
	assert_status(&enrolled, 201);
	answer right = post_volume(f->api, &good, "/recognize?name=talus_left");
	answer wrong = post_volume(f->api, &mirrored, "/recognize?name=talus_left");
	assert_string_equal(text_at(&right, "results.0.verdict.side"), "left");
	assert_true(json_is_true(at(&right, "results.0.verdict.agrees")));
	assert_string_equal(text_at(&wrong, "results.0.verdict.side"), "right");
	assert_true(json_is_false(at(&wrong, "results.0.verdict.agrees")));
	answer_free(&enrolled);
	answer_free(&right);
	answer_free(&wrong);
	volume_free(&other);
	volume_free(&good);
	volume_free(&mirrored);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(the_feet_of_one_tell_those_of_another),
		api_test(a_mirrored_bone_is_found_out),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
