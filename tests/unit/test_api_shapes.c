#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void an_enrolled_shape_is_answered_in_full(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(11, 0, 0);
	answer a = post_volume(
		f->api, &file, "/shapes?name=Femur%%20(left)&subject=S1&age=59.5&sex=F&attr.scanner=CT&attr.kVp=120");
	assert_status(&a, 201);
	assert_string_equal(text_at(&a, "shapes.0.name"), "Femur (left)");
	assert_string_equal(text_at(&a, "shapes.0.class"), "femur");
	assert_string_equal(text_at(&a, "shapes.0.side"), "left");
	assert_string_equal(text_at(&a, "shapes.0.subject"), "S1");
	assert_string_equal(text_at(&a, "shapes.0.sex"), "female");
	assert_true(number_at(&a, "shapes.0.age") == 59.5);
	assert_string_equal(text_at(&a, "shapes.0.attributes.scanner"), "CT");
	assert_string_equal(text_at(&a, "shapes.0.attributes.kVp"), "120");
	assert_true(number_at(&a, "shapes.0.label") == 1);
	assert_true(number_at(&a, "shapes.0.levels") == 16);
	assert_true(number_at(&a, "shapes.0.voxels") == number_at(&a, "shapes.0.volume_mm3"));
	assert_int_equal(json_array_size(at(&a, "shapes.0.centre_mm")), 3);
	assert_int_equal(strlen(text_at(&a, "shapes.0.sha256")), 64);
	assert_memory_equal(text_at(&a, "shapes.0.sha256"), text_at(&a, "shapes.0.id"), 32);
	assert_int_equal(json_array_size(at(&a, "shapes.0.warnings")), 0);
	assert_string_equal(a.location, text_at(&a, "shapes.0.url"));

	answer stored = get(f->api, "%s", a.location);
	assert_status(&stored, 200);
	assert_true(json_equal(stored.json, at(&a, "shapes.0")));
	answer_free(&stored);
	answer_free(&a);
	volume_free(&file);
}

static void the_same_object_again_is_the_same_shape(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(0, 0, 0);
	answer first = post_volume(f->api, &file, "/shapes?name=talus");
	answer again = post_volume(f->api, &file, "/shapes?name=other&levels=3");
	assert_status(&first, 201);
	assert_status(&again, 200);
	assert_true(json_equal(first.json, again.json));
	assert_string_equal(first.location, again.location);
	assert_int_equal(eskel_api_shape_count(f->api), 1);
	answer_free(&first);
	answer_free(&again);
	volume_free(&file);
}

/* A 3D Slicer segmentation of three segments of 4 x 4 x 4 voxels. */
static volume_file segmentation(void)
{
	static const char header[] = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 14 6 6\nencoding: raw\n"
				     "space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
				     "Segment0_LabelValue:=1\nSegment0_Name:=Talus (L)\n"
				     "Segment1_LabelValue:=2\nSegment1_Name:=\xff cuboid\n"
				     "Segment2_LabelValue:=3\nSegment2_Name:=Segment_3\n\n";
	enum { nx = 14, ny = 6, nz = 6, header_size = sizeof header - 1 };
	volume_file file = {calloc(header_size + nx * ny * nz, 1), header_size + nx * ny * nz};
	assert_non_null(file.bytes);
	memcpy(file.bytes, header, header_size);
	for (int z = 1; z <= 4; z++)
		for (int y = 1; y <= 4; y++)
			for (int x = 1; x <= 12; x++)
				file.bytes[header_size + x + nx * (y + ny * z)] = (uint8_t)(1 + (x - 1) / 4);
	return file;
}

