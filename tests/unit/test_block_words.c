#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "block_words.h"
#include "synthetic.h"

/* The slot of the block, and the place there, that a node's neighbour in a slot has: by coordinates, -4 to 7. */
static void step(int place, int slot, int *block_slot, int *to)
{
	const int mask = slot == ESK_OWN ? 0 : slot % 7 + 1, sign = slot < 7 ? 1 : -1;
	const int at[3] = {place / 16, place / 4 % 4, place % 4};
	int across = 0;
	*to = 0;
	for (int a = 0; a < 3; a++) {
		const int moved = at[a] + sign * (mask >> a & 1);
		across |= (moved < 0 || moved > 3) << a;
		*to = 4 * *to + (moved + 4) % 4;
	}
	*block_slot = esk_slot_of(across, sign < 0);
}

static void gathering_finds_the_bits_of_neighbours(void **state)
{
	(void)state;
	uint64_t random = 1, words[ESK_AROUND], near[ESK_AROUND];
	for (int s = 0; s < ESK_AROUND; s++)
		words[s] = synthetic_random(&random);
	esk_words_gather(words, false, near);
	esk_words_gather(words, true, near);
	for (int place = 0; place < 64; place++) {
		unsigned bits = 0;
		for (int s = 0; s < ESK_AROUND; s++) {
			int block_slot, to;
			step(place, s, &block_slot, &to);
			assert_int_equal(near[s] >> place & 1, words[block_slot] >> to & 1);
			bits |= (unsigned)(words[block_slot] >> to & 1) << s;
		}
		assert_int_equal(esk_words_bits(near, place), bits & ((1u << ESK_OWN) - 1));
	}
}

static void spreading_reaches_a_node_and_its_neighbours(void **state)
{
	(void)state;
	uint64_t random = 2;
	for (int trial = 0; trial < 100; trial++) {
		const uint64_t word = synthetic_random(&random) & synthetic_random(&random) & synthetic_random(&random);
		uint64_t reached[ESK_AROUND], expected[ESK_AROUND] = {0};
		esk_words_spread(word, reached);
		for (int place = 0; place < 64; place++)
			for (int s = 0; s < ESK_AROUND && word >> place & 1; s++) {
				int block_slot, to;
				step(place, s, &block_slot, &to);
				expected[block_slot] |= (uint64_t)1 << to;
			}
		assert_memory_equal(reached, expected, sizeof expected);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gathering_finds_the_bits_of_neighbours),
		cmocka_unit_test(spreading_reaches_a_node_and_its_neighbours),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
