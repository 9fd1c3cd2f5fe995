#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "changes.h"

#include <stdlib.h>
#include <string.h>

enum { most_bytes = 1 << 16 };

/* Voxels, one of them before the others, of which one in so many differs from the one before it, in any one bit. */
static uint8_t *random_voxels(size_t count, unsigned voxel_size, unsigned one_in, uint64_t *seed)
{
	uint8_t *bytes = calloc(count + 1, voxel_size); /* of that size, for the address sanitizer */
	assert_non_null(bytes);
	for (size_t i = 1; i <= count; i++) {
		*seed = *seed * 6364136223846793005u + 1442695040888963407u;
		uint8_t *voxel = bytes + i * voxel_size;
		memcpy(voxel, voxel - voxel_size, voxel_size);
		if ((*seed >> 33) % one_in == 0)
			voxel[(*seed >> 40) % voxel_size] ^= (uint8_t)(1 << (*seed >> 50) % 8);
	}
	return bytes;
}

typedef size_t find(const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets);

static void assert_finds(find *found_by, const uint8_t *voxels, size_t count, unsigned voxel_size)
{
	uint16_t *offsets = calloc(count, sizeof *offsets);
	assert_non_null(offsets);
	size_t found = found_by(voxels, count * voxel_size, voxel_size, offsets), next = 0;
	for (size_t i = 0; i < count; i++) {
		const uint8_t *voxel = voxels + i * voxel_size;
		if (memcmp(voxel, voxel - voxel_size, voxel_size) == 0)
			continue;
		if (next == found || offsets[next] != i * voxel_size)
			fail_msg("voxel %zu of %u bytes was not found", i, voxel_size);
		next++;
	}
	assert_int_equal(found, next);
	free(offsets);
}

static void assert_both_find(size_t count, unsigned voxel_size, unsigned one_in, uint64_t *seed)
{
	uint8_t *bytes = random_voxels(count, voxel_size, one_in, seed);
	assert_finds(esk_changes_find, bytes + voxel_size, count, voxel_size);
	assert_finds(esk_changes_find_plainly, bytes + voxel_size, count, voxel_size);
	free(bytes);
}

static void every_change_is_found_in_any_number_of_voxels(void **state)
{
	(void)state;
	uint64_t seed = 1;
	for (unsigned voxel_size = 1; voxel_size <= 8; voxel_size *= 2)
		for (size_t count = 1; count < 400; count++)
			for (unsigned one_in = 1; one_in < 1000; one_in *= 7)
				assert_both_find(count, voxel_size, one_in, &seed);
}

static void every_change_is_found_in_the_most_bytes(void **state)
{
	(void)state;
	uint64_t seed = 2;
	for (unsigned voxel_size = 1; voxel_size <= 8; voxel_size *= 2)
		for (unsigned one_in = 1; one_in < 10000; one_in *= 20)
			assert_both_find(most_bytes / voxel_size, voxel_size, one_in, &seed);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_change_is_found_in_any_number_of_voxels),
		cmocka_unit_test(every_change_is_found_in_the_most_bytes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