static void a_label_has_the_name_that_its_file_gives_it_unless_another_is_said(void **state)
{
	api_fixture *f = *state;
	volume_file file = segmentation();
	answer a = post_volume(f->api, &file, "/shapes?label=1&label=2&label=3&label.3.name=Navicular%%20right");
	assert_status(&a, 201);
	assert_string_equal(text_at(&a, "shapes.0.name"), "Talus (L)");
	assert_string_equal(text_at(&a, "shapes.0.class"), "talus");
	assert_string_equal(text_at(&a, "shapes.0.side"), "left");
	assert_string_equal(text_at(&a, "shapes.1.name"), "? cuboid");
	assert_string_equal(text_at(&a, "shapes.2.class"), "navicular");
	assert_string_equal(text_at(&a, "shapes.2.side"), "right");
	answer_free(&a);
	answer other = post_volume(f->api, &file, "/recognize?label=1&label.1.name=calcaneus");
	assert_status(&other, 200);
	answer_free(&other);
	volume_free(&file);
}

static void bytes_may_come_in_any_pieces(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(1, 0, 0);
	static const size_t pieces[] = {0, 1, 347, 4096};
	char first[ESKEL_ID_SIZE] = "";
	for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
		answer a = ask(f->api, &(question){.target = "/shapes",
					       .body = file.bytes,
					       .size = file.size,
					       .piece = pieces[i],
					       .chunked = i % 2});
		assert_status(&a, i == 0 ? 201 : 200);
		if (i == 0)
			strcpy(first, text_at(&a, "shapes.0.id"));
		assert_string_equal(text_at(&a, "shapes.0.id"), first);
		answer_free(&a);
	}
	volume_free(&file);
}

static void a_shape_that_is_posted_as_said_learns_nothing_from_names(void **state)
{
	api_fixture *f = *state;
	volume_file file = segmentation();
	answer a = post_volume(f->api, &file, "/shapes?label=1&label=2&as_said=true&label.2.name=left%%20cuboid");
	assert_status(&a, 201);
	assert_null(text_at(&a, "shapes.0.name"));
	assert_null(text_at(&a, "shapes.0.class"));
	assert_null(text_at(&a, "shapes.0.side"));
	assert_string_equal(text_at(&a, "shapes.1.name"), "left cuboid");
	assert_null(text_at(&a, "shapes.1.class"));
	assert_null(text_at(&a, "shapes.1.side"));
	answer_free(&a);
	volume_free(&file);
}

/* Deletes the shape, posts what its volume was answered as, and expects the same shape. */
static void assert_comes_back(eskel_api *api, const char *id, const char *format, const char *type)
{
	answer before = get(api, "/shapes/%s", id), file = get(api, "/shapes/%s/volume%s", id, format);
	assert_status(&file, 200);
	assert_string_equal(file.type, type);
	assert_true(file.streamed);
	char target[64];
	snprintf(target, sizeof target, "/shapes/%s", id);
	answer gone = ask(api, &(question){.method = "DELETE", .target = target});
	assert_status(&gone, 204);
	const volume_file bytes = {(uint8_t *)file.body, file.size};
	answer back = post_volume(api, &bytes, "/shapes?levels=5");
	assert_status(&back, 201);
	assert_string_equal(text_at(&back, "shapes.0.id"), id);
	assert_int_equal(json_array_size(at(&back, "shapes.0.warnings")), 0);
	static const char *const same[] = {"label", "voxels", "volume_mm3", "centre_mm", "levels", "sha256"};
	for (size_t i = 0; i < sizeof same / sizeof *same; i++)
		assert_true(json_equal(json_object_get(before.json, same[i]),
			json_object_get(json_array_get(at(&back, "shapes"), 0), same[i])));
	answer_free(&before);
	answer_free(&file);
	answer_free(&gone);
	answer_free(&back);
}

static void a_volume_that_is_posted_again_is_the_same_shape(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 3, 1, 0, "levels=5", id);
	assert_comes_back(f->api, id, "", "application/gzip");
	assert_comes_back(f->api, id, "?format=nifti", "application/gzip");
	assert_comes_back(f->api, id, "?format=nrrd", "application/octet-stream");
	answer none = get(f->api, "/shapes/00000000000000000000000000000000/volume");
	assert_says(&none, 404, "there is no shape 00000000000000000000000000000000");
	answer_free(&none);
}

