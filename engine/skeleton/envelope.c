/* Along a segment every score is a line in x, and the voxels of a class are where its line is the lowest: one stretch, as
 * the lower envelope of lines is convex. Of two classes the one with the greater slope wins first, so along x classes follow
 * each other by falling slope: their rank. With the voxels of a segment counted from 0, class a leads class b of a higher
 * rank at voxel n by
 *
 *	lead - n loss		lead = s_b - s_a at voxel 0, loss = 2 (slope_a - slope_b)
 *
 * so that of these two a wins the first ceil(lead / loss) voxels. A class's stretch begins after the most that a lower rank
 * wins of it, and ends with the least that it wins of a higher rank.
 *
 * The quotient comes from a multiplication with 1 / loss and is rounded to the nearest integer n, by adding a number so
 * great that doubles there have no fraction. Then a wins n voxels, or one more if it still leads at voxel n, which is an
 * exact question: scores are integers below 2^51 (scores.h) and never equal. The inverse is off by 2^-52 of itself and n is
 * below 2^16 where it matters, so a wrong n comes only from quotients half way between two integers, where both are right.
 * Where the quotient lies outside the segment n may be anything outside. Lines of equal slope have loss 0; a great number
 * in place of the inverse puts n outside, on the side of the one that leads.
 *
 * There is one loop in the widths that processors have, and the widest runs. As all results are exact, they all find the
 * same, with fused multiplication or without. */
#include "envelope.h"

#include <math.h>
#include <string.h>

/* Clang unrolls by itself, and would take minutes for it where sanitizers have added to the loops. */
#if defined(__clang__)
#define EACH_UNROLLED(i, begin, end) for (uint32_t i = (begin); i < (end); i++)
#else
#define EACH_UNROLLED(i, begin, end) _Pragma("GCC unroll 8") for (uint32_t i = (begin); i < (end); i++)
#endif

/* The ranks of a set of this count. */
static inline __attribute__((always_inline)) void list_ranks(uint64_t set, uint32_t count, uint8_t *ranks)
{
	EACH_UNROLLED(i, 0, count)
	{
		ranks[i] = (uint8_t)__builtin_ctzll(set);
		set &= set - 1;
	}
}

#if defined(__x86_64__)
#include <immintrin.h>

#define LANES 8
#define TARGET __attribute__((target("avx512f,avx512dq")))
#define MIN(a, b) _mm512_min_pd(a, b)
#define MAX(a, b) _mm512_max_pd(a, b)
#define MULTIPLY_ADD(a, b, c) _mm512_fmadd_pd(a, b, c)
#define ONE_MORE_WHERE(a, b) \
	_mm512_mask_add_pd(a, _mm512_cmp_pd_mask(b, _mm512_setzero_pd(), _CMP_GT_OQ), a, _mm512_set1_pd(1))
#define LEAST(a) _mm512_reduce_min_pd(a)
#define WHERE_ABOVE(a, b) _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ)
#include "envelope_lanes.h"

__attribute__((target("avx2,fma"))) static inline double least_of_4(__m256d a)
{
	const __m128d b = _mm_min_pd(_mm256_castpd256_pd128(a), _mm256_extractf128_pd(a, 1));
	return _mm_cvtsd_f64(_mm_min_sd(b, _mm_unpackhi_pd(b, b)));
}

#define LANES 4
#define TARGET __attribute__((target("avx2,fma")))
#define MIN(a, b) _mm256_min_pd(a, b)
#define MAX(a, b) _mm256_max_pd(a, b)
#define MULTIPLY_ADD(a, b, c) _mm256_fmadd_pd(a, b, c)
#define ONE_MORE_WHERE(a, b) ((a) + _mm256_and_pd(_mm256_cmp_pd(b, _mm256_setzero_pd(), _CMP_GT_OQ), _mm256_set1_pd(1)))
#define LEAST(a) least_of_4(a)
#define WHERE_ABOVE(a, b) (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ))
#include "envelope_lanes.h"
#endif

