#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <stdlib.h>
#include <string.h>

#define ID "0123456789abcdef0123456789abcdef"

static void nothing_is_stored(eskel_api *api)
{
	uint64_t count = 1;
	assert_int_equal(eskel_store_count(eskel_api_store(api), &count, NULL), ESKEL_STORE_OK);
	assert_int_equal(count, 0);
	assert_int_equal(eskel_api_shape_count(api), 0);
}

static const struct {
	const char *method, *target, *says;
} queries[] = {
	{"GET", "/shapes?colour=red",
		"there is no query parameter \\\"colour\\\" here, expected class, side, subject, sex, "
		"age_min, age_max, attr.KEY, q, limit, cursor"},
	{"GET", "/healthz?x", "there is no query parameter \\\"x\\\", expected none here"},
	{"GET", "/shapes?Class=femur", "\\\"Class\\\""},
	{"GET", "/shapes?limit=0", "limit is \\\"0\\\", expected a whole number from 1 to"},
	{"GET", "/shapes?limit=1001", "limit is 1001, expected 1 to 1000"},
	{"GET", "/shapes?limit=", "limit is \\\"\\\""},
	{"GET", "/shapes?limit=+5", "limit is \\\" 5\\\""},
	{"GET", "/shapes?limit=99999999999999999999999", "expected a whole number"},
	{"GET", "/shapes?limit=3&limit=4", "limit is given twice, expected once"},
	{"GET", "/shapes?cursor=3", "cursor is \\\"3\\\", expected the next of an earlier answer"},
	{"GET", "/shapes?cursor=kffffffffffffffff", "cursor is"},
	{"GET", "/shapes?class=", "class is empty, expected 1 to 200 bytes of text"},
	{"GET", "/shapes?class=%28%29", "class is \\\"()\\\", expected a word"},
	{"GET", "/shapes?subject=%ff", "expected UTF-8 text without control characters"},
	{"GET", "/shapes?subject=a%0d%0ab", "expected UTF-8 text without control characters"},
	{"GET", "/shapes?side=L", "side is \\\"L\\\", expected left, right or none"},
	{"GET", "/shapes?sex=woman", "sex is \\\"woman\\\", expected female, male, F or M"},
	{"GET", "/shapes?age_min=old", "age_min is \\\"old\\\", expected years from 0 to 150"},
	{"GET", "/shapes?age_max=151", "expected years from 0 to 150"},
	{"GET", "/shapes?age_min=30&age_max=20", "age_min is 30, expected at most age_max, 20"},
	{"GET", "/shapes?attr.=x", "an attribute's key is empty"},
	{"GET", "/shapes?attr.a=1&attr.a=2", "attr.a is given twice"},
	{"GET", "/shapes?age=3", "there is no query parameter \\\"age\\\""},
	{"POST", "/shapes?label=0", "label is \\\"0\\\", expected all or a whole number that is not 0"},
	{"POST", "/shapes?label=x", "label is \\\"x\\\""},
	{"POST", "/shapes?label=2147483648", "label is \\\"2147483648\\\""},
	{"POST", "/shapes?label=1&label=01", "label 1 is given twice"},
	{"POST", "/shapes?label=all&label=2", "label=all means every label"},
	{"POST", "/shapes?label=2&label=all", "label=all means every label"},
	{"POST", "/shapes?label.x.name=a", "there is no query parameter \\\"label.x.name\\\""},
	{"POST", "/shapes?label.1.sex=F", "there is no query parameter \\\"label.1.sex\\\""},
	{"POST", "/shapes?label.9999999999.name=a", "the N of a label.N parameter is \\\"9999999999\\\""},
	{"POST", "/shapes?label.1.side=up", "label.1.side is \\\"up\\\""},
	{"POST", "/shapes?levels=0", "levels is \\\"0\\\", expected a whole number from 1 to 64"},
	{"POST", "/shapes?levels=65", "levels is \\\"65\\\""},
	{"POST", "/shapes?levels=1e1", "levels is \\\"1e1\\\""},
	{"POST", "/shapes?age=-1", "age is \\\"-1\\\""},
	{"POST", "/shapes?limit=3", "there is no query parameter \\\"limit\\\""},
	{"GET", "/shapes/" ID "?x=1", "expected none here"},
	{"GET", "/shapes/" ID "/signature?level=65", "level is \\\"65\\\", expected a whole number from 1 to 64"},
	{"GET", "/shapes/" ID "/signature?format=npy", "format is \\\"npy\\\", expected json or csv"},
	{"GET", "/shapes/" ID "/volume?format=mha", "format is \\\"mha\\\", expected nifti or nrrd"},
	{"GET", "/shapes/" ID "/volume?level=1", "there is no query parameter \\\"level\\\" here, expected format"},
	{"POST", "/shapes?as_said=1", "as_said is \\\"1\\\", expected false or true"},
	{"GET", "/recognize", "shape is missing, expected an id of 32 lower-case hexadecimal digits"},
	{"GET", "/recognize?shape=1", "shape is \\\"1\\\", expected an id"},
	{"GET", "/recognize?shape=" ID "&limit=101", "limit is 101, expected 1 to 100"},
	{"GET", "/recognize?shape=" ID "&mode=fast", "mode is \\\"fast\\\", expected exact or pruned"},
	{"GET", "/recognize?shape=" ID "&signature=esf", "expected log or paper"},
	{"GET", "/recognize?shape=" ID "&distance=far", "expected sum or level"},
	{"GET", "/recognize?shape=" ID "&metric=taxi", "expected manhattan, euclidean or root"},
	{"GET", "/recognize?shape=" ID "&scale=local", "expected none or neighbourhood"},
	{"GET", "/recognize?shape=" ID "&order=side", "expected distance or position"},
	{"GET", "/recognize?shape=" ID "&order=position&scale=neighbourhood",
		"order=position is given beside scale=neighbourhood, expected one of the two"},
	{"POST", "/check?order=position", "there is no query parameter \\\"order\\\""},
	{"GET", "/recognize?shape=" ID "&size=big", "expected fixed or free"},
	{"GET", "/recognize?shape=" ID "&explain=yes", "explain is \\\"yes\\\", expected false or true"},
	{"GET", "/recognize?shape=" ID "&level=4", "level is 4 without a use, expected distance=level or explain=true"},
	{"GET", "/recognize?shape=" ID "&label=1", "there is no query parameter \\\"label\\\""},
	{"POST", "/recognize?shape=" ID, "there is no query parameter \\\"shape\\\""},
	{"POST", "/recognize?limit=500", "limit is 500"},
	{"POST", "/recognize?levels=3", "there is no query parameter \\\"levels\\\""},
	{"POST", "/check?level=4", "level is 4 without a use, expected distance=level"},
	{"POST", "/check?limit=3", "there is no query parameter \\\"limit\\\""},
	{"POST", "/check?mode=fast", "mode is \\\"fast\\\", expected exact or pruned"},
	{"GET", "/distances?id=1", "id has \\\"1\\\", expected an id of 32 lower-case hexadecimal digits"},
	{"GET", "/distances?id=" ID ",", "id has \\\"\\\""},
	{"GET", "/distances?id=" ID ";" ID, "id has"},
	{"GET", "/distances?id=" ID "&class=femur", "id is given beside a filter, expected one of the two"},
	{"GET", "/distances?level=4", "level is 4 without a use, expected distance=level"},
	{"GET", "/distances?format=xml", "format is \\\"xml\\\", expected json, csv, npy or svg"},
	{"GET", "/distances?plot=map", "plot is given without a use, expected format=svg beside it"},
	{"GET", "/distances?format=svg&plot=pie", "plot is \\\"pie\\\", expected heatmap or map"},
	{"GET", "/distances?columns=some", "columns is \\\"some\\\", expected all"},
	{"GET", "/distances?columns=all&columns.class=femur",
		"columns are chosen in two ways, expected one of columns=all, columns.id and a filter"},
	{"GET", "/distances?columns.id=" ID "&columns.q=a", "columns are chosen in two ways"},
	{"GET", "/distances?columns.id=1", "columns.id has \\\"1\\\", expected an id"},
	{"GET", "/distances?columns.class=a&columns.class=b", "columns.class is given twice, expected once"},
	{"GET", "/distances?columns.age_min=5&columns.age_max=4",
		"columns.age_min is 5, expected at most columns.age_max, 4"},
	{"GET", "/distances?columns.level=4", "there is no query parameter \\\"columns.level\\\""},
	{"GET", "/shapes?columns.class=a", "there is no query parameter \\\"columns.class\\\""},
	{"GET", "/evaluation?leave_out=class", "leave_out is \\\"class\\\", expected shape or subject"},
	{"GET", "/evaluation?level=4", "level is 4 without a use, expected distance=level"},
	{"GET", "/evaluation?id=" ID, "there is no query parameter \\\"id\\\""},
	{"GET", "/distances?not.subject=a", "there is no query parameter \\\"not.subject\\\""},
};

