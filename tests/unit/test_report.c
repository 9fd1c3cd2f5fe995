#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel_report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static eskel_report *report_of(eskel_report_kind kind)
{
	eskel_report *report = NULL;
	assert_int_equal(eskel_report_new(kind, &report), ESKEL_OK);
	return report;
}

static void add(eskel_report *report, const char *source, const char *json)
{
	assert_int_equal(eskel_report_add(report, source, json, strlen(json)), ESKEL_OK);
}

static void assert_text(const eskel_report *report, bool colour, const char *expected)
{
	char *text = eskel_report_text(report, colour);
	assert_non_null(text);
	assert_string_equal(text, expected);
	free(text);
}

static const char femur[] =
	"{\"shapes\":[{\"id\":\"0123456789abcdef0123456789abcdef\",\"name\":\"femur_left\",\"class\":\"femur\","
	"\"side\":\"left\",\"subject\":null,\"label\":1,\"voxels\":123456,\"volume_mm3\":98765.43,\"levels\":16,"
	"\"warnings\":[]}],"
	"\"next\":null}";

static void answers_are_rows_under_one_heading(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_SHAPES);
	add(report, "a.nii", femur);
	add(report, "b.nii", "{\"shapes\":[{\"id\":\"ff\",\"label\":7}]}");
	assert_text(report, false,
		"id                                name        class  side  subject  label  voxels  volume mm³  "
		"levels\n"
		"0123456789abcdef0123456789abcdef  femur_left  femur  left  -            1  123456     98765.4      "
		"16\n"
		"ff                                b.nii:7     -      -     -            7       -           -       "
		"-\n");
	eskel_report_free(report);
}

static void a_report_without_answers_is_empty(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_SHAPES);
	assert_text(report, true, "");
	eskel_report_free(report);
}

static void an_answer_of_another_kind_is_refused(void **state)
{
	(void)state;
	const char *const wrong[] = {"", "[]", "{}", "null", "{\"shapes\":3}", "{\"results\":[]}", "<html>"};
	eskel_report *report = report_of(ESKEL_REPORT_SHAPES);
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		if (eskel_report_add(report, "x", wrong[i], strlen(wrong[i])) != ESKEL_MALFORMED)
			fail_msg("taken: %s", wrong[i]);
	assert_text(report, false, "");
	eskel_report_free(report);
}

static void control_characters_cannot_reach_the_terminal(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_SHAPES);
	add(report, "a\033[2Jb",
		"{\"shapes\":[{\"id\":\"\\u001b]0;x\\u0007\",\"name\":\"\\u009b31m\\n\"},{\"id\":\"i\"}]}");
	char *text = eskel_report_text(report, false);
	for (const char *c = text; *c; c++)
		assert_true((unsigned char)*c >= 0x20 || *c == '\n');
	assert_null(strstr(text, "\xc2\x9b"));
	assert_non_null(strstr(text, "?]0;x?"));
	assert_non_null(strstr(text, "?31m?"));
	assert_non_null(strstr(text, "a?[2Jb"));
	free(text);
	eskel_report_free(report);
}

static void a_warning_stands_once_below_the_table(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_SHAPES);
	add(report, "a.nii",
		"{\"shapes\":[{\"id\":\"1\",\"name\":\"talus\",\"warnings\":[{\"text\":\"mm is assumed\"},"
		"{\"text\":\"only 3 voxels\"}]},{\"id\":\"2\",\"warnings\":[{\"text\":\"mm is assumed\"}]}]}");
	char *text = eskel_report_text(report, false);
	assert_non_null(strstr(text, "\n\nwarning: 2 shapes: mm is assumed\nwarning: talus: only 3 voxels\n"));
	free(text);
	eskel_report_free(report);
}

static void the_cursor_of_a_longer_list_is_told(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_SHAPES);
	add(report, "", "{\"shapes\":[{\"id\":\"1\"}],\"next\":\"abc\"}");
	char *text = eskel_report_text(report, false);
	assert_non_null(strstr(text, "\nmore follow: add --cursor abc\n"));
	free(text);
	eskel_report_free(report);
}