/* Two lanes: SSE2 and NEON, which are always there. */
#define LANES 2
#define TARGET
#define MIN(a, b) PICK((a) < (b), a, b)
#define MAX(a, b) PICK((a) > (b), a, b)
#define MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#define ONE_MORE_WHERE(a, b) ((a) + PICK((b) > 0, ((lanes_2){1, 1}), ((lanes_2){0, 0})))
#define LEAST(a) ((a)[0] < (a)[1] ? (a)[0] : (a)[1])
#define WHERE_ABOVE(a, b) ((unsigned)((a)[0] > (b)[0]) | (unsigned)((a)[1] > (b)[1]) << 1)
#include "envelope_lanes.h"

void esk_envelope_divide(const esk_envelope *envelope, const esk_pack *pack, uint64_t candidates,
	esk_stretch stretches[ESKEL_LEVELS_MAX])
{
	uint8_t ranks[ESKEL_LEVELS_MAX];
	const uint32_t count = (uint32_t)__builtin_popcountll(candidates);
	list_ranks(candidates, count, ranks);
	for (size_t lane = 0; lane < ESK_PACK; lane += 2) {
		lanes_2 first[ESKEL_LEVELS_MAX], end[ESKEL_LEVELS_MAX];
		divide_2(envelope, pack, lane, ranks, count, first, end);
		for (uint32_t i = 0; i < count; i++) {
			*(lanes_2 *)&stretches[i].first[lane] = first[i];
			*(lanes_2 *)&stretches[i].end[lane] = end[i];
		}
	}
}

void esk_envelope_tally(
	const esk_envelope *envelope, const esk_pack *packs, const uint64_t *candidates, size_t count, esk_tally *tally)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
		tally_packs_8(envelope, packs, candidates, count, tally);
		return;
	}
	if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
		tally_packs_4(envelope, packs, candidates, count, tally);
		return;
	}
#endif
	tally_packs_2(envelope, packs, candidates, count, tally);
}

uint64_t esk_envelope_candidates(const esk_envelope *e, const esk_box *box, double margin, double *least_lead)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
		return find_candidates_8(e, box, margin, least_lead);
	if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
		return find_candidates_4(e, box, margin, least_lead);
#endif
	return find_candidates_2(e, box, margin, least_lead);
}

/* By falling slope. Insertion, as the order of the last scores is nearly right. */
static bool sort(esk_envelope *e, const esk_scores *scores)
{
	bool same = e->count == scores->count;
	if (!same)
		for (uint32_t j = 0; j < scores->count; j++)
			e->class_index[j] = (uint8_t)j;
	e->count = scores->count;
	for (uint32_t i = 1; i < e->count; i++)
		for (uint32_t j = i; j > 0; j--) {
			const uint8_t a = e->class_index[j - 1], b = e->class_index[j];
			if (scores->slope[0][a] >= scores->slope[0][b])
				break;
			e->class_index[j - 1] = b;
			e->class_index[j] = a;
			same = false;
		}
	return same;
}

bool esk_envelope_set(esk_envelope *e, const esk_scores *scores)
{
	const bool as_many = e->count == scores->count;
	uint8_t before[ESKEL_LEVELS_MAX];
	memcpy(before, e->class_index, sizeof before);
	const bool same = sort(e, scores);
	const uint32_t padded = (e->count + 7) & ~7u;
	for (uint32_t i = e->count; i < padded; i++) {
		e->constant[i] = 0x1p60;
		e->slope[0][i] = e->slope[1][i] = e->slope[2][i] = 0;
	}
	for (uint32_t i = 0; i < e->count; i++) {
		e->rank[e->class_index[i]] = (uint8_t)i;
		e->constant[i] = scores->constant[e->class_index[i]];
		for (int r = 0; r < 3; r++)
			e->slope[r][i] = scores->slope[r][e->class_index[i]];
	}
	for (uint32_t i = 0; i < e->count && as_many; i++)
		e->successor[i] = e->rank[before[i]];
	for (uint32_t i = 0; i < e->count; i++)
		for (uint32_t j = i + 1; j < e->count; j++) {
			const double loss = 2 * (e->slope[0][i] - e->slope[0][j]);
			e->change[i][j] = -loss;
			e->inverse[i][j] = loss > 0 ? 1 / loss : 0x1p20;
		}
	return same;
}

uint64_t esk_envelope_follow(const esk_envelope *e, uint64_t ranks)
{
	uint64_t now = 0;
	for (; ranks; ranks &= ranks - 1)
		now |= (uint64_t)1 << e->successor[__builtin_ctzll(ranks)];
	return now;
}
