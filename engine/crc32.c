/* CRC-32 by carry-less multiplication, after V. Gopal et al., "Fast CRC Computation for Generic Polynomials Using the
 * PCLMULQDQ Instruction" (Intel, 2009).
 *
 * A message is a polynomial over GF(2), its CRC the remainder modulo P. Sixteen bytes that lie d bits before the end
 * of what is read may be replaced by anything congruent d bits further on, so four accumulators of 128 bits run over
 * the message: each step multiplies both halves of an accumulator by x^512 mod P (64 bytes further) and adds the next
 * 16 bytes. They are then folded into one, whose 16 bytes leave the same remainder as all that came before: zlib
 * finishes with these and with the rest. In gzip the lowest bit of a byte is the highest power, so halves, constants
 * and products are bit-reversed, and a reversed product comes out shifted by one, which the constants make good.
 */
#include "crc32.h"

#include <zlib.h>

static uint32_t crc32_by_zlib(uint32_t crc, const uint8_t *bytes, size_t size)
{
	return (uint32_t)crc32_z(crc, bytes, size);
}

#ifdef __x86_64__

#include <immintrin.h>

/* x (as halves) times x^d, as 16 bytes plus the 16 bytes found there. The low half lies 64 bits further from the end
 * than the high one: its factor is x^(d + 32) mod P, the other's x^(d - 32) mod P. */
__attribute__((target("pclmul"))) static __m128i fold(__m128i x, __m128i factors, __m128i there)
{
	__m128i low = _mm_clmulepi64_si128(x, factors, 0x00), high = _mm_clmulepi64_si128(x, factors, 0x11);
	return _mm_xor_si128(_mm_xor_si128(low, high), there);
}

static __m128i load(const uint8_t *bytes)
{
	return _mm_loadu_si128((const __m128i *)(const void *)bytes);
}

/* size is at least 64. */
__attribute__((target("pclmul"))) static uint32_t crc32_by_folding(uint32_t crc, const uint8_t *bytes, size_t size)
{
	const __m128i by_512 = _mm_set_epi64x(0x1c6e41596, 0x154442bd4),
		      by_128 = _mm_set_epi64x(0x0ccaa009e, 0x1751997d0);
	__m128i a = _mm_xor_si128(load(bytes), _mm_cvtsi32_si128((int)~crc));
	__m128i b = load(bytes + 16), c = load(bytes + 32), d = load(bytes + 48);
	for (bytes += 64, size -= 64; size >= 64; bytes += 64, size -= 64) {
		a = fold(a, by_512, load(bytes));
		b = fold(b, by_512, load(bytes + 16));
		c = fold(c, by_512, load(bytes + 32));
		d = fold(d, by_512, load(bytes + 48));
	}
	uint8_t rest[16];
	_mm_storeu_si128((__m128i *)(void *)rest, fold(fold(fold(a, by_128, b), by_128, c), by_128, d));
	/* zlib inverts the checksum before and after: all ones let it begin at zero. */
	return crc32_by_zlib(crc32_by_zlib(UINT32_MAX, rest, sizeof rest), bytes, size);
}

uint32_t esk_crc32(uint32_t crc, const uint8_t *bytes, size_t size)
{
	if (size < 64 || !__builtin_cpu_supports("pclmul"))
		return crc32_by_zlib(crc, bytes, size);
	return crc32_by_folding(crc, bytes, size);
}

#else

uint32_t esk_crc32(uint32_t crc, const uint8_t *bytes, size_t size)
{
	return crc32_by_zlib(crc, bytes, size);
}

#endif