static void a_signature_as_csv_has_a_row_a_class_of_every_level(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE], start[80];
	enroll_blob(f->api, 3, 1, 0, "levels=4", id);
	answer all = get(f->api, "/shapes/%s/signature?format=csv", id);
	answer one = get(f->api, "/shapes/%s/signature?format=csv&level=1", id);
	answer json = get(f->api, "/shapes/%s/signature?level=1", id);
	assert_status(&all, 200);
	assert_string_equal(all.type, "text/csv; charset=utf-8");
	size_t lines = 0;
	for (const char *c = all.body; (c = strchr(c, '\n')); c++)
		lines++;
	assert_int_equal(lines, 1 + 1 + 2 + 3 + 4);
	snprintf(start, sizeof start, "\r\n%s,1,0,%.9g,", id,
		json_real_value(json_array_get(json_array_get(at(&json, "rows"), 0), 0)));
	assert_non_null(strstr(one.body, start));
	assert_memory_equal(all.body, one.body, one.size);
	answer_free(&all);
	answer_free(&one);
	answer_free(&json);
}

/* Labels 1, 2 and 5, the last touching the border. */
static volume_file three_labels(void)
{
	const blob blobs[] = {
		{.label = 1, .length = 9, .width = 5, .knob = 4, .centre = {20, 14, 14}},
		{.label = 2, .length = 9, .width = 4, .knob = 4, .centre = {20, 44, 14}},
		{.label = 5, .length = 9, .width = 4, .knob = 3, .centre = {44, 44, 60}},
	};
	return volume_of_blobs(blobs, 3, 64);
}

static void every_label_becomes_a_shape_with_its_own_words(void **state)
{
	api_fixture *f = *state;
	volume_file file = three_labels();
	answer a = post_volume(f->api, &file,
		"/shapes?subject=S1&name=left%%20thing&label.2.name=talus_right&label.5.class=Cuboid&label.5.side="
		"none");
	assert_status(&a, 201);
	assert_null(a.location);
	assert_int_equal(json_array_size(at(&a, "shapes")), 3);
	assert_string_equal(text_at(&a, "shapes.0.class"), "thing");
	assert_string_equal(text_at(&a, "shapes.0.side"), "left");
	assert_string_equal(text_at(&a, "shapes.1.name"), "talus_right");
	assert_string_equal(text_at(&a, "shapes.1.class"), "talus");
	assert_string_equal(text_at(&a, "shapes.1.side"), "right");
	assert_string_equal(text_at(&a, "shapes.2.name"), "left thing");
	assert_string_equal(text_at(&a, "shapes.2.class"), "cuboid");
	assert_string_equal(text_at(&a, "shapes.2.side"), "none");
	assert_true(number_at(&a, "shapes.2.label") == 5);
	assert_string_equal(text_at(&a, "shapes.2.warnings.0.code"), "touches_border");
	assert_non_null(strstr(text_at(&a, "shapes.2.warnings.0.text"), "third high"));
	answer_free(&a);
	volume_free(&file);
}

static void only_the_labels_asked_for_are_enrolled(void **state)
{
	api_fixture *f = *state;
	volume_file file = three_labels();
	answer one = post_volume(f->api, &file, "/shapes?label=2");
	assert_status(&one, 201);
	assert_int_equal(json_array_size(at(&one, "shapes")), 1);
	assert_true(number_at(&one, "shapes.0.label") == 2);
	answer two = post_volume(f->api, &file, "/shapes?label=5&label=1");
	assert_status(&two, 201);
	assert_true(number_at(&two, "shapes.0.label") == 1);
	assert_true(number_at(&two, "shapes.1.label") == 5);
	answer rest = post_volume(f->api, &file, "/shapes?label=all");
	assert_status(&rest, 200);
	assert_int_equal(eskel_api_shape_count(f->api), 3);
	answer_free(&one);
	answer_free(&two);
	answer_free(&rest);
	volume_free(&file);
}

static void some_there_and_some_new_is_created(void **state)
{
	api_fixture *f = *state;
	volume_file file = three_labels();
	answer one = post_volume(f->api, &file, "/shapes?label=2&name=first");
	answer all = post_volume(f->api, &file, "/shapes?name=second");
	assert_status(&all, 201);
	assert_string_equal(text_at(&all, "shapes.0.name"), "second");
	assert_string_equal(text_at(&all, "shapes.1.name"), "first");
	assert_string_equal(text_at(&all, "shapes.2.name"), "second");
	answer_free(&one);
	answer_free(&all);
	volume_free(&file);
}

