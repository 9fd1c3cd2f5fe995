#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "envelope.c" /* for the widths that this processor would not choose */

#include "synthetic.h"

#include <string.h>

/* The loops of one vector width. */
typedef struct {
	const char *name;
	bool is_there;
	void (*tally)(const esk_envelope *, const esk_pack *, const uint64_t *, size_t, esk_tally *);
	uint64_t (*candidates)(const esk_envelope *, const esk_box *, double, double *);
} width;

enum { WIDTHS = 4, PACKS = 12 };

static void list_widths(width widths[WIDTHS])
{
	memset(widths, 0, WIDTHS * sizeof *widths);
	widths[0] = (width){"plain", true, tally_packs_2, find_candidates_2};
	widths[1] = (width){"widest", true, esk_envelope_tally, esk_envelope_candidates};
#if defined(__x86_64__)
	widths[2] = (width){"avx2", __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"), tally_packs_4,
		find_candidates_4};
	widths[3] = (width){"avx512", __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"),
		tally_packs_8, find_candidates_8};
#endif
}

static int64_t integer(uint64_t *random, int bits)
{
	return (int64_t)(synthetic_random(random) >> (64 - bits)) - ((int64_t)1 << (bits - 1));
}

/* bits: of the slopes. 25 for scores near the bound of 2^51, so that a rounding anywhere would show; few for many classes
 * of equal slope and voxels of equal score, but for the class. */
static void fill_scores(uint64_t *random, uint32_t classes, int bits, esk_scores *scores)
{
	scores->count = classes;
	for (uint32_t j = 0; j < classes; j++) {
		scores->constant[j] = (double)(integer(random, bits + 17) * 64 + j);
		for (int r = 0; r < 3; r++)
			scores->slope[r][j] = (double)(integer(random, bits) * 128);
	}
}

static esk_pack random_pack(uint64_t *random, int bits)
{
	esk_segment segments[ESK_PACK];
	const size_t count = 1 + synthetic_random(random) % ESK_PACK;
	for (size_t i = 0; i < count; i++) {
		esk_segment *s = &segments[i];
		s->x_first = (int32_t)integer(random, 16);
		s->x_last = s->x_first + 2 * (int32_t)(synthetic_random(random) % 500);
		s->y = (int32_t)integer(random, bits > 10 ? 17 : 6);
		s->z = (int32_t)integer(random, bits > 10 ? 17 : 6);
		s->weight = 1 + synthetic_random(random) % 1000;
	}
	return esk_pack_of(segments, count);
}

static int64_t score_at(const esk_scores *s, uint32_t j, int64_t x, int64_t y, int64_t z)
{
	return (int64_t)s->constant[j] + (int64_t)s->slope[0][j] * x + (int64_t)s->slope[1][j] * y +
	       (int64_t)s->slope[2][j] * z;
}

static uint32_t winner_at(const esk_scores *s, int64_t x, int64_t y, int64_t z)
{
	uint32_t winner = 0;
	for (uint32_t j = 1; j < s->count; j++)
		if (score_at(s, j, x, y, z) < score_at(s, winner, x, y, z))
			winner = j;
	return winner;
}

/* Voxel by voxel, in integers. */
static void sum_voxels(const esk_scores *scores, const esk_pack *pack, esk_sums *sums)
{
	for (int i = 0; i < ESK_PACK; i++)
		for (int32_t n = 0; n < (int32_t)pack->voxels[i]; n++) {
			const int32_t x = (int32_t)pack->x_first[i] + 2 * n, y = (int32_t)pack->y[i],
				      z = (int32_t)pack->z[i];
			const esk_segment voxel = {x, x, y, z, (uint64_t)pack->weight[i]};
			esk_sums_add(&sums[winner_at(scores, x, y, z)], &voxel);
		}
}

static double total(const double lanes[ESK_PACK])
{
	double sum = 0;
	for (int i = 0; i < ESK_PACK; i++)
		sum += lanes[i];
	return sum;
}

static void check_tally(const width *w, const esk_envelope *e, const esk_pack *packs, const uint64_t *candidates,
	const esk_sums *expected)
{
	static esk_tally tally;
	memset(&tally, 0, sizeof tally);
	w->tally(e, packs, candidates, PACKS, &tally);
	for (uint32_t i = 0; i < e->count; i++) {
		const esk_sums *sums = &expected[e->class_index[i]];
		if (total(tally.weight[i]) != (double)sums->weight)
			fail_msg("%s, %u classes: weight %.0f of class %u, expected %.0f", w->name, e->count,
				total(tally.weight[i]), e->class_index[i], (double)sums->weight);
		for (int r = 0; r < 3; r++)
			if (total(tally.first[i][r]) != (double)sums->first[r])
				fail_msg("%s, %u classes: sum %d of class %u is %.0f, expected %.0f", w->name, e->count,
					r, e->class_index[i], total(tally.first[i][r]), (double)sums->first[r]);
	}
}

static void every_vector_width_sums_what_voxels_do_in_integers(void **state)
{
	(void)state;
	static esk_scores scores;
	static esk_envelope envelope;
	esk_pack packs[PACKS];
	width widths[WIDTHS];
	uint64_t random = 1;
	list_widths(widths);
	for (int bits = 1; bits <= 25; bits += 6)
		for (uint32_t classes = 2; classes <= ESKEL_LEVELS_MAX; classes += 1 + classes / 5) {
			uint64_t candidates[PACKS];
			esk_sums expected[ESKEL_LEVELS_MAX] = {{0}};
			fill_scores(&random, classes, bits, &scores);
			esk_envelope_set(&envelope, &scores);
			for (size_t p = 0; p < PACKS; p++) {
				packs[p] = random_pack(&random, bits);
				candidates[p] = ~(uint64_t)0 >> (ESKEL_LEVELS_MAX - classes);
				sum_voxels(&scores, &packs[p], expected);
			}
			for (int w = 0; w < WIDTHS; w++)
				if (widths[w].is_there)
					check_tally(&widths[w], &envelope, packs, candidates, expected);
		}
}

