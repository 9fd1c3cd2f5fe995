#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "synthetic.h"

#include <stdlib.h>

enum { SHAPES = 90, CELLS = SHAPES * SHAPES };

typedef struct {
	eskel_library *library;
	int64_t keys[SHAPES], others[SHAPES];
	eskel_signature *signatures[SHAPES];
} fixture;

static int set_up(void **state)
{
	fixture *f = calloc(1, sizeof *f);
	*state = f;
	if (!f || eskel_library_new(&f->library))
		return -1;
	for (int i = 0; i < SHAPES; i++) {
		f->signatures[i] = synthetic_signature((uint64_t)i / 9, (uint64_t)i, 0.2, 10 + (uint32_t)i % 7);
		f->keys[i] = 7 + 3 * ((i * 37) % SHAPES);
	}
	for (int i = 0; i < SHAPES; i++) {
		f->others[i] = f->keys[SHAPES - 1 - i];
		if (eskel_library_add(f->library, f->keys[i], f->signatures[i]))
			return -1;
	}
	return 0;
}

static int tear_down(void **state)
{
	fixture *f = *state;
	for (int i = 0; i < SHAPES; i++)
		eskel_signature_free(f->signatures[i]);
	eskel_library_free(f->library);
	free(f);
	return 0;
}

/* The whole table in pieces of so many cells at most. */
static void take_all(eskel_distance_table *table, size_t piece, double *distances, size_t cells)
{
	size_t done = 0, count = 1;
	while (count > 0) {
		assert_int_equal(eskel_distance_table_next(table, piece, distances + done, &count), ESKEL_OK);
		assert_true(count <= piece);
		done += count;
		assert_true(done <= cells);
	}
	assert_int_equal(done, cells);
}

static void pieces_and_threads_do_not_show(void **state)
{
	const fixture *f = *state;
	static double got[CELLS], expected[CELLS];
	static const size_t pieces[] = {7, 64, 1000, SIZE_MAX};
	for (int same = 0; same < 2; same++) {
		const int64_t *columns = same ? f->keys : f->others;
		const size_t column_count = same ? SHAPES : 31;
		for (size_t i = 0; i < SHAPES; i++)
			for (size_t j = 0; j < column_count; j++)
				assert_int_equal(
					eskel_distance(f->signatures[i], f->signatures[same ? j : SHAPES - 1 - j], NULL,
						&expected[i * column_count + j], NULL, NULL),
					ESKEL_OK);
		for (size_t p = 0; p < sizeof pieces / sizeof *pieces; p++)
			for (uint32_t threads = 1; threads < 4; threads++)
				for (size_t kept = 0; kept < 2; kept++) {
					const eskel_distance_table_options options = {
						.threads = threads, .most_kept = kept};
					eskel_distance_table *table = NULL;
					assert_int_equal(eskel_distance_table_new(f->library, f->keys, SHAPES, columns,
								 column_count, &options, &table),
						ESKEL_OK);
					take_all(table, pieces[p], got, SHAPES * column_count);
					assert_memory_equal(got, expected, SHAPES * column_count * sizeof *got);
					eskel_distance_table_free(table);
				}
	}
}

static void a_shape_that_goes_stays_in_the_table(void **state)
{
	const fixture *f = *state;
	static double before[CELLS], after[CELLS];
	size_t count;
	eskel_distance_table *table = NULL;
	assert_int_equal(eskel_library_distances(f->library, f->keys, SHAPES, f->keys, SHAPES, NULL, before), ESKEL_OK);
	assert_int_equal(
		eskel_distance_table_new(f->library, f->keys, SHAPES, f->keys, SHAPES, NULL, &table), ESKEL_OK);
	assert_int_equal(eskel_distance_table_next(table, 5, after, &count), ESKEL_OK);
	assert_int_equal(count, 5);
	for (int i = 0; i < SHAPES; i++)
		assert_int_equal(eskel_library_remove(f->library, f->keys[i]), ESKEL_OK);
	take_all(table, 1000, after + 5, CELLS - 5);
	assert_memory_equal(before, after, sizeof before);
	eskel_distance_table_free(table);
	eskel_distance_table_free(NULL);
}

static void more_rows_than_a_piece_takes_come_in_several(void **state)
{
	const fixture *f = *state;
	enum { ROWS = 2500 };
	static int64_t rows[ROWS];
	static double got[ROWS];
	size_t count = 0;
	double expected;
	eskel_distance_table *table = NULL;
	for (int i = 0; i < ROWS; i++)
		rows[i] = f->keys[i % SHAPES];
	assert_int_equal(eskel_distance_table_new(f->library, rows, ROWS, f->keys, 1, NULL, &table), ESKEL_OK);
	assert_int_equal(eskel_distance_table_next(table, SIZE_MAX, got, &count), ESKEL_OK);
	assert_true(count > 0 && count < ROWS);
	take_all(table, SIZE_MAX, got + count, ROWS - count);
	for (size_t i = 0; i < ROWS; i++) {
		eskel_distance(f->signatures[i % SHAPES], f->signatures[0], NULL, &expected, NULL, NULL);
		assert_true(got[i] == expected);
	}
	eskel_distance_table_free(table);
}

static void what_cannot_be_a_table_is_refused(void **state)
{
	const fixture *f = *state;
	eskel_distance_table *table = NULL;
	size_t count = 1;
	const int64_t unknown = 1;
	assert_int_equal(eskel_distance_table_new(f->library, &unknown, 1, f->keys, 1, NULL, &table), ESKEL_NOT_FOUND);
	assert_int_equal(eskel_distance_table_new(f->library, f->keys, 1, f->keys, 1,
				 &(eskel_distance_table_options){.distance.level = 99}, &table),
		ESKEL_INVALID);
	assert_int_equal(
		eskel_distance_table_new(f->library, f->keys, SIZE_MAX, f->keys, 2, NULL, &table), ESKEL_INVALID);
	assert_null(table);
	assert_int_equal(eskel_distance_table_new(f->library, f->keys, 5, NULL, 0, NULL, &table), ESKEL_OK);
	assert_int_equal(eskel_distance_table_next(table, 9, NULL, &count), ESKEL_OK);
	assert_int_equal(count, 0);
	eskel_distance_table_free(table);
}

#define table_test(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
	const struct CMUnitTest tests[] = {
		table_test(pieces_and_threads_do_not_show),
		table_test(a_shape_that_goes_stays_in_the_table),
		table_test(more_rows_than_a_piece_takes_come_in_several),
		table_test(what_cannot_be_a_table_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