/* Each of these is refused by its head alone, so that no body needs to be sent. */
static void a_wrong_query_is_refused_by_its_head(void **state)
{
	api_fixture *f = *state;
	for (size_t i = 0; i < sizeof queries / sizeof *queries; i++) {
		answer a = ask(f->api, &(question){.method = queries[i].method, .target = queries[i].target});
		print_message("%s %s\n", queries[i].method, queries[i].target);
		assert_says(&a, 400, queries[i].says);
		assert_string_equal(a.type, "application/problem+json");
		assert_string_equal(text_at(&a, "title"), "Bad Request");
		assert_true(a.early);
		answer_free(&a);
	}
	nothing_is_stored(f->api);
}

static void a_text_has_its_limit(void **state)
{
	api_fixture *f = *state;
	char text[202];
	memset(text, 'a', 201);
	text[201] = 0;
	answer long_name = get(f->api, "/shapes?subject=%s", text);
	assert_says(&long_name, 400, "subject has 201 bytes, expected at most 200");
	answer just = get(f->api, "/shapes?subject=%s", text + 1);
	assert_status(&just, 200);
	answer key = get(f->api, "/shapes?attr.%s=1", text + 136);
	assert_says(&key, 400, "an attribute's key has 65 bytes, expected at most 64");
	char *many = calloc(1, 65 * 16 + 16), *end = many + sprintf(many, "/shapes?");
	for (int i = 0; i < 65; i++)
		end += sprintf(end, "attr.k%d=1&", i);
	end[-1] = 0;
	answer attributes = get(f->api, "%s", many);
	assert_says(&attributes, 400, "attr.k64 is one attribute too many, expected at most 64");
	free(many);
	char *query = calloc(1, 5001 * 2 + 16);
	strcpy(query, "/shapes?");
	for (int i = 0; i < 5001; i++)
		strcpy(query + 8 + 2 * i, "a&");
	answer parameters = get(f->api, "%s", query);
	assert_says(&parameters, 400, "the query has 5001 parameters, expected at most 5000");
	free(query);
	answer_free(&parameters);
	answer_free(&long_name);
	answer_free(&just);
	answer_free(&key);
	answer_free(&attributes);
}

