#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "daemon/options.h"

#include <stdlib.h>
#include <string.h>

/* A NULL-terminated list of words after the program's name. */
static esk_options_result parse(esk_options *options, const char *const *words)
{
	char *argv[16] = {(char *)"eskeld"};
	int argc = 1;
	for (; *words; words++)
		argv[argc++] = (char *)*words;
	return esk_options_parse(argc, argv, options);
}

#define PARSE(options, ...) parse(options, (const char *const[]){__VA_ARGS__, NULL})

static void defaults_are_those_of_the_table(void **state)
{
	(void)state;
	esk_options o;
	assert_int_equal(PARSE(&o, "--database", "f"), ESK_OPTIONS_RUN);
	assert_int_equal(o.command, ESK_SERVE);
	assert_string_equal(o.database, "f");
	assert_string_equal(o.listen, "127.0.0.1:8467");
	assert_int_equal(o.most_body, 1 << 30);
	assert_int_equal(o.host_count, 0);
}

static void values_come_after_a_space_or_an_equals_sign(void **state)
{
	(void)state;
	esk_options o;
	assert_int_equal(PARSE(&o, "--most-body=2M", "--host", "a", "--host=b", "--database=f=g"), ESK_OPTIONS_RUN);
	assert_int_equal(o.most_body, 2 << 20);
	assert_int_equal(o.host_count, 2);
	assert_string_equal(o.hosts[1], "b");
	assert_string_equal(o.database, "f=g");
}

static void commands_take_their_own_options_and_arguments(void **state)
{
	(void)state;
	esk_options o;
	assert_int_equal(PARSE(&o, "token", "add", "scanner", "--role", "write", "--database", "f"), ESK_OPTIONS_RUN);
	assert_int_equal(o.command, ESK_TOKEN_ADD);
	assert_string_equal(o.argument, "scanner");
	assert_string_equal(o.role, "write");
	assert_int_equal(PARSE(&o, "audit", "verify", "--database", "f"), ESK_OPTIONS_RUN);
	assert_int_equal(o.command, ESK_AUDIT_VERIFY);
}

static void wrong_command_lines_are_refused(void **state)
{
	(void)state;
	esk_options o = {.queue = 77};
	assert_int_equal(PARSE(&o, "--listen", "127.0.0.1:0"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database="), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--databas", "f"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database", "f", "g"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database", "f", "--queue", "0"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database", "f", "--queue", "1x"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database", "f", "--queue", "-1"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database", "f", "--queue", "99999999999999999999999"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database", "f", "--most-body", "99999999999999G"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "--database", "f", "--tls-key", "k"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "token", "--database", "f"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "token", "add", "--database", "f"), ESK_OPTIONS_WRONG);
	assert_int_equal(PARSE(&o, "token", "list", "--database", "f", "--queue", "5"), ESK_OPTIONS_WRONG);
	assert_int_equal(o.queue, 77);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(defaults_are_those_of_the_table),
		cmocka_unit_test(values_come_after_a_space_or_an_equals_sign),
		cmocka_unit_test(commands_take_their_own_options_and_arguments),
		cmocka_unit_test(wrong_command_lines_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
