#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "key_blocks.h"
#include "synthetic.h"

enum { most = 400 };

/* Ascending keys from first on, each either the next number or some way off. */
static size_t make_keys(uint64_t *random, int64_t first, unsigned step, int64_t keys[most])
{
	int64_t key = first;
	size_t count = 0;
	while (count < most && key <= INT64_MAX - (int64_t)step - 1) {
		keys[count++] = key++;
		if (synthetic_random(random) % 10 == 0)
			key += (int64_t)(synthetic_random(random) % step);
	}
	return count;
}

static void check(uint64_t *random, const int64_t *keys, size_t count, unsigned one_in)
{
	bool is_member[most];
	eskel_key_block blocks[most];
	size_t block_count = 0, members = 0, at = 0;
	for (size_t n = 0; n < count; n++) {
		is_member[n] = synthetic_random(random) % one_in == 0;
		members += is_member[n];
		if (is_member[n])
			block_count = eskel_key_blocks_add(blocks, block_count, keys[n], 1);
		assert_true(block_count <= members);
	}
	for (size_t b = 0; b < block_count; b++) {
		assert_int_equal((uint64_t)blocks[b].first % 64, 0);
		assert_true(blocks[b].members && (b == 0 || blocks[b - 1].first < blocks[b].first));
	}
	for (size_t n = 0, some; n < count; n += some) {
		some = 1 + synthetic_random(random) % 64;
		some = some < count - n ? some : count - n;
		const uint64_t found = esk_key_blocks_find(blocks, block_count, &at, keys + n, (uint32_t)some);
		for (size_t i = 0; i < 64; i++)
			assert_int_equal(found >> i & 1, i < some && is_member[n + i]);
	}
}

static void members_are_found_and_no_others(void **state)
{
	(void)state;
	static const int64_t firsts[] = {
		0, 1, 63, -64, -1000, INT64_MIN, INT64_MIN + 5, INT64_MAX - 3000, INT64_MAX / 2};
	int64_t keys[most];
	uint64_t random = 5;
	for (size_t f = 0; f < sizeof firsts / sizeof *firsts; f++)
		for (unsigned step = 1; step < 1000; step *= 9)
			for (unsigned one_in = 1; one_in < 100; one_in *= 3) {
				const size_t count = make_keys(&random, firsts[f], step, keys);
				assert_true(count > 0);
				check(&random, keys, count, one_in);
			}
}

static void many_are_added_as_one_by_one(void **state)
{
	(void)state;
	uint64_t random = 9;
	for (int64_t key = -200; key < 200; key++) {
		eskel_key_block together[4], alone[4];
		const uint64_t first = synthetic_random(&random) % 4 ? 0 : synthetic_random(&random),
			       members = synthetic_random(&random);
		size_t count = eskel_key_blocks_add(together, 0, -1000, first), expected = 0;
		count = eskel_key_blocks_add(together, count, key, members);
		assert_true(count <= 4);
		expected = eskel_key_blocks_add(alone, 0, -1000, first);
		for (int i = 0; i < 64; i++)
			if (members >> i & 1)
				expected = eskel_key_blocks_add(alone, expected, key + i, 1);
		assert_int_equal(count, expected);
		for (size_t b = 0; b < count; b++) {
			assert_int_equal(together[b].first, alone[b].first);
			assert_int_equal(together[b].members, alone[b].members);
		}
	}
	assert_int_equal(eskel_key_blocks_add(NULL, 0, 7, 0), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(members_are_found_and_no_others),
		cmocka_unit_test(many_are_added_as_one_by_one),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
