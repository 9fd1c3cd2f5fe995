#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
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
		{"/distances", "application/x-npy", "application/x-npy"},
		{"/distances", "application/octet-stream", "application/x-npy"},
		{"/distances", "image/svg+xml", "image/svg+xml"},
		{"/distances", "image/avif,image/svg+xml,image/*,*/*;q=0.8", "image/svg+xml"},
		{"/distances?plot=map", "image/svg+xml", "image/svg+xml"},
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

/* Two rows, and one column, two, or all of them. */
static void columns_are_chosen_as_rows_are(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	answer whole = get(f->api, "/distances");
	const struct {
		const char *query;
		size_t count, columns[4];
	} cases[] = {
		{"columns=all", 4, {0, 1, 2, 3}},
		{"columns.subject=S0", 2, {0, 2}},
		{"columns.q=femur", 1, {0}},
		{"columns.subject=S7", 0, {0}},
		{"columns.id=%s,%s", 2, {3, 0}},
	};
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		char columns[200];
		snprintf(columns, sizeof columns, "columns.id=%s,%s", ids[3], ids[0]);
		answer a = get(f->api, "/distances?subject=S1&%s", k == 4 ? columns : cases[k].query);
		assert_status(&a, 200);
		assert_int_equal(json_array_size(at(&a, "ids")), 2);
		assert_int_equal(json_array_size(at(&a, "columns.ids")), cases[k].count);
		assert_int_equal(json_array_size(at(&a, "distances")), 2);
		for (size_t i = 0; i < 2; i++)
			for (size_t j = 0; j < cases[k].count; j++) {
				char path[40];
				snprintf(path, sizeof path, "columns.ids.%zu", j);
				assert_string_equal(text_at(&a, path), ids[cases[k].columns[j]]);
				assert_true(cell(&a, i, j) == cell(&whole, 2 * i + 1, cases[k].columns[j]));
			}
		answer_free(&a);
	}
	answer csv = get(f->api, "/distances?format=csv&id=%s&columns.id=%s", ids[0], ids[3]);
	char expected[200];
	snprintf(expected, sizeof expected, "id,name,%s\r\n%s,\"femur_left\",0.", ids[3], ids[0]);
	assert_memory_equal(csv.body, expected, strlen(expected));
	answer_free(&csv);
	answer_free(&whole);
}

/* By the letter of NumPy's format 1.0; numpy.load is tried by the tests of the command line. */
static void npy_has_the_header_and_the_cells(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	answer json = get(f->api, "/distances"), npy = get(f->api, "/distances?format=npy");
	assert_status(&npy, 200);
	assert_string_equal(npy.type, "application/x-npy");
	assert_memory_equal(npy.body, "\x93NUMPY\x01\x00\x76\x00", 10);
	const char header[] = "{'descr': '<f8', 'fortran_order': False, 'shape': (4, 4), } ";
	assert_memory_equal(npy.body + 10, header, sizeof header - 1);
	assert_int_equal(npy.body[127], '\n');
	assert_int_equal(npy.size, 128 + 16 * 8);
	for (size_t i = 0; i < 4; i++)
		for (size_t j = 0; j < 4; j++) {
			double value;
			memcpy(&value, npy.body + 128 + (4 * i + j) * 8, sizeof value);
			assert_true(fabs(value - cell(&json, i, j)) <= 1e-14 * value);
		}
	answer_free(&json);
	answer_free(&npy);
}

/* Ids may be repeated: four shapes are a large matrix. */
static char *many_ids(const char ids[4][ESKEL_ID_SIZE], size_t count)
{
	char *text = calloc(count + 1, ESKEL_ID_SIZE);
	assert_non_null(text);
	for (size_t i = 0; i < count; i++) {
		memcpy(text + i * ESKEL_ID_SIZE, ids[i % 4], ESKEL_ID_SIZE - 1);
		text[(i + 1) * ESKEL_ID_SIZE - 1] = i + 1 < count ? ',' : 0;
	}
	return text;
}

static void a_large_matrix_is_streamed_and_is_the_same(void **state)
{
	api_fixture *f = *state;
	enum { COUNT = 202 };
	static const char *const formats[] = {"json", "npy", "csv"};
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	answer small = get(f->api, "/distances");
	assert_false(small.streamed);
	char *many = many_ids((const char(*)[ESKEL_ID_SIZE])ids, COUNT);
	for (size_t k = 0; k < 3; k++) {
		answer large = get(f->api, "/distances?format=%s&id=%s", formats[k], many);
		assert_status(&large, 200);
		assert_true(large.streamed);
		const char *row = large.body;
		for (size_t i = 0; i < COUNT; i++)
			for (size_t j = 0; j < COUNT; j++) {
				double value = 0, expected = cell(&small, i % 4, j % 4);
				if (k == 0)
					value = json_number_value(
						json_array_get(json_array_get(at(&large, "distances"), i), j));
				else if (k == 1)
					memcpy(&value, large.body + 128 + (i * COUNT + j) * 8, sizeof value);
				else {
					row = j == 0 ? strchr(strstr(row, "\r\n") + 35, '"') : row;
					row = strchr(j == 0 ? strstr(row, "\",") : row + 1, ',');
					value = strtod(row + 1, NULL);
				}
				if (fabs(value - expected) > 1e-14 * expected)
					fail_msg("%s %zu,%zu: %.17g, %.17g", formats[k], i, j, value, expected);
			}
		answer_free(&large);
	}
	free(many);
	answer_free(&small);
}

