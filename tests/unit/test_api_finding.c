#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "class_statistics.h"
#include "finding.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const eskel_side L = ESKEL_SIDE_LEFT, R = ESKEL_SIDE_RIGHT, UNKNOWN = ESKEL_SIDE_UNKNOWN;

/* One of a class with five in the library, of its volume, nothing wrong. */
static esk_checked_label good(int32_t label, const char *class, eskel_side side)
{
	return (esk_checked_label){
		.label = label,
		.said_class = class,
		.said_side = side,
		.class_is_known = true,
		.said_distance = 0.2,
		.z = 0.3,
		.told_class = class,
		.told_side = side,
		.side_in_class = side,
		.side_in_class_score = 0.99,
		.class_score = 0.97,
		.side_score = 0.99,
		.told_distance = 0.2,
		.volume_count = 5,
		.volume_mean = log(30000),
		.volume_deviation = 0.1,
		.voxels = 30000,
		.volume = 30000,
		.component_count = 1,
		.largest = 30000,
	};
}

/* The shape says something else than the label. */
static esk_checked_label told(esk_checked_label label, const char *class, eskel_side side)
{
	label.told_class = class;
	label.told_side = label.side_in_class = side;
	if (strcmp(label.said_class, class) != 0)
		label.said_distance = 0.8;
	return label;
}

/* "code severity partner; ..." of one of the labels. */
static const char *found(const esk_checked_label *labels, size_t count, size_t index)
{
	static esk_findings findings[8];
	static char text[600];
	size_t used = 0;
	esk_findings_of_map(labels, count, findings);
	text[0] = 0;
	for (size_t i = 0; i < findings[index].count; i++) {
		const esk_finding *finding = &findings[index].items[i];
		assert_true(finding->text[0]);
		used += (size_t)snprintf(text + used, sizeof text - used, "%s%s %s", used ? "; " : "",
			esk_finding_name(finding->code), esk_severity_name(finding->severity));
		if (finding->partner)
			used += (size_t)snprintf(text + used, sizeof text - used, " %d", (int)finding->partner);
	}
	return text;
}

static const char *found_alone(esk_checked_label label)
{
	return found(&label, 1, 0);
}

static void nothing_is_found_where_nothing_is_wrong(void **state)
{
	(void)state;
	assert_string_equal(found_alone(good(1, "talus", L)), "");
	assert_string_equal(found_alone(told(good(1, "talus", L), "talus", UNKNOWN)), "");
	assert_string_equal(found_alone(told(good(1, "hamate_bone", L), "hamate", L)), "");
	esk_checked_label unnamed = good(1, "talus", L);
	unnamed.said_class = NULL;
	unnamed.class_is_known = false;
	unnamed.said_side = UNKNOWN;
	unnamed.volume_count = 0;
	assert_string_equal(found_alone(unnamed), "");
}

static void a_contradicted_name_is_as_severe_as_its_score_is_high(void **state)
{
	(void)state;
	esk_checked_label class = told(good(1, "talus", L), "cuboid", L), side = told(good(1, "talus", L), "talus", R);
	assert_string_equal(found_alone(class), "wrong_class error");
	assert_string_equal(found_alone(side), "swapped_side error");
	class.border = side.border = 2;
	assert_string_equal(found_alone(class), "wrong_class warning; touches_border warning");
	assert_string_equal(found_alone(side), "swapped_side warning; touches_border warning");
	class.border = side.border = 0;
	class.class_score = 0.85;
	side.side_in_class_score = 0.92;
	assert_string_equal(found_alone(class), "wrong_class warning");
	assert_string_equal(found_alone(side), "swapped_side warning");
	class.class_score = 0.7;
	side.side_in_class_score = 0.85;
	assert_string_equal(found_alone(class), "");
	assert_string_equal(found_alone(side), "");
	class = told(good(1, "metatarsal2", L), "metatarsal3", L);
	class.said_distance = 1.1 * class.told_distance;
	assert_string_equal(found_alone(class), "");
	class.side_in_class = R; /* a metatarsal 2 by its name, and then a right one */
	assert_string_equal(found_alone(class), "swapped_side error");
}

static void labels_of_exchanged_sides_are_partners(void **state)
{
	(void)state;
	const esk_checked_label sides[] = {good(4, "talus", L), told(good(7, "tibia", L), "tibia", R),
		told(good(9, "tibia", R), "tibia", L), good(12, "talus", R)};
	assert_string_equal(found(sides, 4, 0), "");
	assert_string_equal(found(sides, 4, 1), "swapped_labels error 9");
	assert_string_equal(found(sides, 4, 2), "swapped_labels error 7");
	/* where a side cannot be told, two of one class are not exchanged */
	const esk_checked_label undecided[] = {
		told(good(1, "patella", L), "patella", UNKNOWN), told(good(2, "patella", R), "patella", L)};
	assert_string_equal(found(undecided, 2, 0), "");
	assert_string_equal(found(undecided, 2, 1), "swapped_side error");
}

