#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "arena.h"

#include <stdbool.h>
#include <string.h>
#include <sys/mman.h>

enum { piece = 1 << 21, line = 64, most = 4096 };

static void *take(esk_arena *arena, size_t size)
{
	void *taken = esk_arena_take(arena, size);
	assert_non_null(taken);
	assert_int_equal((uintptr_t)taken % line, 0);
	return taken;
}

static void what_is_taken_is_apart_and_stays_as_it_was_written(void **state)
{
	(void)state;
	static unsigned char *taken[most];
	static size_t sizes[most];
	esk_arena arena = {0};
	for (size_t n = 0; n < most; n++) {
		sizes[n] = n % 50 == 49 ? 200000 : 1 + n * 37 % 5000;
		taken[n] = take(&arena, sizes[n]);
		memset(taken[n], (int)(n % 251), sizes[n]);
		if (n % 3 == 2) {
			esk_arena_give_back(taken[n / 2]);
			taken[n / 2] = NULL;
		}
	}
	for (size_t n = 0; n < most; n++)
		for (size_t i = 0; taken[n] && i < sizes[n]; i++)
			if (taken[n][i] != n % 251)
				fail_msg("byte %zu of what was taken as number %zu has changed", i, n);
	esk_arena_clear(&arena);
	for (size_t n = 0; n < most; n++)
		esk_arena_give_back(taken[n]);
}

static void a_piece_has_limits(void **state)
{
	(void)state;
	esk_arena arena = {0};
	assert_null(esk_arena_take(&arena, piece));
	assert_null(esk_arena_take(&arena, SIZE_MAX));
	void *whole = take(&arena, piece - line);
	void *other = take(&arena, 1);
	esk_arena_give_back(NULL);
	esk_arena_clear(&arena);
	esk_arena_clear(&arena);
	memset(whole, 1, piece - line);
	esk_arena_give_back(whole);
	esk_arena_give_back(other);
}

static uintptr_t piece_of(const void *taken)
{
	return (uintptr_t)taken / piece;
}

static void what_is_too_large_for_the_rest_of_a_piece_leaves_the_rest_to_others(void **state)
{
	(void)state;
	enum { large = 200000, small = 3072 };
	esk_arena arena = {0};
	void *first = take(&arena, piece - line - 100000), *second = take(&arena, large), *third = take(&arena, small);
	assert_int_equal(piece_of(first), piece_of(third));
	assert_true(piece_of(first) != piece_of(second));
	esk_arena_clear(&arena);
	esk_arena_give_back(first);
	esk_arena_give_back(second);
	esk_arena_give_back(third);
}

static bool is_mapped(uintptr_t number)
{
	return msync((void *)(number * piece), 4096, MS_ASYNC) == 0;
}

static void a_piece_goes_with_the_last_of_what_lies_in_it(void **state)
{
	(void)state;
	esk_arena arena = {0};
	void *first = take(&arena, 1000), *second = take(&arena, piece - 10000), *third = take(&arena, piece - line);
	const uintptr_t earlier = piece_of(first), later = piece_of(third);
	assert_true(earlier == piece_of(second) && earlier != later);
	esk_arena_give_back(third);
	assert_true(is_mapped(later));
	esk_arena_clear(&arena);
	assert_false(is_mapped(later));
	esk_arena_give_back(second);
	assert_true(is_mapped(earlier));
	esk_arena_give_back(first);
	assert_false(is_mapped(earlier));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_taken_is_apart_and_stays_as_it_was_written),
		cmocka_unit_test(a_piece_has_limits),
		cmocka_unit_test(what_is_too_large_for_the_rest_of_a_piece_leaves_the_rest_to_others),
		cmocka_unit_test(a_piece_goes_with_the_last_of_what_lies_in_it),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
