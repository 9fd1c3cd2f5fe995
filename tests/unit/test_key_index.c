#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "key_index.h"
#include "synthetic.h"

#include <stdlib.h>

/* A factor of 2^40 gives all keys one home: their products with an odd number agree in the bits that it is made of. */
enum { chunks = 8, numbers = chunks * ESK_CHUNK_SLOTS };

/* Chunks that hold keys alone. */
static esk_directory *new_directory(esk_arena *arena)
{
	esk_directory *directory = NULL;
	assert_int_equal(esk_directory_new(chunks, &directory), ESKEL_OK);
	for (uint32_t c = 0; c < chunks; c++) {
		esk_chunk *chunk = NULL;
		assert_int_equal(esk_chunk_new(ESK_CHUNK_SLOTS, arena, &chunk), ESKEL_OK);
		esk_directory_set(directory, c, chunk);
	}
	return directory;
}

static int64_t *key_of(esk_directory *directory, uint32_t id)
{
	return &directory->chunks[id / ESK_CHUNK_SLOTS]->keys[id % ESK_CHUNK_SLOTS];
}

static void check_against_a_plain_list(int64_t factor)
{
	esk_arena arena = {0};
	esk_key_index index = {0};
	esk_directory *directory = new_directory(&arena);
	static bool held[numbers]; /* number n, which holds the key n factor */
	uint64_t random = 3;
	for (int round = 0; round < 40000; round++) {
		const uint32_t id = (uint32_t)(synthetic_random(&random) % numbers);
		int64_t *key = key_of(directory, id);
		if (!held[id]) {
			*key = factor * id;
			assert_true(esk_key_index_reserve(&index, directory));
			esk_key_index_insert(&index, *key, id);
		} else {
			esk_key_index_remove(&index, directory, *key, id);
		}
		held[id] = !held[id];
		if (round % 4000 == 3999)
			for (uint32_t n = 0; n < numbers; n++) {
				uint32_t found = UINT32_MAX;
				assert_int_equal(esk_key_index_find(&index, directory, factor * n, &found), held[n]);
				assert_int_equal(found, held[n] ? n : UINT32_MAX);
			}
	}
	for (uint32_t n = 0; n < numbers; n++)
		held[n] = false;
	esk_key_index_clear(&index);
	esk_directory_release(directory);
	esk_arena_clear(&arena);
}

static void an_index_equals_a_plain_list_after_any_insertions_and_removals(void **state)
{
	(void)state;
	check_against_a_plain_list(1);
	check_against_a_plain_list(-7919);

	check_against_a_plain_list((int64_t)1 << 40);
}

static void a_moved_key_is_found_at_its_new_place(void **state)
{
	(void)state;
	enum { count = ESK_CHUNK_SLOTS };
	esk_arena arena = {0};
	esk_key_index index = {0};
	esk_directory *directory = new_directory(&arena);
	for (uint32_t id = 0; id < count; id++) {
		*key_of(directory, id) = *key_of(directory, 3 * ESK_CHUNK_SLOTS + id) = -5 * (int64_t)id;
		assert_true(esk_key_index_reserve(&index, directory));
		esk_key_index_insert(&index, -5 * (int64_t)id, id);
	}
	for (uint32_t id = 0; id < count; id++)
		esk_key_index_move(&index, -5 * (int64_t)id, id, 3 * ESK_CHUNK_SLOTS + id);
	for (uint32_t id = 0; id < count; id++) {
		uint32_t found = 0;
		assert_true(esk_key_index_find(&index, directory, -5 * (int64_t)id, &found));
		assert_int_equal(found, 3 * ESK_CHUNK_SLOTS + id);
	}
	esk_key_index_clear(&index);
	esk_directory_release(directory);
	esk_arena_clear(&arena);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_index_equals_a_plain_list_after_any_insertions_and_removals),
		cmocka_unit_test(a_moved_key_is_found_at_its_new_place),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
