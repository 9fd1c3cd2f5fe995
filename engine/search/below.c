/* Sixteen numbers at a time. Few are small enough, so that it pays to pass over those that are not together. */
#include "below.h"

#if defined(__x86_64__)
#include <immintrin.h>

/* The places of those that are move to the front of a register, which is stored whole: there is room up to count. */
__attribute__((target("avx512f,avx512vl,popcnt"))) static uint32_t find_avx512(
	const float *numbers, uint32_t count, float limit, uint16_t *places)
{
	const __m512 limits = _mm512_set1_ps(limit);
	const __m512i sixteen = _mm512_set1_epi32(16);
	__m512i at = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
	uint32_t found = 0;
	for (uint32_t n = 0; n < count; n += 16, at = _mm512_add_epi32(at, sixteen)) {
		const __mmask16 small = _mm512_cmp_ps_mask(_mm512_loadu_ps(numbers + n), limits, _CMP_LE_OQ);
		const __m512i front = _mm512_maskz_compress_epi32(small, at);
		_mm256_storeu_si256((__m256i *)(void *)(places + found), _mm512_cvtepi32_epi16(front));
		found += (uint32_t)__builtin_popcount(small);
	}
	return found;
}

__attribute__((target("avx2,bmi"))) static uint32_t find_avx2(
	const float *numbers, uint32_t count, float limit, uint16_t *places)
{
	const __m256 limits = _mm256_set1_ps(limit);
	uint32_t found = 0;
	for (uint32_t n = 0; n < count; n += 8) {
		const __m256 small = _mm256_cmp_ps(_mm256_loadu_ps(numbers + n), limits, _CMP_LE_OQ);
		for (uint32_t mask = (uint32_t)_mm256_movemask_ps(small); mask; mask &= mask - 1)
			places[found++] = (uint16_t)(n + (uint32_t)__builtin_ctz(mask));
	}
	return found;
}
#endif

static uint32_t find_plain(const float *numbers, uint32_t count, float limit, uint16_t *places)
{
	uint32_t found = 0;
	for (uint32_t n = 0; n < count; n++) {
		places[found] = (uint16_t)n;
		found += numbers[n] <= limit;
	}
	return found;
}

uint32_t esk_below(const float *numbers, uint32_t count, float limit, uint16_t *places)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl"))
		return find_avx512(numbers, count, limit, places);
	if (__builtin_cpu_supports("avx2"))
		return find_avx2(numbers, count, limit, places);
#endif
	return find_plain(numbers, count, limit, places);
}