static void a_small_flat_object_is_taken_with_its_warnings(void **state)
{
	api_fixture *f = *state;
	/* so thin that its voxels lie in a plane, and so short that they are fewer than 16 */
	const blob plate = {.label = 1, .length = 4, .width = 1, .centre = {8, 8, 8}};
	volume_file file = volume_of_blobs(&plate, 1, 16);
	answer a = post_volume(f->api, &file, "/shapes");
	assert_status(&a, 201);
	assert_int_equal(json_array_size(at(&a, "shapes.0.warnings")), 3);
	assert_string_equal(text_at(&a, "shapes.0.warnings.0.code"), "few_voxels");
	char text[40];
	snprintf(text, sizeof text, "%.0f voxels", number_at(&a, "shapes.0.voxels"));
	assert_non_null(strstr(text_at(&a, "shapes.0.warnings.0.text"), text));
	assert_string_equal(text_at(&a, "shapes.0.warnings.1.code"), "flat");
	assert_string_equal(text_at(&a, "shapes.0.warnings.2.code"), "fewer_levels");
	snprintf(text, sizeof text, "%.0f levels, 16 were asked for", number_at(&a, "shapes.0.levels"));
	assert_non_null(strstr(text_at(&a, "shapes.0.warnings.2.text"), text));
	answer stored = get(f->api, "%s", a.location);
	assert_true(json_equal(stored.json, at(&a, "shapes.0")));
	answer_free(&stored);
	answer_free(&a);
	volume_free(&file);
}

static void levels_are_as_many_as_asked_for(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(2, 0, 0);
	answer a = post_volume(f->api, &file, "/shapes?levels=24");
	assert_status(&a, 201);
	assert_true(number_at(&a, "shapes.0.levels") == 24);
	answer s = get(f->api, "%s/signature?level=24", a.location);
	assert_status(&s, 200);
	assert_int_equal(json_array_size(at(&s, "rows")), 24);
	assert_int_equal(json_array_size(at(&s, "rows.0")), 5);
	answer deepest = get(f->api, "%s/signature", a.location);
	assert_true(json_equal(s.json, deepest.json));
	answer deeper = get(f->api, "%s/signature?level=25", a.location);
	assert_says(&deeper, 400, "level is 25, expected 1 to 24");
	answer_free(&a);
	answer_free(&s);
	answer_free(&deepest);
	answer_free(&deeper);
	volume_free(&file);
}

static void a_skeleton_is_a_tree_of_ids(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 1, 0, 0, "levels=6", id);
	answer a = get(f->api, "/shapes/%s/skeleton", id);
	assert_status(&a, 200);
	assert_int_equal(json_array_size(at(&a, "levels")), 6);
	size_t count = json_array_size(at(&a, "nodes")), i;
	json_t *nodes = at(&a, "nodes"), *node;
	assert_int_equal(count, 21);
	assert_true(json_is_null(at(&a, "levels.0.split_class")));
	json_array_foreach (nodes, i, node) {
		size_t j;
		json_t *child;
		assert_int_equal(json_integer_value(json_object_get(node, "id")), i);
		json_array_foreach (json_object_get(node, "children"), j, child) {
			const json_t *below = json_array_get(nodes, (size_t)json_integer_value(child));
			assert_int_equal(json_integer_value(json_object_get(below, "parent")), i);
			assert_int_equal(json_integer_value(json_object_get(below, "level")),
				json_integer_value(json_object_get(node, "level")) + 1);
		}
		const json_t *of_level =
			json_object_get(json_array_get(at(&a, "levels"),
						(size_t)json_integer_value(json_object_get(node, "level")) - 1),
				"nodes");
		assert_int_equal(json_integer_value(json_array_get(
					 of_level, (size_t)json_integer_value(json_object_get(node, "class")))),
			i);
	}
	answer_free(&a);
}