/* Row i: the distances of shape i from the classes a, b and c, which labels 1, 2 and 3 say. */
static void assert_partners(const double distances[3][3], const int32_t partners[3])
{
	static const char *const classes[] = {"a", "b", "c"};
	esk_checked_label labels[3];
	static esk_findings findings[3];
	for (size_t i = 0; i < 3; i++) {
		labels[i] = good((int32_t)i + 1, classes[i], L);
		labels[i].class_number = i;
		labels[i].class_distances = distances[i];
		labels[i].z = 9; /* is not held against an exchanged label */
	}
	esk_findings_of_map(labels, 3, findings);
	for (size_t i = 0; i < 3; i++) {
		assert_int_equal(findings[i].count, 1);
		assert_int_equal(findings[i].items[0].partner, partners[i]);
		assert_int_equal(
			findings[i].items[0].code, partners[i] ? ESK_FINDING_SWAPPED_LABELS : ESK_FINDING_UNRECOGNIZED);
	}
}

static void labels_that_are_nearer_to_each_others_class_are_partners(void **state)
{
	(void)state;
	assert_partners((const double[3][3]){{.2, .6, .5}, {.7, .2, .9}, {.6, .6, .2}}, (const int32_t[3]){0, 0, 0});
	assert_partners((const double[3][3]){{.6, .2, .5}, {.2, .7, .9}, {.6, .6, .2}}, (const int32_t[3]){2, 1, 0});
	/* one that is sure is enough */
	assert_partners((const double[3][3]){{.6, .2, .5}, {.5, .5, .9}, {.6, .6, .2}}, (const int32_t[3]){2, 1, 0});
	/* a gain of ln 1.4 = 0.34 is not */
	assert_partners((const double[3][3]){{.28, .2, .5}, {.5, .5, .9}, {.6, .6, .2}}, (const int32_t[3]){0, 0, 0});
	/* three in a circle: two of them gain most */
	assert_partners((const double[3][3]){{.6, .2, .6}, {.6, .6, .2}, {.2, .5, .6}}, (const int32_t[3]){0, 3, 2});
	/* copies */
	assert_partners((const double[3][3]){{.6, 0, .5}, {0, .7, .9}, {.6, .6, 0}}, (const int32_t[3]){2, 1, 0});
	assert_partners((const double[3][3]){{0, .6, .5}, {.7, 0, .9}, {.6, .6, 0}}, (const int32_t[3]){0, 0, 0});
	assert_partners((const double[3][3]){{NAN, .6, .5}, {.7, NAN, .9}, {.6, .6, NAN}}, (const int32_t[3]){0, 0, 0});
	assert_partners((const double[3][3]){{.2, NAN, .5}, {NAN, .2, .9}, {.6, .6, .2}}, (const int32_t[3]){0, 0, 0});
}

static void a_name_that_the_library_has_not_is_noted(void **state)
{
	(void)state;
	esk_checked_label label = told(good(1, "unicorn", L), "talus", L);
	label.class_is_known = false;
	label.volume_count = 0;
	label.said_distance = NAN;
	assert_string_equal(found_alone(label), "wrong_class warning; unknown_class note");
	label.z = 2; /* no talus either */
	assert_string_equal(found_alone(label), "unknown_class note");
	label.z = 5;
	assert_string_equal(found_alone(label), "unknown_class note");
	label.told_class = NULL;
	label.z = NAN;
	assert_string_equal(found_alone(label), "unrecognized warning; unknown_class note");
}

static void a_shape_far_from_its_class_is_unrecognized(void **state)
{
	(void)state;
	esk_checked_label label = good(1, "talus", L);
	label.z = 2.9;
	assert_string_equal(found_alone(label), "");
	label.z = 3.1;
	assert_string_equal(found_alone(label), "unrecognized warning");
	label.z = NAN;
	assert_string_equal(found_alone(label), "");
}

