#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "byte_range.h"

#include <stdio.h>

static void ranges_are_read_as_the_rfc_has_them(void **state)
{
	(void)state;
	static const struct {
		const char *header;
		uint64_t total, first, size; /* size 0: cannot be satisfied */
		bool partial;
	} cases[] = {
		{NULL, 100, 0, 100, false},
		{"bytes=0-0", 100, 0, 1, true},
		{"bytes=10-19", 100, 10, 10, true},
		{"bytes=10-", 100, 10, 90, true},
		{"bytes=99-99", 100, 99, 1, true},
		{"bytes=0-99", 100, 0, 100, true},
		{"bytes=50-1000", 100, 50, 50, true},
		{"bytes=-1", 100, 99, 1, true},
		{"bytes=-100", 100, 0, 100, true},
		{"bytes=-1000", 100, 0, 100, true},
		{"bytes=100-", 100, 0, 0, false},
		{"bytes=100-200", 100, 0, 0, false},
		{"bytes=-0", 100, 0, 0, false},
		{"bytes=0-", 0, 0, 0, false},
		{"bytes=-5", 0, 0, 0, false},
		/* the whole, for these ask for nothing that is understood */
		{"", 100, 0, 100, false},
		{"bytes=", 100, 0, 100, false},
		{"bytes=-", 100, 0, 100, false},
		{"bytes=20-10", 100, 0, 100, false},
		{"bytes=1-2,5-6", 100, 0, 100, false},
		{"bytes=a-b", 100, 0, 100, false},
		{"bytes= 1-2", 100, 0, 100, false},
		{"bytes=1-2 ", 100, 0, 100, false},
		{"bytes=+1-2", 100, 0, 100, false},
		{"bytes=--2", 100, 0, 100, false},
		{"items=1-2", 100, 0, 100, false},
		{"bytes=1-99999999999999999999", 100, 0, 100, false},
		{"bytes=1-999999999999999999", 100, 1, 99, true},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		esk_byte_range range;
		const bool good = esk_byte_range_parse(cases[i].header, cases[i].total, &range);
		if (good != (cases[i].size > 0) ||
			(good && (range.first != cases[i].first || range.size != cases[i].size ||
					 range.partial != cases[i].partial)))
			fail_msg("%s of %d: %d, %d bytes from %d on", cases[i].header, (int)cases[i].total, good,
				(int)range.size, (int)range.first);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(ranges_are_read_as_the_rfc_has_them)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