static void a_list_goes_on_page_by_page(void **state)
{
	api_fixture *f = *state;
	char ids[5][ESKEL_ID_SIZE], query[64];
	for (unsigned i = 0; i < 5; i++) {
		snprintf(query, sizeof query, "levels=2&class=%s&attr.n=%u", i == 3 ? "talus" : "Femur", i);
		enroll_blob(f->api, i, 0, 0, query, ids[i]);
	}
	answer first = get(f->api, "/shapes?limit=2&class=FEMUR");
	assert_status(&first, 200);
	assert_int_equal(json_array_size(at(&first, "shapes")), 2);
	assert_string_equal(text_at(&first, "shapes.1.id"), ids[1]);
	const char *next = text_at(&first, "next");
	char link[200];
	snprintf(link, sizeof link, "</shapes?limit=2&class=FEMUR&cursor=%s>; rel=\"next\"", next);
	assert_string_equal(first.link, link);
	answer second = get(f->api, "/shapes?limit=2&class=FEMUR&cursor=%s", next);
	assert_status(&second, 200);
	assert_string_equal(text_at(&second, "shapes.0.id"), ids[2]);
	assert_string_equal(text_at(&second, "shapes.1.id"), ids[4]);
	assert_true(json_is_null(at(&second, "next")));
	assert_null(second.link);
	answer_free(&first);
	answer_free(&second);
}

static void a_filter_leaves_what_fits(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 0, 0, 0, "levels=2&name=femur_left&subject=S1&age=20&sex=female&attr.scanner=CT", id);
	enroll_blob(f->api, 1, 0, 0, "levels=2&name=talus_right&subject=S2&age=40&sex=M&attr.scanner=MR", id);
	enroll_blob(f->api, 2, 0, 0, "levels=2", id);
	static const struct {
		const char *query;
		size_t count;
	} cases[] = {
		{"", 3},
		{"class=femur", 1},
		{"side=right", 1},
		{"side=none", 0},
		{"subject=S2", 1},
		{"sex=F", 1},
		{"age_min=20", 2},
		{"age_min=20.5", 1},
		{"age_max=39.9", 1},
		{"age_min=20&age_max=40", 2},
		{"attr.scanner=CT", 1},
		{"attr.scanner=CT&class=talus", 0},
		{"q=TALUS", 1},
		{"q=s1", 1},
		{"q=_", 2},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = get(f->api, "/shapes?%s", cases[i].query);
		assert_status(&a, 200);
		if (json_array_size(at(&a, "shapes")) != cases[i].count)
			fail_msg("%s leaves %zu, expected %zu", cases[i].query, json_array_size(at(&a, "shapes")),
				cases[i].count);
		answer_free(&a);
	}
}

static answer patch(eskel_api *api, const char *id, const char *json, const char *if_match)
{
	char target[64];
	snprintf(target, sizeof target, "/shapes/%s", id);
	question q = {.method = "PATCH",
		.target = target,
		.body = json,
		.size = strlen(json),
		.headers = {
			{"Content-Type", "application/merge-patch+json"}, {if_match ? "If-Match" : NULL, if_match}}};
	return ask(api, &q);
}

static void a_patch_changes_what_it_names(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 0, 0, 0, "levels=2&name=femur_left&subject=S1&age=20&attr.b=2&attr.c=3", id);
	answer before = get(f->api, "/shapes/%s", id);
	answer a = patch(f->api, id,
		"{\"side\":\"right\",\"age\":null,\"sex\":\"male\",\"class\":\"Os "
		"Coxae\",\"attributes\":{\"a\":\"1\",\"b\":null,"
		"\"c\":\"4\",\"d\":null}}",
		NULL);
	assert_status(&a, 200);
	assert_string_equal(text_at(&a, "name"), "femur_left");
	assert_string_equal(text_at(&a, "subject"), "S1");
	assert_string_equal(text_at(&a, "side"), "right");
	assert_string_equal(text_at(&a, "class"), "os_coxae");
	assert_string_equal(text_at(&a, "sex"), "male");
	assert_true(json_is_null(at(&a, "age")));
	assert_int_equal(json_object_size(at(&a, "attributes")), 2);
	assert_string_equal(text_at(&a, "attributes.a"), "1");
	assert_string_equal(text_at(&a, "attributes.c"), "4");
	assert_string_not_equal(a.etag, before.etag);
	answer after = get(f->api, "/shapes/%s", id);
	assert_true(json_equal(after.json, a.json));
	assert_string_equal(after.etag, a.etag);
	answer none = patch(
		f->api, id, "{\"attributes\":null,\"name\":null,\"side\":null,\"sex\":null,\"class\":null}", NULL);
	assert_status(&none, 200);
	assert_int_equal(json_object_size(at(&none, "attributes")), 0);
	assert_null(text_at(&none, "name"));
	assert_null(text_at(&none, "side"));
	answer_free(&before);
	answer_free(&a);
	answer_free(&after);
	answer_free(&none);
}