static void volumes_are_held_against_their_class(void **state)
{
	(void)state;
	esk_checked_label label = good(1, "talus", L);
	label.volume = 30000 * exp(0.7);
	assert_string_equal(found_alone(label), "");
	label.volume = 30000 * exp(-0.8); /* more than 3 x 0.25 */
	assert_string_equal(found_alone(label), "implausible_volume warning");
	label.volume_deviation = 0.5;
	assert_string_equal(found_alone(label), "");
	/* of two, 20000 and 45000 mm^3, the nearest counts */
	label.volume_count = 2;
	label.volume_deviation = 0.5 * log(45000. / 20000);
	label.volume = 20000 / 2.4;
	assert_string_equal(found_alone(label), "");
	label.volume = 20000 / 2.6;
	assert_string_equal(found_alone(label), "implausible_volume warning");
	label.volume = 45000 * 2.4;
	assert_string_equal(found_alone(label), "");
	label.volume = 45000 * 2.6;
	assert_string_equal(found_alone(label), "implausible_volume warning");
	label.volume_count = 0;
	assert_string_equal(found_alone(label), "");
}

static void pieces_are_merged_when_they_are_too_large_together(void **state)
{
	(void)state;
	esk_checked_label label = good(1, "talus", L);
	label.component_count = 2;
	label.largest = 18000;
	label.second = 12000;
	assert_string_equal(found_alone(label), "fragmented warning");
	label.volume = 30000 * 1.5;
	assert_string_equal(found_alone(label), "merged warning");
	/* unless all of the map is as large */
	esk_checked_label map[] = {label, good(2, "cuboid", L), good(3, "tibia", L)};
	assert_string_equal(found(map, 3, 0), "merged warning");
	map[1].volume = map[2].volume = label.volume;
	assert_string_equal(found(map, 3, 0), "fragmented warning");
	/* in one piece, and of another shape */
	label = good(1, "talus", L);
	label.volume = 30000 * 1.5;
	assert_string_equal(found_alone(label), "");
	label.z = 2.5;
	assert_string_equal(found_alone(label), "merged warning");
	label = good(1, "talus", L);
	label.component_count = 9;
	label.largest = 29950;
	label.second = 30;
	assert_string_equal(found_alone(label), "fragmented note");
}

static void the_grid_is_looked_at(void **state)
{
	(void)state;
	esk_checked_label label = good(1, "talus", L);
	label.border = 1u << 5 | 1;
	assert_string_equal(found_alone(label), "touches_border warning");
	label = good(1, "talus", L);
	label.cavity_count = 2;
	label.cavity_voxels = 299;
	assert_string_equal(found_alone(label), "holes note");
	label.cavity_voxels = 300;
	assert_string_equal(found_alone(label), "holes warning");
	label = good(1, "talus", L);
	label.voxels = label.largest = 999;
	assert_string_equal(found_alone(label), "few_voxels note");
	label.voxels = label.largest = 99;
	assert_string_equal(found_alone(label), "few_voxels warning");
}

static void a_sentence_has_room_for_the_longest_names(void **state)
{
	(void)state;
	char long_class[201], other[201];
	memset(long_class, 'x', 200);
	memset(other, 'y', 200);
	long_class[200] = other[200] = 0;
	static esk_findings findings[1];
	const esk_checked_label label = told(good(1, long_class, L), other, R);
	esk_findings_of_map(&label, 1, findings);
	assert_non_null(strstr(findings[0].items[0].text, "of the class said at 0.800"));
}

/* Beside mean and deviation by their definitions. */
static void a_spread_has_the_mean_and_the_deviation(void **state)
{
	(void)state;
	const double numbers[] = {1, 4, 2.5, -3, 8, 8, 0.25};
	esk_spread spread = {0};
	double mean = 0, squares = 0;
	for (size_t i = 0; i < 7; i++) {
		esk_spread_add(&spread, numbers[i]);
		mean += numbers[i] / 7;
	}
	for (size_t i = 0; i < 7; i++)
		squares += (numbers[i] - mean) * (numbers[i] - mean);
	assert_int_equal(spread.count, 7);
	assert_true(fabs(spread.mean - mean) < 1e-12);
	assert_true(fabs(esk_spread_deviation(&spread) - sqrt(squares / 7)) < 1e-12);
	assert_true(isnan(esk_spread_deviation(&(esk_spread){0})));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_is_found_where_nothing_is_wrong),
		cmocka_unit_test(a_contradicted_name_is_as_severe_as_its_score_is_high),
		cmocka_unit_test(labels_of_exchanged_sides_are_partners),
		cmocka_unit_test(labels_that_are_nearer_to_each_others_class_are_partners),
		cmocka_unit_test(a_name_that_the_library_has_not_is_noted),
		cmocka_unit_test(a_shape_far_from_its_class_is_unrecognized),
		cmocka_unit_test(volumes_are_held_against_their_class),
		cmocka_unit_test(pieces_are_merged_when_they_are_too_large_together),
		cmocka_unit_test(the_grid_is_looked_at),
		cmocka_unit_test(a_sentence_has_room_for_the_longest_names),
		cmocka_unit_test(a_spread_has_the_mean_and_the_deviation),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
