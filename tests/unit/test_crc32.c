#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "crc32.h"

#include <zlib.h>

static void fill_random(uint8_t *bytes, size_t size)
{
	uint64_t state = 1;
	for (size_t i = 0; i < size; i++) {
		state = state * 6364136223846793005u + 1442695040888963407u;
		bytes[i] = (uint8_t)(state >> 56);
	}
}

static void the_checksum_of_a_known_text_is_known(void **state)
{
	(void)state;
	assert_int_equal(esk_crc32(0, (const uint8_t *)"123456789", 9), 0xcbf43926);
}

static void every_length_and_alignment_gives_what_zlib_gives(void **state)
{
	(void)state;
	uint8_t bytes[512];
	fill_random(bytes, sizeof bytes);
	for (size_t start = 0; start < 17; start++)
		for (size_t size = 0; size < 400; size++) {
			uint32_t expected = (uint32_t)crc32_z(0, bytes + start, size);
			uint32_t got = esk_crc32(0, bytes + start, size);
			if (got != expected)
				fail_msg("%zu bytes from %zu: %08x, expected %08x", size, start, got, expected);
		}
}

static void pieces_add_up_to_the_whole(void **state)
{
	(void)state;
	uint8_t bytes[1000];
	fill_random(bytes, sizeof bytes);
	for (size_t first = 0; first <= sizeof bytes; first++)
		assert_int_equal(esk_crc32(esk_crc32(0, bytes, first), bytes + first, sizeof bytes - first),
			crc32_z(0, bytes, sizeof bytes));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_checksum_of_a_known_text_is_known),
		cmocka_unit_test(every_length_and_alignment_gives_what_zlib_gives),
		cmocka_unit_test(pieces_add_up_to_the_whole),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
