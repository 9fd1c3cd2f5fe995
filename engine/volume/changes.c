/* Bytes are compared with those that lie a voxel before them, 64 at a time and whatever the datatype: voxels differ when
 * any of their bytes do. AVX2 does it where the processor has it; the result is the same. */
#include "changes.h"

#include "bytes.h"

#include <string.h>

enum { block_size = 64 };

/* The bytes of a block that differ, one bit each, the lowest for the first. */
typedef uint64_t compare(const uint8_t *a, const uint8_t *b);

/* The first bytes of the voxels that the differing bytes belong to. */
static inline uint64_t first_bytes(uint64_t differing, unsigned voxel_size)
{
	for (unsigned s = 1; s < voxel_size; s *= 2)
		differing |= differing >> s;
	/* every voxel_size-th bit */
	return differing & UINT64_MAX / ((UINT64_C(2) << (voxel_size - 1)) - 1);
}

static inline size_t put_offsets(uint64_t bits, size_t at, uint16_t *offsets)
{
	size_t count = 0;
	for (; bits != 0; bits &= bits - 1)
		offsets[count++] = (uint16_t)(at + (unsigned)__builtin_ctzll(bits));
	return count;
}

/* Inlined together with the comparison. */
__attribute__((always_inline)) static inline size_t find(
	const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets, compare *differing_bytes)
{
	size_t count = 0, at = 0;
	for (; size - at >= block_size; at += block_size) {
		uint64_t differing = differing_bytes(bytes + at, bytes + at - voxel_size);
		if (differing != 0)
			count += put_offsets(first_bytes(differing, voxel_size), at, offsets + count);
	}
	if (at < size) {
		uint8_t here[block_size] = {0}, before[block_size] = {0};
		memcpy(here, bytes + at, size - at);
		memcpy(before, bytes + at - voxel_size, size - at);
		count += put_offsets(first_bytes(differing_bytes(here, before), voxel_size), at, offsets + count);
	}
	return count;
}

/* The bytes of a word that are not 0, one bit each. */
static inline uint64_t nonzero_bytes(uint64_t word)
{
	const uint64_t low = 0x7f7f7f7f7f7f7f7f;
	uint64_t tops =
		((word & low) + low) | word; /* the top bit of a byte is set when any was; no sum carries over */
	/* The product moves the top bit of byte i to bit 56 + i: no two of its terms meet, so nothing carries either. */
	return (tops >> 7 & 0x0101010101010101) * 0x0102040810204080 >> 56;
}

static inline uint64_t compare_words(const uint8_t *a, const uint8_t *b)
{
	uint64_t differing = 0;
	for (unsigned i = 0; i < block_size; i += 8) {
		uint64_t difference = esk_bytes_get_u64(a + i) ^ esk_bytes_get_u64(b + i);
		if (difference != 0)
			differing |= nonzero_bytes(difference) << i;
	}
	return differing;
}

size_t esk_changes_find_plainly(const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets)
{
	return find(bytes, size, voxel_size, offsets, compare_words);
}

#ifdef __x86_64__

#include <immintrin.h>

__attribute__((target("avx2"))) static inline uint32_t equal_bytes(const uint8_t *a, const uint8_t *b)
{
	__m256i here = _mm256_loadu_si256((const __m256i *)(const void *)a);
	__m256i there = _mm256_loadu_si256((const __m256i *)(const void *)b);
	return (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(here, there));
}

__attribute__((target("avx2"))) static inline uint64_t compare_vectors(const uint8_t *a, const uint8_t *b)
{
	return ~(equal_bytes(a, b) | (uint64_t)equal_bytes(a + 32, b + 32) << 32);
}

__attribute__((target("avx2"))) static size_t find_by_vectors(
	const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets)
{
	return find(bytes, size, voxel_size, offsets, compare_vectors);
}

size_t esk_changes_find(const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets)
{
	if (__builtin_cpu_supports("avx2"))
		return find_by_vectors(bytes, size, voxel_size, offsets);
	return esk_changes_find_plainly(bytes, size, voxel_size, offsets);
}

#else

size_t esk_changes_find(const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets)
{
	return esk_changes_find_plainly(bytes, size, voxel_size, offsets);
}

#endif
