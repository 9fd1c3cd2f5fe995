/* One loop in the widths that processors have; the widest one there is runs. Scores are exact in double (scores.h), so
 * they all find the same, with fused multiplication or without. */
#include "probe.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define LANES 8
#define NAME run_avx512
#define TARGET __attribute__((target("avx512f,avx512dq")))
#define MIN(a, b) _mm512_min_pd(a, b)
#define MAX(a, b) _mm512_max_pd(a, b)
#define MULTIPLY_ADD(a, b, c) _mm512_fmadd_pd(a, b, c)
#define TO_DOUBLE(p) _mm512_cvtepi32_pd(_mm256_loadu_si256((const __m256i *)(p)))
#include "probe_lanes.h"

#define LANES 4
#define NAME run_avx2
#define TARGET __attribute__((target("avx2,fma")))
#define MIN(a, b) _mm256_min_pd(a, b)
#define MAX(a, b) _mm256_max_pd(a, b)
#define MULTIPLY_ADD(a, b, c) _mm256_fmadd_pd(a, b, c)
#define TO_DOUBLE(p) _mm256_cvtepi32_pd(_mm_loadu_si128((const __m128i *)(p)))
#include "probe_lanes.h"
#endif

/* Two lanes: SSE2 and NEON, which are always there. */
#define LANES 2
#define NAME run_plain
#define TARGET
#define PICK(mask, a, b) ((lanes_2)(((mask) & (integers_2)(a)) | (~(mask) & (integers_2)(b))))
#define MIN(a, b) PICK((a) < (b), a, b)
#define MAX(a, b) PICK((a) > (b), a, b)
#define MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
#define TO_DOUBLE(p) ((lanes_2){(p)[0], (p)[1]})
#include "probe_lanes.h"

void esk_probes_run(esk_probes *probes, size_t count, const esk_scores *scores)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
		run_avx512(probes, count, scores);
		return;
	}
	if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
		run_avx2(probes, count, scores);
		return;
	}
#endif
	run_plain(probes, count, scores);
}
