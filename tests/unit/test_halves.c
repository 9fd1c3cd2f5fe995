#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "halves.c" /* for the widths that this processor would not choose */

#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { rows = 37, size = 160 };

/* Rows end where memory does, so that a sanitizer sees what is read past them. */
typedef struct {
	float mine[size], steps[rows];
	uint8_t *codes[rows];
} sample;

static void fill(sample *s)
{
	uint64_t random = 7;
	for (size_t n = 0; n < size; n++)
		s->mine[n] = (float)(1.5 * synthetic_uniform(&random));
	for (size_t i = 0; i < rows; i++) {
		s->steps[i] = (float)(100 + 200 * synthetic_uniform(&random));
		s->codes[i] = malloc(size);
		assert_non_null(s->codes[i]);
		for (size_t n = 0; n < size; n++)
			s->codes[i][n] = (uint8_t)synthetic_random(&random);
	}
}

static void clear(sample *s)
{
	for (size_t i = 0; i < rows; i++)
		free(s->codes[i]);
}

static double expected_sum(const sample *s, size_t row, size_t begin, size_t end)
{
	double sum = 0;
	for (size_t n = begin; n < end; n++)
		sum += fabs(fmin((double)s->mine[n] * (double)s->steps[row], 255) - s->codes[row][n]);
	return sum;
}

typedef void width(const float *, size_t, size_t, size_t, const uint8_t *const *, const float *, size_t, float *);

static void check_range(const sample *s, width *sum, const char *name, size_t begin, size_t end)
{
	float sums[rows], plain[rows];
	const uint8_t *const *codes = (const uint8_t *const *)s->codes;
	sum(s->mine, begin, end, size, codes, s->steps, rows, sums);
	sum_plain(s->mine, begin, end, size, codes, s->steps, rows, plain);
	for (size_t i = 0; i < rows; i++) {
		const double expected = expected_sum(s, i, begin, end);
		if (fabs((double)sums[i] - expected) > 1e-6 * (expected + 255) ||
			memcmp(&sums[i], &plain[i], sizeof(float)))
			fail_msg("%s: numbers %zu to %zu of row %zu come to %.9g, expected %.9g, plain %.9g", name,
				begin, end, i, (double)sums[i], expected, (double)plain[i]);
	}
}

static void check(width *sum, const char *name)
{
	sample s;
	fill(&s);
	for (size_t begin = 0; begin < size; begin += 1 + begin / 8)
		for (size_t end = begin; end <= size; end++)
			check_range(&s, sum, name, begin, end);
	clear(&s);
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
