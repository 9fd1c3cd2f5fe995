#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "below.c" /* for the widths that this processor would not choose */

#include "synthetic.h"

#include <math.h>
#include <string.h>

enum { most = 512 };

typedef uint32_t width(const float *, uint32_t, float, uint16_t *);

static void check_one(width *find, const char *name, const float *numbers, uint32_t count, float limit)
{
	uint16_t places[most];
	uint32_t expected = 0, found = find(numbers, count, limit, places);
	for (uint32_t n = 0; n < count; n++)
		if (numbers[n] <= limit) {
			if (expected >= found || places[expected] != n)
				fail_msg("%s: place %u is missing among those of at most %g", name, n, (double)limit);
			expected++;
		}
	assert_int_equal(found, expected);
}

static void check(width *find, const char *name)
{
	static float numbers[most];
	uint64_t random = 3;
	for (uint32_t n = 0; n < most; n++)
		numbers[n] = n % 50 == 7 ? INFINITY : (float)synthetic_uniform(&random);
	numbers[3] = numbers[100]; /* equal ones stay in */
	for (uint32_t count = 0; count <= most; count += 16) {
		check_one(find, name, numbers, count, -1);
		check_one(find, name, numbers, count, 0.01f);
		check_one(find, name, numbers, count, numbers[100]);
		check_one(find, name, numbers, count, 2);
		check_one(find, name, numbers, count, INFINITY);
	}
}

static void every_width_finds_the_same_places(void **state)
{
	(void)state;
	check(find_plain, "plain");
	check(esk_below, "chosen");
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2"))
		check(find_avx2, "avx2");
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl"))
		check(find_avx512, "avx512");
#endif
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(every_width_finds_the_same_places)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
