/* Maps with one planted error each, of blobs and, where they are there, of the bones of two people's feet. */
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

#define MAPS "../shared/data/maps/"

/* ---- blobs */

enum { EXTENT = 96, FIRST_VOXEL = 352, LABELS = 3 };

static const char *const classes[LABELS] = {"femur", "talus", "hamate"};
static const unsigned families[LABELS] = {3, 8, 13};
static const double centres[LABELS][3] = {{24, 24, 24}, {70, 24, 24}, {24, 70, 48}};

/* Three of each class, left and right ones of three people. */
static void enroll_library(eskel_api *api)
{
	for (unsigned class = 0; class < LABELS; class ++)
		for (unsigned member = 0; member < 6; member++) {
			char query[100], id[ESKEL_ID_SIZE];
			snprintf(query, sizeof query, "name=%s_%s&subject=S%u", classes[class],
				member % 2 ? "right" : "left", member / 2);
			enroll_blob(api, families[class], member, member % 2, query, id);
		}
}

typedef struct {
	blob blobs[LABELS];
	volume_file file; /* of one byte a voxel */
} map;

static void draw(map *m)
{
	volume_free(&m->file);
	m->file = volume_of_blobs(m->blobs, LABELS, EXTENT);
}

/* A left femur, talus and hamate: labels 1 to 3. */
static map map_new(void)
{
	map m = {0};
	for (int i = 0; i < LABELS; i++) {
		m.blobs[i] = blob_of_family(families[i], 7);
		m.blobs[i].label = i + 1;
		memcpy(m.blobs[i].centre, centres[i], sizeof centres[i]);
	}
	draw(&m);
	return m;
}

static uint8_t *voxel(map *m, int x, int y, int z)
{
	return &m->file.bytes[FIRST_VOXEL + (z * EXTENT + y) * EXTENT + x];
}

/* Gives all voxels of a label in a box another. */
static void relabel(map *m, int label, const int from[3], const int to[3], int other)
{
	for (int z = from[2]; z < to[2]; z++)
		for (int y = from[1]; y < to[1]; y++)
			for (int x = from[0]; x < to[0]; x++)
				if (*voxel(m, x, y, z) == label)
					*voxel(m, x, y, z) = (uint8_t)other;
}

static const int none[3] = {0, 0, 0}, all[3] = {EXTENT, EXTENT, EXTENT};

static void leave_as_it_is(map *m)
{
	(void)m;
}

static void mirror_talus(map *m)
{
	m->blobs[1].mirrored = 1;
	draw(m);
}

static void enlarge_hamate(map *m)
{
	m->blobs[2].length *= 1.6;
	m->blobs[2].width *= 1.6;
	m->blobs[2].knob *= 1.6;
	draw(m);
}

static void move_talus_to_the_border(map *m)
{
	m->blobs[1].centre[0] = EXTENT - 4;
	draw(m);
}

/* The talus becomes a part of the hamate's label. */
static void merge_talus_into_hamate(map *m)
{
	relabel(m, 2, none, all, 3);
}

static void cut_femur_in_two(map *m)
{
	relabel(m, 1, (int[3]){0, 0, 23}, (int[3]){EXTENT, EXTENT, 25}, 0);
}

static void carve_talus(map *m)
{
	relabel(m, 2, (int[3]){69, 23, 22}, (int[3]){73, 26, 26}, 0);
}

static void leave_little_of_talus(map *m)
{
	relabel(m, 2, none, (int[3]){EXTENT, EXTENT, 24}, 0);
	relabel(m, 2, (int[3]){0, 0, 25}, all, 0);
	relabel(m, 2, (int[3]){72, 0, 0}, all, 0);
}

/* A thin plate. */
static void replace_talus(map *m)
{
	relabel(m, 2, none, all, 0);
	relabel(m, 0, (int[3]){52, 6, 24}, (int[3]){92, 42, 26}, 2);
}