/* Stretches follow each other in the order of ranks, and each voxel of one is won by its class. */
static void stretches_are_where_each_class_wins(void **state)
{
	(void)state;
	static esk_scores scores;
	static esk_envelope envelope;
	uint64_t random = 2;
	for (uint32_t classes = 1; classes <= ESKEL_LEVELS_MAX; classes += 1 + classes / 8) {
		esk_stretch stretches[ESKEL_LEVELS_MAX];
		fill_scores(&random, classes, 1 + (int)classes % 25, &scores);
		esk_envelope_set(&envelope, &scores);
		const esk_pack pack = random_pack(&random, 1 + (int)classes % 25);
		esk_envelope_divide(&envelope, &pack, ~(uint64_t)0 >> (ESKEL_LEVELS_MAX - classes), stretches);
		for (int i = 0; i < ESK_PACK; i++) {
			double next = 0;
			for (uint32_t j = 0; j < classes; j++) {
				if (stretches[j].end[i] <= stretches[j].first[i])
					continue;
				assert_true(stretches[j].first[i] == next);
				next = stretches[j].end[i];
				for (double n = stretches[j].first[i]; n < next; n++)
					assert_int_equal(envelope.class_index[j],
						winner_at(&scores, (int64_t)(pack.x_first[i] + 2 * n),
							(int64_t)pack.y[i], (int64_t)pack.z[i]));
			}
			assert_true(next == pack.voxels[i]);
		}
	}
}

/* Whatever is not a candidate loses by more than the margin, and by the least lead at least, at every corner and in
 * between. */
static void check_candidates(const width *w, const esk_scores *scores, const esk_envelope *e, const esk_box *box,
	uint64_t expected, double expected_lead)
{
	const double margin = fabs(scores->constant[0]) / 8;
	double lead = 0x1p60;
	const uint64_t found = w->candidates(e, box, margin, &lead);
	assert_true(found == expected && lead == expected_lead);
	assert_true(lead > margin);
	for (int x = -2; x <= 2; x++)
		for (int y = -2; y <= 2; y++)
			for (int z = -2; z <= 2; z++) {
				const int64_t u[3] = {(int64_t)(box->centre[0] + box->half[0] * x / 2),
					(int64_t)(box->centre[1] + box->half[1] * y / 2),
					(int64_t)(box->centre[2] + box->half[2] * z / 2)};
				const uint32_t winner = winner_at(scores, u[0], u[1], u[2]);
				for (uint32_t i = 0; i < e->count; i++)
					if (!(found >> i & 1))
						assert_true(
							(double)(score_at(scores, e->class_index[i], u[0], u[1], u[2]) -
								 score_at(scores, winner, u[0], u[1], u[2])) >= lead);
			}
}

static void every_vector_width_finds_the_same_candidates_and_no_other_class_wins(void **state)
{
	(void)state;
	static esk_scores scores;
	static esk_envelope envelope;
	width widths[WIDTHS];
	uint64_t random = 3;
	size_t left_out = 0;
	list_widths(widths);
	for (int round = 0; round < 200; round++) {
		const uint32_t classes = 1 + (uint32_t)round % ESKEL_LEVELS_MAX;
		esk_box box;
		for (int r = 0; r < 3; r++) {
			box.half[r] = (double)(2 * (synthetic_random(&random) % 2000));
			box.centre[r] = (double)integer(&random, 15);
		}
		fill_scores(&random, classes, 1 + round % 25, &scores);
		esk_envelope_set(&envelope, &scores);
		double lead = 0x1p60;
		const uint64_t found = find_candidates_2(&envelope, &box, fabs(scores.constant[0]) / 8, &lead);
		left_out += classes - (uint32_t)__builtin_popcountll(found);
		for (int w = 0; w < WIDTHS; w++)
			if (widths[w].is_there)
				check_candidates(&widths[w], &scores, &envelope, &box, found, lead);
	}
	assert_true(left_out > 1000);
}

static void ranks_follow_falling_slopes_and_tell_when_they_change(void **state)
{
	(void)state;
	static esk_scores scores;
	static esk_envelope envelope;
	uint64_t random = 4;
	fill_scores(&random, 20, 20, &scores);
	assert_false(esk_envelope_set(&envelope, &scores));
	assert_true(esk_envelope_set(&envelope, &scores));
	for (uint32_t i = 1; i < 20; i++)
		assert_true(envelope.slope[0][i - 1] >= envelope.slope[0][i]);
	for (uint32_t i = 0; i < 20; i++)
		assert_int_equal(envelope.rank[envelope.class_index[i]], i);
	scores.slope[0][envelope.class_index[7]] = scores.slope[0][envelope.class_index[12]] - 128;
	const esk_envelope before = envelope;
	assert_false(esk_envelope_set(&envelope, &scores));
	const uint64_t ranks = 0xa5c93, now = esk_envelope_follow(&envelope, ranks);
	for (uint32_t i = 0; i < 20; i++)
		assert_int_equal(now >> envelope.rank[before.class_index[i]] & 1, ranks >> i & 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_vector_width_sums_what_voxels_do_in_integers),
		cmocka_unit_test(stretches_are_where_each_class_wins),
		cmocka_unit_test(every_vector_width_finds_the_same_candidates_and_no_other_class_wins),
		cmocka_unit_test(ranks_follow_falling_slopes_and_tell_when_they_change),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
