#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "text.h"
#include "value.h"

#include <stdlib.h>
#include <string.h>

static void only_utf8_without_controls_is_plain(void **state)
{
	(void)state;
	static const char *const plain[] = {"", "femur", "Schädel", "大腿骨", "\xf0\x9f\xa6\xb4", "\xc2\xa0"};
	static const char *const broken[] = {"\n", "a\x7f", "\xc2\x9b", "\x80", "\xc3", "\xc3(", "\xc0\xaf",
		"\xe0\x80\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xf8\x88\x80\x80\x80", "\xff", "\xe2\x82"};
	for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
		if (!esk_text_is_plain(plain[i]))
			fail_msg("plain case %zu refused", i);
	for (size_t i = 0; i < sizeof broken / sizeof *broken; i++)
		if (esk_text_is_plain(broken[i]))
			fail_msg("broken case %zu taken", i);
}

static void cleaning_makes_any_bytes_plain(void **state)
{
	(void)state;
	for (unsigned first = 1; first < 256; first++)
		for (unsigned second = 1; second < 256; second++) {
			char text[] = {(char)first, (char)second, 'x', 0};
			bool was_plain = esk_text_is_plain(text);
			esk_text_clean(text);
			assert_true(esk_text_is_plain(text));
			assert_true(
				!was_plain || ((unsigned char)text[0] == first && (unsigned char)text[1] == second));
		}
}

static void a_string_grows_and_escapes(void **state)
{
	(void)state;
	esk_text text = {0};
	for (int i = 0; i < 1000; i++)
		esk_text_print(&text, "%d,", i);
	assert_int_equal(text.size, strlen(text.bytes));
	assert_int_equal(text.size, 10 * 2 + 90 * 3 + 900 * 4);
	size_t before = text.size;
	esk_text_append_escaped(&text, "a b>;\r\n\"é~");
	assert_string_equal(text.bytes + before, "a%20b%3E%3B%0D%0A%22%C3%A9~");
	assert_false(text.failed);
	free(text.bytes);
}

static void integers_are_digits_in_a_range(void **state)
{
	(void)state;
	static const char *const refused[] = {"", "-", "+1", " 1", "1 ", "1.0", "0x1", "11", "-1", "1e1",
		"99999999999999999999", "100000000000000000000000000000000000000000"};
	esk_problem problem;
	int64_t number = 7;
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		if (esk_value_integer("limit", refused[i], 0, 10, &number, &problem))
			fail_msg("taken: %s", refused[i]);
	assert_int_equal(number, 7);
	assert_string_equal(problem.text,
		"limit is \"100000000000000000000000000000000000000000\", expected a whole number "
		"from 0 to 10");
	assert_true(esk_value_integer("label", "-3", -5, 10, &number, &problem));
	assert_int_equal(number, -3);
	assert_true(esk_value_integer("label", "007", 0, 10, &number, &problem));
	assert_int_equal(number, 7);
}

static void years_are_digits_with_a_fraction(void **state)
{
	(void)state;
	static const char *const refused[] = {
		"", ".", ".5", "5.", "-1", "1e2", "nan", "inf", "150.1", "1,5", "0x10", "1.2.3"};
	esk_problem problem;
	double years = -7;
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
		if (esk_value_years("age", refused[i], &years, &problem))
			fail_msg("taken: %s", refused[i]);
	assert_true(years == -7);
	assert_true(esk_value_years("age", "59", &years, &problem) && years == 59);
	assert_true(esk_value_years("age", "0.25", &years, &problem) && years == 0.25);
	assert_true(esk_value_years("age", "150", &years, &problem) && years == 150);
}

static void an_id_is_32_lower_case_digits(void **state)
{
	(void)state;
	assert_true(esk_value_is_id("0123456789abcdef0123456789abcdef"));
	assert_false(esk_value_is_id("0123456789ABCDEF0123456789abcdef"));
	assert_false(esk_value_is_id("0123456789abcdef0123456789abcde"));
	assert_false(esk_value_is_id("0123456789abcdef0123456789abcdef0"));
	assert_false(esk_value_is_id("0123456789abcdef0123456789abcdeg"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(only_utf8_without_controls_is_plain),
		cmocka_unit_test(cleaning_makes_any_bytes_plain),
		cmocka_unit_test(a_string_grows_and_escapes),
		cmocka_unit_test(integers_are_digits_in_a_range),
		cmocka_unit_test(years_are_digits_with_a_fraction),
		cmocka_unit_test(an_id_is_32_lower_case_digits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