static void one_shape_is_shown_member_by_member(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_SHAPE);
	add(report, "",
		"{\"id\":\"12\",\"name\":null,\"centre_mm\":[1.5,-2.0,3.25],\"attributes\":{\"scanner\":\"CT\"},"
		"\"warnings\":[]}");
	assert_text(report, false,
		"member      value\n"
		"id          12\n"
		"name        -\n"
		"centre_mm   [1.5,-2.0,3.25]\n"
		"attributes  {\"scanner\":\"CT\"}\n");
	eskel_report_free(report);
}

#define NEIGHBOUR \
	"{\"id\":\"77\",\"name\":\"femur_right\",\"class\":\"femur\",\"side\":\"right\",\"subject\":\"VHM\"," \
	"\"differences\":[{\"class\":1,\"remarkable\":true,\"text\":\"class 1: 12 % longer\"}," \
	"{\"class\":0,\"text\":null}],\"summary\":{\"text\":\"5 % larger; class 1 stands out\"}," \
	"\"isomorphism\":{\"depth\":4},\"superposition\":{\"mirrored\":true,\"rms_mm\":1.26}," \
	"\"distance\":0.12345,\"chirality\":{\"verdict\":\"mirrored\",\"score\":-0.456}}"

static const char wrong_label[] =
	"{\"results\":[{\"query\":{\"name\":\"femur_left\",\"label\":1},\"search\":{\"mode\":\"exact\","
	"\"proven\":true,\"library\":78,\"milliseconds\":1.25},\"neighbours\":[" NEIGHBOUR "],"
	"\"verdict\":{\"class\":\"femur\",\"class_score\":0.9712,\"nearest_class\":\"femur\",\"side\":\"right\","
	"\"side_score\":0.9999,\"agrees\":false}}]}";

static const char too_far[] = "{\"results\":[{\"query\":{\"name\":null,\"label\":3},\"neighbours\":[" NEIGHBOUR "],"
			      "\"verdict\":{\"class\":null,\"class_score\":0.6,\"nearest_class\":\"femur\","
			      "\"side\":null,\"side_score\":null,\"agrees\":null}}]}";

static void a_recognition_says_class_side_and_whether_the_label_agrees(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_RECOGNITION);
	add(report, "a.nii", wrong_label);
	add(report, "b.nii",
		"{\"results\":[{\"query\":{\"name\":null,\"label\":2},\"neighbours\":[],\"verdict\":{\"class\":null,"
		"\"nearest_class\":null,\"agrees\":null}}]}");
	add(report, "c.nii", too_far);
	assert_text(report, false,
		"query       class    sure  side   sure  nearest      distance  chirality  agrees   ms\n"
		"femur_left  femur    97 %  right  99 %  femur_right    0.1235  mirrored   no      1.2\n"
		"b.nii:2     -           -  -         -  -                   -  -          -         -\n"
		"c.nii:3     unknown     -  -         -  femur_right    0.1235  mirrored   -         -\n");
	assert_int_equal(eskel_report_unrecognized(report), 1);
	eskel_report_free(report);
}

static void a_single_recognition_lists_its_neighbours_and_explains_itself(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_RECOGNITION);
	add(report, "a.nii", wrong_label);
	char *text = eskel_report_text(report, false);
	assert_non_null(strstr(text, "\n1  femur_right  femur  right  VHM        0.1235  mirrored   -0.46  77\n"));
	assert_non_null(strstr(text, "\nsearched 78 shapes, mode exact: proven, no other shape is nearer\n"));
	assert_non_null(strstr(text,
		"\nbeside femur_right, matched class by class:\n  class 1: 12 % longer (stands out)\n"
		"as a whole: 5 % larger; class 1 stands out\n"
		"the trees agree down to level 4; laid on it mirrored, class centres lie 1.3 mm off (rms)\n"));
	free(text);
	eskel_report_free(report);
}