static void a_wrong_patch_changes_nothing(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 0, 0, 0, "levels=2&name=femur_left&attr.a=1", id);
	static const struct {
		const char *json;
		int status;
		const char *says;
	} cases[] = {
		{"", 400, "not JSON at line 1"},
		{"{\"name\":\"x\"", 400, "not JSON"},
		{"{\"name\":\"x\",\"name\":\"y\"}", 400, "duplicate"},
		{"[]", 400, "the body is an array, expected an object"},
		{"3", 400, "not JSON"},
		{"{\"colour\":\"red\"}", 422, "\\\"colour\\\" cannot be changed, expected name, class"},
		{"{\"id\":\"x\"}", 422, "cannot be changed"},
		{"{\"name\":3}", 422, "name is a number, expected a string or null"},
		{"{\"name\":\"\"}", 422, "name is empty"},
		{"{\"name\":\"a\\u0007\"}", 422, "control characters"},
		{"{\"class\":\"--\"}", 422, "expected a word"},
		{"{\"side\":\"up\"}", 422, "side is \\\"up\\\", expected left, right or none"},
		{"{\"side\":true}", 422, "side is true, expected"},
		{"{\"sex\":\"x\"}", 422, "expected female, male, F or M"},
		{"{\"age\":\"59\"}", 422, "age is a string, expected a number or null"},
		{"{\"age\":-1}", 422, "age is -1, expected years from 0 to 150"},
		{"{\"age\":151}", 422, "age is 151"},
		{"{\"attributes\":[]}", 422, "attributes is an array, expected an object of strings"},
		{"{\"attributes\":{\"a\":1}}", 422, "a is a number, expected a string or null"},
		{"{\"attributes\":{\"\":\"x\"}}", 422, "key is empty"},
		{"{\"subject\":\"S9\",\"age\":200}", 422, "age is 200"},
	};
	answer before = get(f->api, "/shapes/%s", id);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = patch(f->api, id, cases[i].json, NULL);
		assert_says(&a, cases[i].status, cases[i].says);
		assert_string_equal(a.type, "application/problem+json");
		answer after = get(f->api, "/shapes/%s", id);
		assert_true(json_equal(before.json, after.json));
		assert_string_equal(before.etag, after.etag);
		answer_free(&after);
		answer_free(&a);
	}
	answer_free(&before);
}

static void a_change_of_a_changed_shape_is_refused(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE], target[64], list[128];
	enroll_blob(f->api, 0, 0, 0, "levels=2", id);
	snprintf(target, sizeof target, "/shapes/%s", id);
	answer first = get(f->api, "%s", target);
	answer good = patch(f->api, id, "{\"name\":\"a\"}", first.etag);
	assert_status(&good, 200);
	answer late = patch(f->api, id, "{\"name\":\"b\"}", first.etag);
	assert_says(&late, 412, "the shape has changed since it was read");
	snprintf(list, sizeof list, "W/%s", good.etag);
	answer weak = patch(f->api, id, "{\"name\":\"b\"}", list);
	assert_status(&weak, 412);
	answer late_delete =
		ask(f->api, &(question){.method = "DELETE", .target = target, .headers = {{"If-Match", first.etag}}});
	assert_status(&late_delete, 412);
	snprintf(list, sizeof list, "\"x\", %s", good.etag);
	answer listed = patch(f->api, id, "{\"name\":\"c\"}", list);
	assert_status(&listed, 200);
	answer any = patch(f->api, id, "{\"name\":\"d\"}", "*");
	assert_status(&any, 200);
	answer fresh_delete =
		ask(f->api, &(question){.method = "DELETE", .target = target, .headers = {{"If-Match", any.etag}}});
	assert_status(&fresh_delete, 204);
	answer_free(&first);
	answer_free(&good);
	answer_free(&late);
	answer_free(&weak);
	answer_free(&late_delete);
	answer_free(&listed);
	answer_free(&any);
	answer_free(&fresh_delete);
}

