#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "probe.c" /* for the widths that this processor would not choose */

#include "synthetic.h"

static int64_t integer(uint64_t *random, int bits)
{
	return (int64_t)(synthetic_random(random) >> (64 - bits)) - ((int64_t)1 << (bits - 1));
}

/* Scores near the bound of 2^51, so that a rounding anywhere would show. */
static void fill(uint64_t *random, uint32_t classes, esk_scores *scores, esk_probes *probes)
{
	scores->count = classes;
	for (uint32_t j = 0; j < classes; j++) {
		scores->constant[j] = (double)(integer(random, 43) * 64 + j);
		for (int r = 0; r < 3; r++)
			scores->slope[r][j] = (double)(integer(random, 26) * 64);
	}
	for (size_t i = 0; i < ESK_PROBE_ROOM; i++) {
		probes->x_first[i] = (int32_t)integer(random, 17);
		probes->x_last[i] = (int32_t)integer(random, 17);
		probes->y[i] = (int32_t)integer(random, 17);
		probes->z[i] = (int32_t)integer(random, 17);
		probes->expected[i] = (int32_t)(synthetic_random(random) % classes);
	}
}

/* The winner at one place and its lead, in integers. */
static uint32_t winner_at(const esk_scores *s, int64_t x, int64_t y, int64_t z, int64_t *lead)
{
	int64_t best = (int64_t)1 << 51, second = best;
	for (uint32_t j = 0; j < s->count; j++) {
		int64_t score = (int64_t)s->constant[j] + (int64_t)s->slope[0][j] * x + (int64_t)s->slope[1][j] * y +
				(int64_t)s->slope[2][j] * z;
		if (score < best) {
			second = best;
			best = score;
		} else if (score < second)
			second = score;
	}
	*lead = second - best;
	return (uint32_t)(best & 63);
}

static void check(void (*run)(esk_probes *, size_t, const esk_scores *), const char *name)
{
	static esk_scores scores;
	static esk_probes probes;
	uint64_t random = 1;
	for (uint32_t classes = 1; classes <= ESKEL_LEVELS_MAX; classes += 1 + classes / 4) {
		fill(&random, classes, &scores, &probes);
		run(&probes, ESK_PROBES, &scores);
		for (size_t i = 0; i < ESK_PROBES; i++) {
			int64_t leads[2];
			uint32_t first = winner_at(&scores, probes.x_first[i], probes.y[i], probes.z[i], &leads[0]);
			uint32_t last = winner_at(&scores, probes.x_last[i], probes.y[i], probes.z[i], &leads[1]);
			int64_t slack = leads[0] < leads[1] ? leads[0] : leads[1];
			if ((int32_t)first != probes.expected[i] || (int32_t)last != probes.expected[i])
				slack = -1;
			if (probes.winner_first[i] != (int32_t)first || probes.winner_last[i] != (int32_t)last ||
				probes.slack[i] != (double)slack)
				fail_msg("%s, %u classes, probe %zu: %d %d %.0f, expected %u %u %lld", name, classes, i,
					probes.winner_first[i], probes.winner_last[i], probes.slack[i], first, last,
					(long long)slack);
		}
	}
}

static void every_vector_width_finds_what_integers_find(void **state)
{
	(void)state;
	check(run_plain, "plain");
	check(esk_probes_run, "widest");
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		check(run_avx2, "avx2");
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
		check(run_avx512, "avx512");
#endif
}

static void no_more_than_the_next_multiple_of_lanes_is_written(void **state)
{
	(void)state;
	static esk_scores scores;
	static esk_probes probes;
	uint64_t random = 2;
	fill(&random, 3, &scores, &probes);
	for (size_t i = 0; i < ESK_PROBE_ROOM; i++)
		probes.slack[i] = -7;
	esk_probes_run(&probes, 13, &scores);
	assert_true(probes.slack[12] != -7);
	for (size_t i = 16; i < ESK_PROBE_ROOM; i++)
		assert_true(probes.slack[i] == -7);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_vector_width_finds_what_integers_find),
		cmocka_unit_test(no_more_than_the_next_multiple_of_lanes_is_written),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
