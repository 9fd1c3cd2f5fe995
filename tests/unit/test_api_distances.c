#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void enroll_four(eskel_api *api, char ids[4][ESKEL_ID_SIZE])
{
	static const char *const names[] = {"femur_left", "%3Dcmd%28%22x%22%29", "a%2Cb%22c", NULL};
	for (unsigned i = 0; i < 4; i++) {
		char query[100];
		snprintf(query, sizeof query, "levels=12&subject=S%u%s%s", i % 2, names[i] ? "&name=" : "",
			names[i] ? names[i] : "");
		enroll_blob(api, 3 * i, 0, 0, query, ids[i]);
	}
}

static double cell(const answer *a, size_t i, size_t j)
{
	char path[40];
	snprintf(path, sizeof path, "distances.%zu.%zu", i, j);
	return number_at(a, path);
}

static void a_matrix_is_symmetric_with_a_zero_diagonal(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	answer a = get(f->api, "/distances");
	assert_status(&a, 200);
	assert_int_equal(json_array_size(at(&a, "distances")), 4);
	for (size_t i = 0; i < 4; i++) {
		char path[20];
		snprintf(path, sizeof path, "ids.%zu", i);
		assert_string_equal(text_at(&a, path), ids[i]);
		assert_true(cell(&a, i, i) == 0);
		for (size_t j = 0; j < i; j++)
			if (!(cell(&a, i, j) > 0) || fabs(cell(&a, i, j) - cell(&a, j, i)) > 1e-12)
				fail_msg("%zu,%zu: %.17g and %.17g", i, j, cell(&a, i, j), cell(&a, j, i));
	}
	assert_string_equal(text_at(&a, "names.0"), "femur_left");
	assert_null(text_at(&a, "names.3"));
	answer_free(&a);
}

static void a_matrix_and_a_recognition_agree(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	static const char *const kinds[] = {
		"", "signature=paper", "distance=level&level=5&metric=euclidean", "metric=root", "size=free"};
	for (size_t k = 0; k < 4; k++) {
		answer matrix = get(f->api, "/distances?id=%s,%s,%s,%s&%s", ids[2], ids[0], ids[1], ids[3], kinds[k]);
		answer nearest = get(f->api, "/recognize?shape=%s&mode=exact&%s", ids[2], kinds[k]);
		assert_status(&matrix, 200);
		assert_status(&nearest, 200);
		for (size_t i = 0; i < 3; i++) {
			char path[60];
			snprintf(path, sizeof path, "results.0.neighbours.%zu.id", i);
			const char *id = text_at(&nearest, path);
			snprintf(path, sizeof path, "results.0.neighbours.%zu.distance", i);
			double expected = number_at(&nearest, path);
			size_t column = strcmp(id, ids[0]) == 0 ? 1 : strcmp(id, ids[1]) == 0 ? 2 : 3;
			if (fabs(cell(&matrix, 0, column) - expected) > 1e-12 * expected)
				fail_msg(
					"%s: %.17g, recognised at %.17g", kinds[k], cell(&matrix, 0, column), expected);
		}
		answer_free(&matrix);
		answer_free(&nearest);
	}
}

static void a_filter_chooses_the_shapes(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	answer a = get(f->api, "/distances?subject=S1");
	assert_int_equal(json_array_size(at(&a, "ids")), 2);
	assert_string_equal(text_at(&a, "ids.0"), ids[1]);
	answer none = get(f->api, "/distances?subject=S7");
	assert_status(&none, 200);
	assert_int_equal(json_array_size(at(&none, "distances")), 0);
	answer_free(&a);
	answer_free(&none);
}

static void csv_quotes_names_and_defuses_formulas(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE], expected[400];
	enroll_four(f->api, ids);
	answer a = get(f->api, "/distances?format=csv&id=%s,%s,%s", ids[0], ids[1], ids[2]);
	assert_status(&a, 200);
	assert_string_equal(a.type, "text/csv; charset=utf-8");
	snprintf(expected, sizeof expected, "id,name,%s,%s,%s\r\n%s,\"femur_left\",0,", ids[0], ids[1], ids[2], ids[0]);
	assert_memory_equal(a.body, expected, strlen(expected));
	snprintf(expected, sizeof expected, "\r\n%s,\"'=cmd(\"\"x\"\")\",", ids[1]);
	assert_non_null(strstr(a.body, expected));
	snprintf(expected, sizeof expected, "\r\n%s,\"a,b\"\"c\",", ids[2]);
	assert_non_null(strstr(a.body, expected));
	assert_string_equal(a.body + a.size - 4, ",0\r\n");
	answer_free(&a);
}

static void the_format_is_chosen_by_query_or_accept(void **state)
{
	api_fixture *f = *state;
	static const struct {
		const char *target, *accept, *type;
	} cases[] = {
		{"/distances", NULL, "application/json"},
		{"/distances", "*/*", "application/json"},
		{"/distances", "text/csv", "text/csv; charset=utf-8"},
		{"/distances", "application/json, text/csv;q=0.5", "application/json"},
		{"/distances?format=json", "text/csv", "application/json"},
		{"/distances?format=csv", "application/json", "text/csv; charset=utf-8"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = ask(f->api, &(question){.target = cases[i].target,
					       .headers = {{cases[i].accept ? "Accept" : NULL, cases[i].accept}}});
		assert_status(&a, 200);
		assert_string_equal(a.type, cases[i].type);
		answer_free(&a);
	}
}

static void a_matrix_has_its_limit(void **state)
{
	api_fixture *f = *state;
	char path[300], ids[4][ESKEL_ID_SIZE];
	snprintf(path, sizeof path, "%s/small", f->folder);
	eskel_api *small = NULL;
	const eskel_api_options options = {.most_distances = 10};
	assert_int_equal(eskel_api_open(path, &options, &small, NULL), ESKEL_STORE_OK);
	enroll_four(small, ids);
	answer named = get(small, "/distances?id=%s,%s,%s,%s", ids[0], ids[1], ids[2], ids[3]);
	assert_says(&named, 413, "4 shapes are 16 distances, expected at most 10");
	answer all = get(small, "/distances");
	assert_says(&all, 413, "at least 4 shapes are at least 16 distances, expected at most 10");
	answer three = get(small, "/distances?id=%s,%s,%s", ids[0], ids[1], ids[2]);
	assert_status(&three, 200);
	eskel_api_close(small);
	answer_free(&named);
	answer_free(&all);
	answer_free(&three);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_matrix_is_symmetric_with_a_zero_diagonal),
		api_test(a_matrix_and_a_recognition_agree),
		api_test(a_filter_chooses_the_shapes),
		api_test(csv_quotes_names_and_defuses_formulas),
		api_test(the_format_is_chosen_by_query_or_accept),
		api_test(a_matrix_has_its_limit),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