static bool has_finding(const json_t *label, const char *code, json_int_t partner)
{
	size_t i;
	json_t *finding;
	json_array_foreach (json_object_get(label, "findings"), i, finding)
		if (strcmp(json_string_value(json_object_get(finding, "code")), code) == 0 &&
			json_integer_value(json_object_get(finding, "partner")) == partner)
			return true;
	return false;
}

static const json_t *label_of(const answer *a, int number)
{
	size_t i;
	json_t *label;
	json_array_foreach (at(a, "labels"), i, label)
		if (json_integer_value(json_object_get(label, "label")) == number)
			return label;
	fail_msg("there is no label %d", number);
	return NULL;
}

#define NAMES "label.1.name=femur_left&label.2.name=talus_left&label.3.name=hamate_left"

static void each_planted_error_is_found(void **state)
{
	api_fixture *f = *state;
	enroll_library(f->api);
	static const struct {
		void (*plant)(map *m);
		const char *names;
		int label;
		const char *code; /* NULL: nothing is found */
		int partner;
	} cases[] = {
		{leave_as_it_is, NAMES, 1, NULL, 0},
		{leave_as_it_is, NAMES, 2, NULL, 0},
		{leave_as_it_is, NAMES, 3, NULL, 0},
		{leave_as_it_is, "name=", 1, NULL, 0},
		{leave_as_it_is, "label.1.name=Left-Femur-bone", 1, NULL, 0},
		{leave_as_it_is, "label.1.name=femur_right", 1, "swapped_side", 0},
		{leave_as_it_is, "label.1.name=hamate_left", 1, "wrong_class", 0},
		{leave_as_it_is, "label.1.name=hamate_left&label.3.name=femur_left", 1, "swapped_labels", 3},
		{leave_as_it_is, "label.1.name=hamate_left&label.3.name=femur_left", 3, "swapped_labels", 1},
		{leave_as_it_is, "label.2.name=unicorn_left", 2, "unknown_class", 0},
		{mirror_talus, NAMES, 2, "swapped_side", 0},
		{mirror_talus, NAMES, 1, NULL, 0},
		{enlarge_hamate, NAMES, 3, "implausible_volume", 0},
		{move_talus_to_the_border, NAMES, 2, "touches_border", 0},
		{merge_talus_into_hamate, "label.1.name=femur_left&label.3.name=hamate_left", 3, "merged", 0},
		{cut_femur_in_two, NAMES, 1, "fragmented", 0},
		{carve_talus, NAMES, 2, "holes", 0},
		{leave_little_of_talus, NAMES, 2, "few_voxels", 0},
		{replace_talus, "label.2.class=talus", 2, "unrecognized", 0},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		map m = map_new();
		cases[i].plant(&m);
		answer a = post_volume(f->api, &m.file, "/check?%s",
			strcmp(cases[i].names, "name=") == 0 ? "mode=exact" : cases[i].names);
		assert_status(&a, 200);
		const json_t *label = label_of(&a, cases[i].label);
		const json_t *findings = json_object_get(label, "findings");
		bool good = cases[i].code ? has_finding(label, cases[i].code, cases[i].partner)
					  : json_array_size(findings) == 0;
		if (!good)
			fail_msg("case %zu, %s: %s", i, cases[i].code ? cases[i].code : "nothing", a.body);
		answer_free(&a);
		volume_free(&m.file);
	}
	assert_int_equal(eskel_api_shape_count(f->api), 6 * LABELS);
}

static void findings_are_counted_by_severity(void **state)
{
	api_fixture *f = *state;
	enroll_library(f->api);
	map m = map_new();
	answer a = post_volume(f->api, &m.file, "/check?label.1.name=femur_right&label.2.name=unicorn");
	assert_status(&a, 200);
	assert_int_equal(number_at(&a, "findings.error"), 1);
	assert_true(number_at(&a, "findings.note") >= 1);
	assert_true(json_is_array(at(&a, "warnings")));
	answer_free(&a);
	volume_free(&m.file);
}

