/* One loop in the widths that processors have; the widest one there is runs. A row is summed in sixteen lanes, which are put
 * together in one order, and nothing is fused, so all of them find the same.
 *
 * What is left after whole sixteens is a part of another sixteen, which lies in the row: what follows a row may be another
 * shape's, being written. */
#include "halves.h"

enum { SUMMED = 16 };

/* A mask of the first n of sixteen begins at 16 - n. */
static const int32_t some_of_sixteen[2 * SUMMED] = {-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};

typedef float four __attribute__((vector_size(16), may_alias, aligned(4)));

static inline __attribute__((always_inline)) float sum_of_sixteen(const float *numbers)
{
	const four *fours = (const four *)numbers;
	const four sum = (fours[0] + fours[2]) + (fours[1] + fours[3]);
	return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

#if defined(__x86_64__)
#include <immintrin.h>

#define LANES 16
#define NAME sum_avx512
#define TARGET __attribute__((target("avx512f")))
#define MIN(a, b) _mm512_min_ps(a, b)
#define TO_FLOAT(p) _mm512_cvtepi32_ps(_mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)(p))))
#include "halves_lanes.h"

#define LANES 8
#define NAME sum_avx2
#define TARGET __attribute__((target("avx2")))
#define MIN(a, b) _mm256_min_ps(a, b)
#define TO_FLOAT(p) _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(p))))
#include "halves_lanes.h"
#endif

/* Four lanes: SSE2 and NEON, which are always there. */
#define LANES 4
#define NAME sum_plain
#define TARGET
#define BELOW(a, b) ((a) < (b))
#define MIN(a, b) ((lanes_4)((BELOW(a, b) & (integers_4)(a)) | (~BELOW(a, b) & (integers_4)(b))))
#define TO_FLOAT(p) ((lanes_4){(p)[0], (p)[1], (p)[2], (p)[3]})
#include "halves_lanes.h"

void esk_halves_sum(const float *mine, size_t begin, size_t end, size_t size, const uint8_t *const *rows,
	const float *steps, size_t row_count, float *sums)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx512f")) {
		sum_avx512(mine, begin, end, size, rows, steps, row_count, sums);
		return;
	}
	if (__builtin_cpu_supports("avx2")) {
		sum_avx2(mine, begin, end, size, rows, steps, row_count, sums);
		return;
	}
#endif
	sum_plain(mine, begin, end, size, rows, steps, row_count, sums);
}