static size_t count_of(const answer *a, const char *text)
{
	size_t count = 0;
	for (const char *found = a->body; (found = strstr(found, text)); found++)
		count++;
	return count;
}

static void pictures_say_what_they_show(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	answer heatmap = get(f->api, "/distances?format=svg"), again = get(f->api, "/distances?format=svg");
	assert_status(&heatmap, 200);
	assert_string_equal(heatmap.type, "image/svg+xml");
	assert_string_equal(heatmap.body, again.body);
	assert_says(&heatmap, 200, "Distances between 4 shapes");
	assert_says(&heatmap, 200, ">a,b&quot;c</text>");
	assert_int_equal(count_of(&heatmap, "<title>"), 1 + 16 + 2 * 3);
	answer cross = get(f->api, "/distances?format=svg&subject=S1&columns=all");
	assert_says(&cross, 200, "Distances of 2 to 4 shapes");
	assert_int_equal(count_of(&cross, "<title>"), 1 + 8 + 1 + 3);
	answer map = get(f->api, "/distances?format=svg&plot=map");
	assert_says(&map, 200, "Map of 4 shapes");
	assert_says(&map, 200, "<title>=cmd(&quot;x&quot;)");
	assert_int_equal(count_of(&map, "<title>"), 1 + 4);
	answer two = get(f->api, "/distances?format=svg&plot=map&subject=S1&columns.subject=S0");
	assert_says(&two, 200, "Map of 2 and 2 other (hollow) shapes");
	for (int plot = 0; plot < 2; plot++) {
		answer none = get(f->api, "/distances?format=svg&subject=S7&plot=%s", plot ? "map" : "heatmap");
		answer one = get(f->api, "/distances?format=svg&q=femur&plot=%s", plot ? "map" : "heatmap");
		assert_says(&none, 200, "0 shapes");
		assert_says(&one, 200, "1 shape</title>");
		answer_free(&none);
		answer_free(&one);
	}
	answer_free(&heatmap);
	answer_free(&again);
	answer_free(&cross);
	answer_free(&map);
	answer_free(&two);
}

/* Beyond 128 x 128 cells only rows have titles. */
static void a_large_heatmap_is_drawn_in_stretches(void **state)
{
	api_fixture *f = *state;
	char ids[4][ESKEL_ID_SIZE];
	enroll_four(f->api, ids);
	char *many = many_ids((const char(*)[ESKEL_ID_SIZE])ids, 140);
	answer a = get(f->api, "/distances?format=svg&id=%s", many);
	assert_status(&a, 200);
	assert_int_equal(count_of(&a, "<title>"), 1 + 140 + 2 * 139);
	assert_true(a.size < 400000);
	free(many);
	answer_free(&a);
}

static void a_picture_and_a_side_have_their_limits(void **state)
{
	api_fixture *f = *state;
	char path[300], ids[4][ESKEL_ID_SIZE];
	snprintf(path, sizeof path, "%s/small", f->folder);
	eskel_api *small = NULL;
	const eskel_api_options options = {.most_distances = 10};
	assert_int_equal(eskel_api_open(path, &options, &small, NULL), ESKEL_STORE_OK);
	enroll_four(small, ids);
	answer all = get(small, "/distances?format=svg");
	assert_says(&all, 413, "a picture of 4 shapes needs 16 distances, expected at most 10");
	answer both = get(small, "/distances?format=svg&subject=S0&columns.subject=S1&plot=map");
	assert_says(&both, 413, "a picture of 4 shapes needs 16 distances");
	answer three = get(small, "/distances?format=svg&id=%s,%s,%s", ids[0], ids[1], ids[2]);
	assert_status(&three, 200);
	answer numbers = get(small, "/distances");
	assert_status(&numbers, 200);
	char *many = many_ids((const char(*)[ESKEL_ID_SIZE])ids, 100001);
	answer side = get(small, "/distances?id=%s", many);
	assert_says(&side, 413, "the matrix has 100001 shapes on a side, expected at most 100000");
	free(many);
	eskel_api_close(small);
	answer_free(&all);
	answer_free(&both);
	answer_free(&three);
	answer_free(&numbers);
	answer_free(&side);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_matrix_is_symmetric_with_a_zero_diagonal),
		api_test(a_matrix_and_a_recognition_agree),
		api_test(a_filter_chooses_the_shapes),
		api_test(csv_quotes_names_and_defuses_formulas),
		api_test(the_format_is_chosen_by_query_or_accept),
		api_test(columns_are_chosen_as_rows_are),
		api_test(npy_has_the_header_and_the_cells),
		api_test(a_large_matrix_is_streamed_and_is_the_same),
		api_test(pictures_say_what_they_show),
		api_test(a_large_heatmap_is_drawn_in_stretches),
		api_test(a_picture_and_a_side_have_their_limits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