static void an_empty_library_recognizes_nothing(void **state)
{
	api_fixture *f = *state;
	map m = map_new();
	answer a = post_volume(f->api, &m.file, "/check?%s", NAMES);
	assert_status(&a, 200);
	for (int label = 1; label <= LABELS; label++) {
		assert_true(has_finding(label_of(&a, label), "unrecognized", 0));
		assert_true(has_finding(label_of(&a, label), "unknown_class", 0));
		assert_true(json_is_null(json_object_get(label_of(&a, label), "distance_z")));
	}
	answer_free(&a);
	volume_free(&m.file);
}

static void a_filter_chooses_what_a_map_is_held_against(void **state)
{
	api_fixture *f = *state;
	enroll_library(f->api);
	map m = map_new();
	answer a = post_volume(f->api, &m.file, "/check?class=femur&%s", NAMES);
	assert_status(&a, 200);
	assert_false(has_finding(label_of(&a, 1), "unknown_class", 0));
	assert_true(has_finding(label_of(&a, 2), "unknown_class", 0));
	answer nobody = post_volume(f->api, &m.file, "/check?subject=nobody&%s", NAMES);
	assert_status(&nobody, 200);
	assert_true(has_finding(label_of(&nobody, 1), "unknown_class", 0));
	answer_free(&a);
	answer_free(&nobody);
	volume_free(&m.file);
}

/* ---- feet */

/* "&label.1.name=calcaneus_L&..." from a table of label,name,..., two of its names exchanged (0, 0: none). */
static char *names_of(const char *path, int a, int b)
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
		end += sprintf(end, "&label.%d.name=%s", label == a ? b : label == b ? a : label, name);
	}
	free(table);
	return query;
}

static answer check_feet(eskel_api *api, const volume_file *feet, int a, int b)
{
	char *names = names_of(MAPS "VHF_feet_labels.csv", a, b);
	answer made = post_volume(api, feet, "/check?mode=exact%s", names);
	assert_status(&made, 200);
	free(names);
	return made;
}

/* A woman's feet beside a man's: nothing is found that is not there, and names of bones that are unlike are found
 * exchanged, whichever they are. The rest of the pairs, and errors in the voxels, are tried in tests/cli/test_check.py. */
static void the_feet_of_one_are_checked_by_those_of_another(void **state)
{
	api_fixture *f = *state;
	if (access(MAPS "VHF_feet.nii.gz", R_OK) != 0) {
		print_message("skipped: there is no " MAPS "\n");
		skip();
	}
	volume_file hers, his;
	hers.bytes = file_read(MAPS "VHF_feet.nii.gz", &hers.size);
	his.bytes = file_read(MAPS "VHM_feet.nii.gz", &his.size);
	char *his_names = names_of(MAPS "VHM_feet_labels.csv", 0, 0);
	answer enrolled = post_volume(f->api, &his, "/shapes?subject=VHM%s", his_names);
	assert_status(&enrolled, 201);
	answer clean = check_feet(f->api, &hers, 0, 0);
	assert_int_equal(number_at(&clean, "findings.error"), 0);
	assert_int_equal(number_at(&clean, "findings.warning"), 0);
	static const int pairs[][2] = {{1, 2}, {1, 13}, {2, 14}, {13, 14}, {3, 9}, {11, 12}, {4, 10}};
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		answer a = check_feet(f->api, &hers, pairs[i][0], pairs[i][1]);
		for (int side = 0; side < 2; side++)
			if (!has_finding(label_of(&a, pairs[i][side]), "swapped_labels", pairs[i][1 - side]))
				fail_msg("labels %d and %d: %s", pairs[i][0], pairs[i][1], a.body);
		assert_int_equal(number_at(&a, "findings.error"), 2);
		answer_free(&a);
	}
	answer_free(&clean);
	answer_free(&enrolled);
	free(his_names);
	volume_free(&hers);
	volume_free(&his);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(each_planted_error_is_found),
		api_test(findings_are_counted_by_severity),
		api_test(an_empty_library_recognizes_nothing),
		api_test(a_filter_chooses_what_a_map_is_held_against),
		api_test(the_feet_of_one_are_checked_by_those_of_another),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