static void a_body_that_is_no_good_volume_is_refused(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(0, 0, 0);
	static const char *const targets[] = {"/shapes", "/recognize"};
	for (size_t i = 0; i < 2; i++) {
		answer empty = ask(f->api, &(question){.method = "POST", .target = targets[i]});
		assert_status(&empty, 422);
		answer html = ask(f->api,
			&(question){.target = targets[i], .body = "<html>no volume</html>", .size = 22, .piece = 3});
		assert_says(&html, 415, "Unsupported Media Type");
		assert_non_null(strstr(text_at(&html, "detail"), "NIfTI"));
		answer cut = ask(f->api, &(question){.target = targets[i], .body = file.bytes, .size = file.size - 1});
		assert_status(&cut, 422);
		uint8_t *more = calloc(1, file.size + 1);
		memcpy(more, file.bytes, file.size);
		answer trailing = ask(f->api, &(question){.target = targets[i], .body = more, .size = file.size + 1});
		assert_status(&trailing, 422);
		memset(more + 280, 0, 48); /* srow: a singular affine */
		answer singular = ask(f->api, &(question){.target = targets[i], .body = more, .size = file.size});
		assert_status(&singular, 422);
		free(more);
		answer_free(&empty);
		answer_free(&html);
		answer_free(&cut);
		answer_free(&trailing);
		answer_free(&singular);
	}
	nothing_is_stored(f->api);
	volume_free(&file);
}