static void position_distances_have_a_column_and_are_not_called_pruned(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_RECOGNITION);
	add(report, "a.nii",
		"{\"results\":[{\"query\":{\"name\":\"a\"},\"search\":{\"mode\":\"exact\",\"proven\":false,\"library\":"
		"78},\"neighbours\":[{\"id\":\"77\",\"name\":\"b\",\"distance\":0.5,\"position_distance\":0.75}],"
		"\"verdict\":{}}]}");
	char *text = eskel_report_text(report, false);
	assert_non_null(strstr(text, "\n#  name  class  side  subject  position  distance  "));
	assert_non_null(strstr(text, " 0.7500 "));
	assert_non_null(strstr(text, "mode exact: not proven, only the nearest were put in order\n"));
	free(text);
	eskel_report_free(report);
}

static void scaled_distances_have_a_column_and_are_not_called_pruned(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_RECOGNITION);
	add(report, "a.nii",
		"{\"results\":[{\"query\":{\"name\":\"a\"},\"search\":{\"mode\":\"exact\",\"proven\":false,\"library\":"
		"78},"
		"\"neighbours\":[{\"id\":\"77\",\"name\":\"b\",\"distance\":0.5,\"scaled\":0.25}],\"verdict\":{}}]}");
	char *text = eskel_report_text(report, false);
	assert_non_null(strstr(text, "\n#  name  class  side  subject  scaled  distance  "));
	assert_non_null(strstr(text, "\n1  b     -      -     -        0.2500    0.5000  "));
	assert_non_null(strstr(text, "\nsearched 78 shapes, mode exact: not proven, only the nearest were scaled\n"));
	free(text);
	eskel_report_free(report);
}

static void colour_marks_a_label_that_disagrees(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_RECOGNITION);
	add(report, "a.nii", wrong_label);
	char *text = eskel_report_text(report, true);
	assert_non_null(strstr(text, "\033[31mno\033[0m"));
	free(text);
	eskel_report_free(report);
}

static void a_matrix_has_one_numbered_column_a_row(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_DISTANCES);
	add(report, "", "{\"ids\":[\"11\",\"22\"],\"names\":[\"talus\",null],\"distances\":[[0,1.5],[1.5,0]]}");
	assert_text(report, false,
		"#  name       1      2\n"
		"1  talus  0.000  1.500\n"
		"2  22     1.500  0.000\n");
	eskel_report_free(report);
}

static const char evaluation[] =
	"{\"distance\":{\"signature\":\"log\",\"distance\":\"sum\",\"level\":null,\"metric\":\"manhattan\",\"size\":"
	"\"fixed\"},"
	"\"leave_out\":\"subject\",\"shapes\":14,\"classes\":3,\"queries\":12,\"measures\":{\"nearest_neighbour\":0.75,"
	"\"first_tier\":0.5,\"second_tier\":0.625,\"e_measure\":0.25,\"dcg\":0.875},\"precision_recall\":"
	"[{\"recall\":0.5,\"precision\":0.75},{\"recall\":1,\"precision\":0.5}],\"confusion\":["
	"{\"class\":\"cuboid\",\"queries\":4,\"right\":4,\"nearest\":[{\"class\":\"cuboid\",\"queries\":4}]},"
	"{\"class\":\"<b>&\",\"queries\":4,\"right\":3,\"nearest\":[{\"class\":\"<b>&\",\"queries\":3},"
	"{\"class\":\"cuboid\",\"queries\":1}]},"
	"{\"class\":\"talus\",\"queries\":4,\"right\":1,\"nearest\":[{\"class\":\"cuboid\",\"queries\":2},"
	"{\"class\":\"talus\",\"queries\":1},{\"class\":null,\"queries\":1}]}],"
	"\"side\":{\"compared\":10,\"thresholds\":[{\"threshold\":0,\"decided\":10,\"right\":7},"
	"{\"threshold\":0.05,\"decided\":8,\"right\":6}]},"
	"\"pruned\":{\"searches\":14,\"recall\":0.9,\"steps\":[{\"level\":1,\"kept\":10,\"recall\":0.9}]},"
	"\"milliseconds\":{\"exact\":{\"mean\":0.5,\"median\":0.25,\"p95\":0.75},"
	"\"pruned\":{\"mean\":0.125,\"median\":0.1,\"p95\":0.2}}}";

