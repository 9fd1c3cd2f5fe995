#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "daemon/target.h"

#include <string.h>

static void a_target_is_split_and_decoded(void **state)
{
	(void)state;
	esk_target target;
	assert_null(esk_target_parse("/sh%61pes?label=1&name=left+tal%75s&flag&&empty=&a=b=c&caf%C3%A9=%26", &target));
	assert_string_equal(target.path, "/shapes");
	static const char *const expected[][2] = {{"label", "1"}, {"name", "left talus"}, {"flag", ""}, {"empty", ""},
		{"a", "b=c"}, {"caf\xc3\xa9", "&"}};
	assert_int_equal(target.query_count, sizeof expected / sizeof *expected);
	for (size_t i = 0; i < target.query_count; i++) {
		assert_string_equal(target.query[i].name, expected[i][0]);
		assert_string_equal(target.query[i].value, expected[i][1]);
	}
	esk_target_clear(&target);
}

static void a_plus_in_the_path_stays_a_plus(void **state)
{
	(void)state;
	esk_target target;
	assert_null(esk_target_parse("/a+b", &target));
	assert_string_equal(target.path, "/a+b");
	assert_int_equal(target.query_count, 0);
	esk_target_clear(&target);
}

static void hostile_targets_are_refused(void **state)
{
	(void)state;
	static const char *const targets[] = {"", "*", "http://localhost/", "//%", "/%0", "/%zz", "/a%00b", "/a%0ab",
		"/a%7f", "/a b", "/a\tb", "/a\x01", "/?a=%00", "/?%1f=b", "/?a=%", "/%ff", "/%c0%af", "/%ed%a0%80",
		"/%f4%90%80%80", "/%e2%82", "/\xff"};
	for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
		esk_target target = {.path = "untouched"};
		const char *wrong = esk_target_parse(targets[i], &target);
		if (!wrong)
			print_error("\"%s\" was accepted as \"%s\"\n", targets[i], target.path);
		assert_non_null(wrong);
		assert_string_equal(target.path, "untouched");
	}
}

static void utf8_at_the_edges_of_its_ranges_is_accepted(void **state)
{
	(void)state;
	static const char *const targets[] = {
		"/%c2%80", "/%df%bf", "/%e0%a0%80", "/%ed%9f%bf", "/%ee%80%80", "/%f0%90%80%80", "/%f4%8f%bf%bf"};
	for (size_t i = 0; i < sizeof targets / sizeof *targets; i++) {
		esk_target target;
		assert_null(esk_target_parse(targets[i], &target));
		esk_target_clear(&target);
	}
}

static void too_many_query_fields_are_refused(void **state)
{
	(void)state;
	char text[2 * ESK_MOST_QUERY + 8] = "/?";
	esk_target target;
	for (size_t i = 0; i < ESK_MOST_QUERY; i++)
		strcat(text, i ? "&a" : "a");
	assert_null(esk_target_parse(text, &target));
	assert_int_equal(target.query_count, ESK_MOST_QUERY);
	esk_target_clear(&target);
	strcat(text, "&a");
	assert_non_null(esk_target_parse(text, &target));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_target_is_split_and_decoded),
		cmocka_unit_test(a_plus_in_the_path_stays_a_plus),
		cmocka_unit_test(hostile_targets_are_refused),
		cmocka_unit_test(utf8_at_the_edges_of_its_ranges_is_accepted),
		cmocka_unit_test(too_many_query_fields_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
