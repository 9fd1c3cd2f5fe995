#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "synthetic.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { count = 40 };

typedef struct {
	eskel_library *library;
	int64_t keys[count];
} shelf;

static shelf make_shelf(void)
{
	shelf s = {0};
	assert_int_equal(eskel_library_new(&s.library), ESKEL_OK);
	for (size_t n = 0; n < count; n++) {
		eskel_signature *signature = synthetic_signature(n % 5, n, 0.2, 8);
		s.keys[n] = (int64_t)(7 * n % count + 1);
		assert_int_equal(eskel_library_add(s.library, s.keys[n], signature), ESKEL_OK);
		eskel_signature_free(signature);
	}
	return s;
}

typedef struct {
	double distances[count][count];
	atomic_int seen[count], calls;
	int most_calls;
} matrix;

static bool take(void *context, size_t row, const double *distances)
{
	matrix *m = context;
	memcpy(m->distances[row], distances, sizeof m->distances[row]);
	atomic_fetch_add(&m->seen[row], 1);
	return atomic_fetch_add(&m->calls, 1) < m->most_calls;
}

static void rows_are_those_of_the_matrix_in_any_number_of_threads(void **state)
{
	(void)state;
	shelf s = make_shelf();
	const eskel_distance_options distance = {.signature = ESKEL_SIGNATURE_PAPER, .size = ESKEL_SIZE_FREE};
	static double expected[count][count];
	assert_int_equal(
		eskel_library_distances(s.library, s.keys, count, s.keys, count, &distance, *expected), ESKEL_OK);
	static const uint32_t threads[] = {0, 1, 2, 3, 8, ESKEL_THREADS_ONLINE};
	for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
		static matrix m;
		m = (matrix){.most_calls = count};
		const eskel_rows_options options = {distance, threads[t], take, &m};
		assert_int_equal(eskel_library_rows(s.library, s.keys, count, &options), ESKEL_OK);
		assert_memory_equal(m.distances, expected, sizeof expected);
		for (size_t row = 0; row < count; row++)
			assert_int_equal(m.seen[row], 1);
	}
	eskel_library_free(s.library);
}

static void rows_can_be_stopped(void **state)
{
	(void)state;
	shelf s = make_shelf();
	static matrix m;
	m = (matrix){.most_calls = 3};
	assert_int_equal(
		eskel_library_rows(s.library, s.keys, count, &(eskel_rows_options){.each = take, .context = &m}),
		ESKEL_CANCELLED);
	assert_int_equal(m.calls, 4);
	eskel_library_free(s.library);
}

static void an_unknown_key_has_no_row(void **state)
{
	(void)state;
	shelf s = make_shelf();
	static matrix m;
	m = (matrix){.most_calls = count};
	s.keys[5] = 999;
	const eskel_rows_options options = {.threads = 2, .each = take, .context = &m};
	assert_int_equal(eskel_library_rows(s.library, s.keys, count, &options), ESKEL_NOT_FOUND);
	assert_int_equal(m.calls, 0);
	assert_int_equal(eskel_library_rows(s.library, s.keys, 0, &options), ESKEL_OK);
	eskel_library_free(s.library);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_are_those_of_the_matrix_in_any_number_of_threads),
		cmocka_unit_test(rows_can_be_stopped),
		cmocka_unit_test(an_unknown_key_has_no_row),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