static void an_evaluation_is_a_row_and_its_details(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_EVALUATION);
	add(report, "evaluation", evaluation);
	assert_text(report, false,
		"shapes: 14, classes: 3, queries: 12, left out: subject\n"
		"\n"
		"signature  distance  level  metric     size      NN     FT     ST      E    DCG  decided  right  "
		"recall  "
		"exact ms  pruned ms\n"
		"log        sum           -  manhattan  fixed  0.750  0.500  0.625  0.250  0.875    0.800  0.750   "
		"0.900  "
		"   0.250      0.100\n"
		"\n"
		"classes whose nearest shape is of another\n"
		"class  queries  right  taken for\n"
		"talus        4      1  cuboid 2, -\n"
		"<b>&         4      3  cuboid\n"
		"\n"
		"sides, beside the nearest left or right shape of the class\n"
		"|score| from  decided  share  right  share\n"
		"        0.00       10  1.000      7  0.700\n"
		"        0.05        8  0.800      6  0.750\n"
		"\n"
		"mode pruned: shapes still in, and how often the true nearest is\n"
		"level  kept  recall\n"
		"    1  10.0   0.900\n"
		"\n"
		"mode    mean ms  median ms  p95 ms\n"
		"exact     0.500      0.250   0.750\n"
		"pruned    0.125      0.100   0.200\n");
	eskel_report_free(report);
}

static void several_evaluations_are_a_row_each(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_EVALUATION);
	add(report, "one", evaluation);
	add(report, "other", "{\"measures\":{\"dcg\":null},\"leave_out\":\"shape\",\"distance\":{\"level\":4}}");
	char *text = eskel_report_text(report, false);
	assert_non_null(strstr(text, "\n-          -             4  -          -          -  "));
	assert_null(strstr(text, "taken for"));
	free(text);
	eskel_report_free(report);
}

static void evaluations_are_csv_in_full(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_EVALUATION);
	char *none = eskel_report_csv(report);
	assert_string_equal(none, "");
	add(report, "evaluation", evaluation);
	char *text = eskel_report_csv(report);
	assert_string_equal(text,
		"signature,distance,level,metric,size,leave_out,shapes,classes,queries,nearest_neighbour,first_tier,"
		"second_tier,e_measure,dcg,sides_compared,sides_decided,sides_right,pruned_recall,exact_mean_ms,"
		"exact_median_ms,exact_p95_ms,pruned_mean_ms,pruned_median_ms,pruned_p95_ms\r\n"
		"log,sum,,manhattan,fixed,subject,14,3,12,0.750000,0.500000,0.625000,0.250000,0.875000,10,0.800000,"
		"0.750000,0.900000,0.500000,0.250000,0.750000,0.125000,0.100000,0.200000\r\n");
	free(none);
	free(text);
	eskel_report_free(report);
	eskel_report *other = report_of(ESKEL_REPORT_SHAPES);
	assert_null(eskel_report_csv(other));
	assert_null(eskel_report_html(other));
	eskel_report_free(other);
}

static size_t occurrences(const char *text, const char *part)
{
	size_t count = 0;
	for (; (text = strstr(text, part)) != NULL; text += strlen(part))
		count++;
	return count;
}

static void a_page_of_evaluations_stands_alone_and_trusts_no_name(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_EVALUATION);
	add(report, "one", evaluation);
	add(report, "other", "{\"measures\":{\"dcg\":0.9},\"distance\":{\"signature\":\"paper\"}}");
	char *page = eskel_report_html(report);
	assert_non_null(page);
	assert_memory_equal(page, "<!DOCTYPE html>", 15);
	assert_non_null(strstr(page, "the nearest shape of every query is of its class"));
	assert_true(strstr(page, "<td class=\"text\">paper</td>") < strstr(page, "<td class=\"text\">log</td>"));
	free(page);
	eskel_report_free(report);
	report = report_of(ESKEL_REPORT_EVALUATION);
	add(report, "one", evaluation);
	page = eskel_report_html(report);
	assert_null(strstr(page, "<b>"));
	assert_true(occurrences(page, "&lt;b&gt;&amp;") >= 3);
	assert_int_equal(occurrences(page, "<svg "), 4);
	assert_int_equal(occurrences(page, "</svg>"), 4);
	assert_int_equal(occurrences(page, "</title>\n<desc id="), 4);
	assert_int_equal(occurrences(page, "://"), occurrences(page, "xmlns=\"http://www.w3.org/2000/svg\""));
	assert_null(strstr(page, "<script"));
	free(page);
	eskel_report_free(report);
}

