#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "daemon/log.h"

#include <string.h>

static const char *text(esk_log_line *line)
{
	line->text[line->size] = '\0';
	return strstr(line->text, "event=");
}

static void values_are_quoted_where_they_need_it(void **state)
{
	(void)state;
	esk_log_line line;
	esk_log_begin(&line, "request");
	esk_log_text(&line, "route", "/shapes/{id}");
	esk_log_text(&line, "a", "two words");
	esk_log_text(&line, "b", "say \"hi\" \\");
	esk_log_text(&line, "c", "x=y");
	esk_log_text(&line, "none", NULL);
	esk_log_text(&line, "empty", "");
	esk_log_number(&line, "n", 7);
	assert_string_equal(text(&line),
		"event=request route=/shapes/{id} a=\"two words\" b=\"say \\\"hi\\\" \\\\\" c=\"x=y\" n=7");
}

static void no_value_can_forge_a_line(void **state)
{
	(void)state;
	esk_log_line line;
	esk_log_begin(&line, "e");
	esk_log_text(&line, "v", "a\nevent=forged\r\x1b[31m\x7f");
	assert_string_equal(text(&line), "event=e v=\"a\\x0aevent=forged\\x0d\\x1b[31m\\x7f\"");
}

static void a_long_value_is_cut(void **state)
{
	(void)state;
	esk_log_line line;
	char value[5000];
	memset(value, '\n', sizeof value - 1);
	value[sizeof value - 1] = '\0';
	esk_log_begin(&line, "e");
	esk_log_text(&line, "v", value);
	assert_int_equal(line.size, sizeof line.text - 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(values_are_quoted_where_they_need_it),
		cmocka_unit_test(no_value_can_forge_a_line),
		cmocka_unit_test(a_long_value_is_cut),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