static void a_shape_that_is_known_is_not_sent_again(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE], target[64], weak[64];
	enroll_blob(f->api, 0, 0, 0, "levels=2", id);
	snprintf(target, sizeof target, "/shapes/%s", id);
	answer first = get(f->api, "%s", target);
	snprintf(weak, sizeof weak, "\"x\" , W/%s", first.etag);
	const char *const known[] = {first.etag, weak, "*"};
	for (size_t i = 0; i < 3; i++) {
		answer a = ask(f->api, &(question){.target = target, .headers = {{"If-None-Match", known[i]}}});
		assert_status(&a, 304);
		assert_int_equal(a.size, 0);
		assert_string_equal(a.etag, first.etag);
		answer_free(&a);
	}
	answer other = ask(f->api, &(question){.target = target, .headers = {{"if-none-match", "\"0-0\""}}});
	assert_status(&other, 200);
	answer_free(&other);
	answer_free(&first);
}

static void a_deleted_shape_is_gone_and_may_come_back(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE], again[ESKEL_ID_SIZE], target[64];
	enroll_blob(f->api, 0, 0, 0, "levels=2", id);
	snprintf(target, sizeof target, "/shapes/%s", id);
	answer first = get(f->api, "%s", target);
	answer gone = ask(f->api, &(question){.method = "DELETE", .target = target});
	assert_status(&gone, 204);
	assert_int_equal(gone.size, 0);
	assert_int_equal(eskel_api_shape_count(f->api), 0);
	static const char *const paths[] = {"", "/skeleton", "/signature"};
	for (size_t i = 0; i < 3; i++) {
		answer missing = get(f->api, "%s%s", target, paths[i]);
		assert_says(&missing, 404, id);
		answer_free(&missing);
	}
	answer twice = ask(f->api, &(question){.method = "DELETE", .target = target});
	assert_says(&twice, 404, "there is no shape");
	enroll_blob(f->api, 0, 0, 0, "levels=2", again);
	assert_string_equal(id, again);
	answer back = get(f->api, "%s", target);
	assert_string_not_equal(back.etag, first.etag);
	answer_free(&first);
	answer_free(&gone);
	answer_free(&twice);
	answer_free(&back);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(an_enrolled_shape_is_answered_in_full),
		api_test(the_same_object_again_is_the_same_shape),
		api_test(a_label_has_the_name_that_its_file_gives_it_unless_another_is_said),
		api_test(a_shape_that_is_posted_as_said_learns_nothing_from_names),
		api_test(a_volume_that_is_posted_again_is_the_same_shape),
		api_test(a_signature_as_csv_has_a_row_a_class_of_every_level),
		api_test(bytes_may_come_in_any_pieces),
		api_test(every_label_becomes_a_shape_with_its_own_words),
		api_test(only_the_labels_asked_for_are_enrolled),
		api_test(some_there_and_some_new_is_created),
		api_test(a_small_flat_object_is_taken_with_its_warnings),
		api_test(levels_are_as_many_as_asked_for),
		api_test(a_skeleton_is_a_tree_of_ids),
		api_test(a_list_goes_on_page_by_page),
		api_test(a_filter_leaves_what_fits),
		api_test(a_patch_changes_what_it_names),
		api_test(a_wrong_patch_changes_nothing),
		api_test(a_change_of_a_changed_shape_is_refused),
		api_test(a_shape_that_is_known_is_not_sent_again),
		api_test(a_deleted_shape_is_gone_and_may_come_back),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