static void a_skeleton_shows_its_levels_and_its_deepest_classes(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_SKELETON);
	add(report, "rod.nii:1",
		"{\"levels\":[{\"level\":1,\"intraclass_ratio\":1,\"split_class\":null,\"split_ratio\":0,"
		"\"degenerate\":false},"
		"{\"level\":2,\"intraclass_ratio\":0.25,\"split_class\":0,\"split_ratio\":0.25,\"degenerate\":true}],"
		"\"nodes\":[{\"level\":1,\"class\":0},{\"level\":2,\"class\":0,\"parent\":0,\"voxels\":8,\"centre_mm\":"
		"[-2,0,0],"
		"\"eigenvalues_mm2\":[4,1,0.25],\"rho_mm\":2},{\"level\":2,\"class\":1,\"parent\":0,\"voxels\":7,"
		"\"centre_mm\":[2,0,0],\"eigenvalues_mm2\":[4,1,0.25],\"rho_mm\":2}]}");
	assert_text(report, false,
		"rod.nii:1\n"
		"level  intraclass ratio  split class  split ratio  degenerate\n"
		"    1            1.0000            -       0.0000  no\n"
		"    2            0.2500            0       0.2500  yes\n"
		"\n"
		"the classes of level 2\n"
		"class  voxels  x mm  y mm  z mm  √λ1 mm  √λ2 mm  √λ3 mm  ρ mm\n"
		"    0       8  -2.0   0.0   0.0    2.00    1.00    0.50  2.00\n"
		"    1       7   2.0   0.0   0.0    2.00    1.00    0.50  2.00\n");
	eskel_report_free(report);
}

static void a_problem_is_its_detail_or_its_title(void **state)
{
	(void)state;
	const char detailed[] = "{\"title\":\"Not Found\",\"status\":404,\"detail\":\"there is no shape 12\\n\"}";
	const char titled[] = "{\"title\":\"Not Found\"}";
	char *text = eskel_report_problem(detailed, strlen(detailed));
	assert_string_equal(text, "there is no shape 12?");
	free(text);
	text = eskel_report_problem(titled, strlen(titled));
	assert_string_equal(text, "Not Found");
	free(text);
	assert_null(eskel_report_problem("<html>", 6));
}

static void a_job_is_a_row_in_a_list_and_alone(void **state)
{
	(void)state;
	static const char json[] =
		"{\"id\":\"ab\",\"path\":\"/distances\",\"created\":\"2026-01-31T12:34:56Z\",\"state\":\"failed\","
		"\"progress\":0.25,\"seconds\":1.5,\"size\":0,\"problem\":\"there is no shape\"}";
	static const char row[] =
		"id  path        created               state     done  seconds  bytes  problem\n"
		"ab  /distances  2026-01-31T12:34:56Z  failed  25.0 %      1.5      0  there is no shape\n";
	char list[400];
	snprintf(list, sizeof list, "{\"jobs\":[%s]}", json);
	eskel_report *one = report_of(ESKEL_REPORT_JOB), *all = report_of(ESKEL_REPORT_JOBS);
	add(one, "ab", json);
	add(all, "jobs", list);
	assert_text(one, false, row);
	assert_text(all, false, row);
	eskel_report_free(one);
	eskel_report_free(all);
}

static void how_far_a_job_is_can_be_read(void **state)
{
	(void)state;
	static const char *const others[] = {"", "{}", "[", "{\"state\":7}", "{\"id\":\"a\"}"};
	static const char *const states[] = {"queued", "running", "done", "failed"};
	eskel_report_job job = {.progress = 7};
	for (size_t i = 0; i < 5; i++)
		assert_false(eskel_report_job_read(others[i], strlen(others[i]), &job));
	assert_true(job.progress == 7);
	for (size_t i = 0; i < 4; i++) {
		char json[100];
		snprintf(json, sizeof json, "{\"state\":\"%s\",\"progress\":0.5,\"seconds\":3}", states[i]);
		assert_true(eskel_report_job_read(json, strlen(json), &job));
		assert_true(job.progress == 0.5 && job.seconds == 3);
		assert_int_equal(job.ended, i >= 2);
		assert_int_equal(job.failed, i == 3);
	}
}

