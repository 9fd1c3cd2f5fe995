#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "halves.c" /* for the widths that this processor would not choose */

#include "synthetic.h"

#include <math.h>
#include <string.h>

enum { rows = 37, most = 160, stride = 40 };

typedef struct {
	float mine[most + ESK_HALVES_PAST], steps[rows];
	uint8_t codes[rows * stride + most + ESK_HALVES_PAST];
	const uint8_t *row[rows];
} sample;

static void fill(sample *s)
{
	uint64_t random = 7;
	for (size_t n = 0; n < sizeof s->codes; n++)
		s->codes[n] = (uint8_t)synthetic_random(&random);
	for (size_t n = 0; n < most + ESK_HALVES_PAST; n++)
		s->mine[n] = (float)(1.5 * synthetic_uniform(&random));
	for (size_t i = 0; i < rows; i++) {
		s->steps[i] = (float)(100 + 200 * synthetic_uniform(&random));
		s->row[i] = s->codes + i * stride;
	}
}

typedef void width(const float *, size_t, const uint8_t *const *, const float *, size_t, float *);

static void check(width *sum, const char *name)
{
	static sample s;
	fill(&s);
	for (size_t count = 1; count <= most; count++) {
		float sums[rows], plain[rows];
		sum(s.mine, count, s.row, s.steps, rows, sums);
		sum_plain(s.mine, count, s.row, s.steps, rows, plain);
		for (size_t i = 0; i < rows; i++) {
			double expected = 0;
			for (size_t n = 0; n < count; n++)
				expected += fabs(fmin((double)s.mine[n] * (double)s.steps[i], 255) - s.row[i][n]);
			if (fabs((double)sums[i] - expected) > 1e-6 * (expected + 255) ||
				memcmp(&sums[i], &plain[i], sizeof(float)))
				fail_msg("%s: row %zu of %zu numbers is %.9g, expected %.9g, plain %.9g", name, i,
					count, (double)sums[i], expected, (double)plain[i]);
		}
	}
}

static void every_width_sums_what_was_asked_to_the_same_bits(void **state)
{
	(void)state;
	check(sum_plain, "plain");
	check(esk_halves_sum, "chosen");
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2"))
		check(sum_avx2, "avx2");
	if (__builtin_cpu_supports("avx512f"))
		check(sum_avx512, "avx512");
#endif
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(every_width_sums_what_was_asked_to_the_same_bits)};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