static void an_empty_mask_is_refused(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_blobs(NULL, 0, 16);
	answer a = post_volume(f->api, &file, "/shapes");
	assert_status(&a, 422);
	nothing_is_stored(f->api);
	answer_free(&a);
	volume_free(&file);
}

static void a_label_that_is_not_there_is_named_with_those_that_are(void **state)
{
	api_fixture *f = *state;
	blob blobs[3] = {blob_of_family(0, 0), blob_of_family(0, 0), blob_of_family(0, 0)};
	for (int i = 0; i < 3; i++) {
		blobs[i].label = 3 * i + 1;
		blobs[i].centre[0] = 12 + 22 * i;
	}
	volume_file file = volume_of_blobs(blobs, 3, 72);
	static const struct {
		const char *query, *says;
	} cases[] = {
		{"label=2", "label 2 is not in the volume, which has 1, 4, 7"},
		{"label=1&label=4&label=-9", "label -9 is not in the volume, which has 1, 4, 7"},
		{"label.5.name=x", "label 5 is not in the volume"},
		{"label=all&label.5.name=x", "label 5 is not in the volume"},
		{"label=1&label.4.name=x", "label.4 is described, expected label=4 beside it"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = post_volume(f->api, &file, "/shapes?%s", cases[i].query);
		assert_says(&a, 422, cases[i].says);
		answer_free(&a);
		answer r = post_volume(f->api, &file, "/recognize?%s", cases[i].query);
		assert_says(&r, 422, cases[i].says);
		answer_free(&r);
		answer c = post_volume(f->api, &file, "/check?%s", cases[i].query);
		assert_says(&c, 422, cases[i].says);
		answer_free(&c);
	}
	nothing_is_stored(f->api);
	volume_free(&file);
}

static void an_unknown_shape_is_named(void **state)
{
	api_fixture *f = *state;
	static const struct {
		const char *method, *target;
	} cases[] = {
		{"GET", "/shapes/" ID},
		{"PATCH", "/shapes/" ID},
		{"DELETE", "/shapes/" ID},
		{"GET", "/shapes/" ID "/skeleton"},
		{"GET", "/shapes/" ID "/signature"},
		{"GET", "/recognize?shape=" ID},
		{"GET", "/distances?id=" ID},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = ask(f->api,
			&(question){.method = cases[i].method, .target = cases[i].target, .body = "{}", .size = 2});
		assert_says(&a, 404, "there is no shape " ID);
		answer_free(&a);
	}
}

static void a_body_has_its_limit(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(0, 0, 0);
	eskel_api *small = NULL;
	char path[300];
	snprintf(path, sizeof path, "%s/small", f->folder);
	const eskel_api_options options = {.most_body_bytes = file.size - 1};
	assert_int_equal(eskel_api_open(path, &options, &small, NULL), ESKEL_STORE_OK);
	answer told = ask(small, &(question){.target = "/shapes", .body = file.bytes, .size = file.size});
	assert_says(&told, 413, " bytes, expected at most ");
	assert_true(told.early);
	answer streamed = ask(small,
		&(question){
			.target = "/shapes", .body = file.bytes, .size = file.size, .piece = 1000, .chunked = true});
	assert_says(&streamed, 413, "the body has at least ");
	assert_false(streamed.early);
	nothing_is_stored(small);
	char *json = malloc(1 << 19);
	memset(json, ' ', 1 << 19);
	answer patch = ask(f->api, &(question){.method = "PATCH",
					   .target = "/shapes/" ID,
					   .body = json,
					   .size = 1 << 19,
					   .piece = 4096,
					   .chunked = true});
	assert_says(&patch, 413, "expected at most 262144");
	free(json);
	eskel_api_close(small);
	answer_free(&told);
	answer_free(&streamed);
	answer_free(&patch);
	volume_free(&file);
}

static void a_grid_and_its_labels_have_limits(void **state)
{
	api_fixture *f = *state;
	char path[300];
	snprintf(path, sizeof path, "%s/small", f->folder);
	eskel_api *small = NULL;
	const eskel_api_options options = {.most_voxels = 40 * 40 * 40, .most_labels = 1};
	assert_int_equal(eskel_api_open(path, &options, &small, NULL), ESKEL_STORE_OK);
	volume_file wide = volume_of_family(0, 0, 0);
	answer grid = post_volume(small, &wide, "/shapes");
	assert_status(&grid, 413);
	blob blobs[2] = {blob_of_family(0, 0), blob_of_family(0, 0)};
	blobs[1].label = 2;
	blobs[1].centre[0] = 8;
	volume_file two = volume_of_blobs(blobs, 2, 40);
	answer labels = post_volume(small, &two, "/shapes");
	assert_status(&labels, 413);
	nothing_is_stored(small);
	eskel_api_close(small);
	answer_free(&grid);
	answer_free(&labels);
	volume_free(&wide);
	volume_free(&two);
}

static void the_runs_of_a_volume_have_a_limit(void **state)
{
	api_fixture *f = *state;
	char path[300];
	snprintf(path, sizeof path, "%s/few", f->folder);
	eskel_api *few = NULL;
	assert_int_equal(eskel_api_open(path, &(eskel_api_options){.most_runs = 20}, &few, NULL), ESKEL_STORE_OK);
	volume_file file = volume_of_family(0, 0, 0);
	answer a = post_volume(few, &file, "/shapes");
	assert_says(&a, 413, "more than 20 runs");
	nothing_is_stored(few);
	eskel_api_close(few);
	answer_free(&a);
	volume_free(&file);
}

static void a_problem_echoes_no_control_characters(void **state)
{
	api_fixture *f = *state;
	answer a = get(f->api, "/shapes/%%1b%%5b2J%%ff%%c2%%9b");
	assert_says(&a, 404, "is no id");
	for (size_t i = 0; i + 1 < a.size; i++) /* all but the end of the line */
		assert_true((unsigned char)a.body[i] >= 0x20);
	assert_null(strstr(a.body, "\\u"));
	assert_null(strstr(a.body, "\xc2\x9b"));
	answer_free(&a);
	answer name = get(f->api, "/shapes?%%0a%%ff=1");
	assert_says(&name, 400, "there is no query parameter \\\"??\\\"");
	answer_free(&name);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_wrong_query_is_refused_by_its_head),
		api_test(a_text_has_its_limit),
		api_test(a_body_that_is_no_good_volume_is_refused),
		api_test(an_empty_mask_is_refused),
		api_test(a_label_that_is_not_there_is_named_with_those_that_are),
		api_test(an_unknown_shape_is_named),
		api_test(a_body_has_its_limit),
		api_test(a_grid_and_its_labels_have_limits),
		api_test(the_runs_of_a_volume_have_a_limit),
		api_test(a_problem_echoes_no_control_characters),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