static void a_check_is_a_row_a_label_and_a_line_a_finding(void **state)
{
	(void)state;
	eskel_report *report = report_of(ESKEL_REPORT_CHECK);
	add(report, "feet.nii",
		"{\"labels\":[{\"label\":1,\"name\":\"talus_R\",\"class\":\"talus\",\"side\":\"right\",\"distance_z\":"
		"0.77,"
		"\"verdict\":{\"class\":\"talus\",\"class_score\":0.987,\"side\":\"left\",\"side_score\":0.5},"
		"\"findings\":[{\"code\":\"swapped_side\",\"severity\":\"error\",\"text\":\"it is a left one\"},"
		"{\"code\":\"holes\",\"severity\":\"note\",\"text\":\"1 cavity\"}]},"
		"{\"label\":12,\"name\":null,\"class\":null,\"side\":null,\"distance_z\":null,\"verdict\":{\"class\":"
		"\"cuboid\","
		"\"class_score\":1.0,\"side\":null,\"side_score\":null},\"findings\":[]}],"
		"\"findings\":{\"error\":1,\"warning\":0,\"note\":1},"
		"\"warnings\":[{\"code\":\"no_orientation\",\"text\":\"which side is left is not recorded\"}]}");
	assert_text(report, false,
		"label  name         says   side   looks like  sure  side  sure    z  findings\n"
		"    1  talus_R      talus  right  talus       99 %  left  50 %  0.8  swapped_side, (holes)\n"
		"   12  feet.nii:12  -      -      cuboid      99 %  -        -    -  -\n"
		"\nfeet.nii: labels 2, errors 1, warnings 0, notes 1\n"
		"feet.nii: which side is left is not recorded\n"
		"label 1 (talus_R): error swapped_side: it is a left one\n"
		"label 1 (talus_R): note holes: 1 cavity\n");
	assert_int_equal(eskel_report_findings(report), 1);
	char *coloured = eskel_report_text(report, true);
	assert_non_null(strstr(coloured, "\033[31mswapped_side, (holes)\033[0m"));
	free(coloured);
	eskel_report_free(report);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(answers_are_rows_under_one_heading),
		cmocka_unit_test(a_report_without_answers_is_empty),
		cmocka_unit_test(an_answer_of_another_kind_is_refused),
		cmocka_unit_test(control_characters_cannot_reach_the_terminal),
		cmocka_unit_test(a_warning_stands_once_below_the_table),
		cmocka_unit_test(the_cursor_of_a_longer_list_is_told),
		cmocka_unit_test(one_shape_is_shown_member_by_member),
		cmocka_unit_test(a_recognition_says_class_side_and_whether_the_label_agrees),
		cmocka_unit_test(a_check_is_a_row_a_label_and_a_line_a_finding),
		cmocka_unit_test(a_single_recognition_lists_its_neighbours_and_explains_itself),
		cmocka_unit_test(position_distances_have_a_column_and_are_not_called_pruned),
		cmocka_unit_test(scaled_distances_have_a_column_and_are_not_called_pruned),
		cmocka_unit_test(colour_marks_a_label_that_disagrees),
		cmocka_unit_test(a_matrix_has_one_numbered_column_a_row),
		cmocka_unit_test(an_evaluation_is_a_row_and_its_details),
		cmocka_unit_test(several_evaluations_are_a_row_each),
		cmocka_unit_test(evaluations_are_csv_in_full),
		cmocka_unit_test(a_page_of_evaluations_stands_alone_and_trusts_no_name),
		cmocka_unit_test(a_skeleton_shows_its_levels_and_its_deepest_classes),
		cmocka_unit_test(a_job_is_a_row_in_a_list_and_alone),
		cmocka_unit_test(how_far_a_job_is_can_be_read),
		cmocka_unit_test(a_problem_is_its_detail_or_its_title),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
