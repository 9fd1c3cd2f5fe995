/* Meshes, ellipsoids and levels of detail of stored shapes. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"
#include "store_sample.h"

#include <dirent.h>
#include <pthread.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
	api_fixture *f;
	char id[ESKEL_ID_SIZE];
} shape;

static shape enroll(void **state)
{
	shape s = {.f = *state};
	enroll_blob(s.f->api, 3, 0, 0, "name=blob", s.id);
	return s;
}

static answer get_mesh(const shape *s, const char *query)
{
	return get(s->f->api, "/shapes/%s/mesh%s", s->id, query);
}

static answer get_with(const shape *s, const char *query, eskel_field first, eskel_field second)
{
	char target[300];
	snprintf(target, sizeof target, "/shapes/%s/mesh%s", s->id, query);
	return ask(s->f->api, &(question){.target = target, .headers = {first, second}});
}

/* Files in the folder of meshes. */
static size_t kept(const api_fixture *f)
{
	char *path = scratch_path(f->folder, "shapes.eskel-meshes");
	size_t count = 0;
	DIR *folder = opendir(path);
	assert_non_null(folder);
	for (struct dirent *entry; (entry = readdir(folder));)
		count += entry->d_name[0] != '.';
	closedir(folder);
	free(path);
	return count;
}

static uint32_t little_endian(const char *bytes)
{
	const uint8_t *b = (const uint8_t *)bytes;
	return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void a_mesh_comes_in_each_format(void **state)
{
	const shape s = enroll(state);
	static const struct {
		const char *query, *type, *begins;
	} cases[] = {
		{"", "model/gltf-binary", "glTF"},
		{"?format=glb&frame=lps", "model/gltf-binary", "glTF"},
		{"?format=stl", "model/stl", ""},
		{"?format=ply", "application/ply", "ply\n"},
		{"?format=obj", "model/obj", "#"},
		{"?format=obj&source=voxels", "model/obj", "#"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer first = get_mesh(&s, cases[i].query), second = get_mesh(&s, cases[i].query);
		assert_status(&first, 200);
		assert_string_equal(first.type, cases[i].type);
		assert_memory_equal(first.body, cases[i].begins, strlen(cases[i].begins));
		assert_string_equal(first.caching, "private, max-age=31536000, immutable");
		assert_false(first.streamed);
		assert_true(second.streamed); /* from its file */
		assert_string_equal(first.etag, second.etag);
		assert_int_equal(first.size, second.size);
		assert_memory_equal(first.body, second.body, first.size);
		assert_int_equal(kept(s.f), i + 1);
		answer_free(&first);
		answer_free(&second);
	}
}

static void a_finer_step_has_more_triangles_and_a_level_is_another_surface(void **state)
{
	const shape s = enroll(state);
	answer coarse = get_mesh(&s, "?format=stl&step=2"), fine = get_mesh(&s, "?format=stl&step=1"),
	       one = get_mesh(&s, "?format=stl&step=1&level=1"),
	       joined = get_mesh(&s, "?format=stl&step=1&compose=union");
	const uint32_t coarse_count = little_endian(coarse.body + 80), fine_count = little_endian(fine.body + 80);
	assert_int_equal(coarse.size, 84 + 50 * coarse_count);
	assert_in_range(fine_count, 3 * coarse_count, 6 * coarse_count);
	assert_string_not_equal(fine.etag, one.etag);
	assert_string_not_equal(fine.etag, joined.etag);
	assert_true(fine.size != one.size && fine.size != joined.size);
	answer_free(&coarse);
	answer_free(&fine);
	answer_free(&one);
	answer_free(&joined);
}

static void who_has_it_is_told_so_before_it_is_made(void **state)
{
	const shape s = enroll(state);
	answer a = get_mesh(&s, "?step=1");
	char *path = scratch_path(s.f->folder, "shapes.eskel-meshes");
	answer same = get_with(&s, "?step=1", (eskel_field){"If-None-Match", a.etag}, (eskel_field){0});
	assert_status(&same, 304);
	assert_string_equal(same.etag, a.etag);
	assert_int_equal(same.size, 0);
	const size_t before = kept(s.f);
	answer_free(&same);
	same = get_with(&s, "?step=1.5", (eskel_field){"If-None-Match", a.etag}, (eskel_field){0});
	assert_status(&same, 200);
	answer any = get_with(&s, "?step=1.25", (eskel_field){"If-None-Match", "*"}, (eskel_field){0});
	assert_status(&any, 304);
	assert_int_equal(kept(s.f), before + 1);
	answer_free(&a);
	answer_free(&same);
	answer_free(&any);
	free(path);
}

static void parts_are_parts_of_the_whole(void **state)
{
	const shape s = enroll(state);
	for (int again = 0; again < 2; again++) { /* once from memory, once from the file */
		answer part = get_with(&s, "?step=1", (eskel_field){"Range", "bytes=100-299"}, (eskel_field){0});
		answer whole = get_mesh(&s, "?step=1");
		char expected[60];
		snprintf(expected, sizeof expected, "bytes 100-299/%zu", whole.size);
		assert_status(&part, 206);
		assert_string_equal(part.part, expected);
		assert_string_equal(part.etag, whole.etag);
		assert_int_equal(part.size, 200);
		assert_memory_equal(part.body, whole.body + 100, 200);
		answer other = get_with(&s, "?step=1", (eskel_field){"Range", "bytes=100-299"},
			(eskel_field){"If-Range", "\"another\""});
		assert_status(&other, 200);
		answer same = get_with(
			&s, "?step=1", (eskel_field){"Range", "bytes=-7"}, (eskel_field){"If-Range", whole.etag});
		assert_status(&same, 206);
		assert_memory_equal(same.body, whole.body + whole.size - 7, 7);
		answer behind = get_with(&s, "?step=1", (eskel_field){"Range", "bytes=999999999-"}, (eskel_field){0});
		assert_says(&behind, 416, "expected to begin before byte");
		snprintf(expected, sizeof expected, "bytes */%zu", whole.size);
		assert_string_equal(behind.part, expected);
		answer_free(&part);
		answer_free(&whole);
		answer_free(&other);
		answer_free(&same);
		answer_free(&behind);
	}
}

static void a_mesh_goes_with_its_shape(void **state)
{
	const shape s = enroll(state);
	char other[ESKEL_ID_SIZE], target[64];
	enroll_blob(s.f->api, 8, 0, 0, "name=other", other);
	answer a = get_mesh(&s, ""), b = get(s.f->api, "/shapes/%s/mesh", other);
	assert_int_equal(kept(s.f), 2);
	snprintf(target, sizeof target, "/shapes/%s", s.id);
	answer gone = ask(s.f->api, &(question){.method = "DELETE", .target = target});
	assert_status(&gone, 204);
	assert_int_equal(kept(s.f), 1);
	answer unknown = get_with(&s, "", (eskel_field){"If-None-Match", a.etag}, (eskel_field){0});
	assert_says(&unknown, 404, "there is no shape");
	answer_free(&a);
	answer_free(&b);
	answer_free(&gone);
	answer_free(&unknown);
}

static void ellipsoids_are_those_of_the_skeleton(void **state)
{
	const shape s = enroll(state);
	answer skeleton = get(s.f->api, "/shapes/%s/skeleton", s.id);
	for (unsigned level = 1; level <= 3; level++) {
		answer blend = get(s.f->api, "/shapes/%s/ellipsoids?level=%u", s.id, level);
		answer joined = get(s.f->api, "/shapes/%s/ellipsoids?level=%u&compose=union", s.id, level);
		assert_status(&blend, 200);
		assert_true(number_at(&blend, "level") == level);
		assert_string_equal(text_at(&joined, "compose"), "union");
		assert_int_equal(json_array_size(at(&blend, "ellipsoids")), level);
		for (unsigned i = 0; i < level; i++) {
			char path[60], other[60];
			const unsigned node = level * (level - 1) / 2 + i;
			for (unsigned axis = 0; axis < 3; axis++) {
				snprintf(path, sizeof path, "ellipsoids.%u.centre_mm.%u", i, axis);
				snprintf(other, sizeof other, "nodes.%u.centre_mm.%u", node, axis);
				assert_true(fabs(number_at(&blend, path) - number_at(&skeleton, other)) < 1e-9);
			}
			snprintf(path, sizeof path, "ellipsoids.%u.radii_mm.2", i);
			snprintf(other, sizeof other, "nodes.%u.eigenvalues_mm2.0", node);
			const double sigma = sqrt(number_at(&skeleton, other));
			const double gamma = level == 1 ? sqrt(5) : 2;
			assert_true(fabs(number_at(&blend, path) / (gamma * sigma) - 1) < 1e-9);
			assert_true(fabs(number_at(&joined, path) / (sqrt(5) * sigma) - 1) < 1e-9);
		}
		answer_free(&blend);
		answer_free(&joined);
	}
	answer deepest = get(s.f->api, "/shapes/%s/ellipsoids", s.id);
	assert_int_equal(json_array_size(at(&deepest, "ellipsoids")), 16);
	answer_free(&deepest);
	answer_free(&skeleton);
}

static void levels_of_detail_are_staircases(void **state)
{
	const shape s = enroll(state);
	answer table = get(s.f->api, "/shapes/%s/levels-of-detail", s.id), usual = get_mesh(&s, "");
	double from = -1, step = 0, level = 64;
	size_t size = SIZE_MAX;
	assert_status(&table, 200);
	assert_true(number_at(&table, "details.0.from_mm") == 0);
	for (int i = 0; i < 4; i++) {
		char path[40];
		snprintf(path, sizeof path, "details.%d.from_mm", i);
		assert_true(number_at(&table, path) > from);
		from = number_at(&table, path);
		snprintf(path, sizeof path, "details.%d.step_mm", i);
		assert_true(number_at(&table, path) > step);
		step = number_at(&table, path);
		snprintf(path, sizeof path, "details.%d.level", i);
		assert_true(number_at(&table, path) <= level);
		level = number_at(&table, path);
		snprintf(path, sizeof path, "details.%d.url", i);
		answer mesh = get(s.f->api, "%s", text_at(&table, path));
		assert_status(&mesh, 200);
		assert_true(mesh.size < size);
		size = mesh.size;
		if (i == 0)
			assert_string_equal(mesh.etag, usual.etag);
		answer_free(&mesh);
	}
	answer_free(&table);
	answer_free(&usual);
}

static void a_distance_chooses_its_row_of_the_table(void **state)
{
	const shape s = enroll(state);
	answer table = get(s.f->api, "/shapes/%s/levels-of-detail", s.id);
	for (int i = 0; i < 4; i++) {
		char path[40], query[60];
		snprintf(path, sizeof path, "details.%d.from_mm", i);
		const double from = number_at(&table, path);
		snprintf(path, sizeof path, "details.%d.url", i);
		answer row = get(s.f->api, "%s", text_at(&table, path));
		const double distances[] = {from, from + 0.001, i < 3 ? 2 * (from > 0 ? from : 1) - 0.5 : 1e9};
		for (int d = 0; d < 3; d++) {
			snprintf(query, sizeof query, "?distance=%.6f", distances[d]);
			answer far = get_mesh(&s, query);
			assert_status(&far, 200);
			if (strcmp(far.etag, row.etag) != 0)
				fail_msg("%s is not row %d", query, i);
			answer_free(&far);
		}
		answer_free(&row);
	}
	assert_int_equal(kept(s.f), 4);
	answer_free(&table);
}

static void *ask_for_mesh(void *context)
{
	answer a = get_mesh(context, "?format=obj");
	const bool expected = a.status == 200 || a.status == 404;
	answer_free(&a);
	return expected ? NULL : context;
}

static void a_mesh_that_is_made_while_its_shape_goes_is_not_kept(void **state)
{
	for (long delay = 0; delay < 10; delay++) {
		shape s = enroll(state);
		char target[64];
		pthread_t thread;
		void *wrong = NULL;
		snprintf(target, sizeof target, "/shapes/%s", s.id);
		assert_int_equal(pthread_create(&thread, NULL, ask_for_mesh, &s), 0);
		nanosleep(&(struct timespec){.tv_nsec = 1000000 * delay}, NULL);
		answer gone = ask(s.f->api, &(question){.method = "DELETE", .target = target});
		assert_status(&gone, 204);
		assert_int_equal(pthread_join(thread, &wrong), 0);
		assert_null(wrong);
		assert_int_equal(kept(s.f), 0);
		answer_free(&gone);
	}
}

static void what_cannot_be_drawn_is_refused(void **state)
{
	const shape s = enroll(state);
	static const struct {
		const char *query;
		int status;
		const char *says;
	} cases[] = {
		{"?level=17", 400, "level is 17, expected 1 to 16"},
		{"?level=65", 400, "level"},
		{"?step=0", 400, "step is \\\"0\\\", expected millimetres"},
		{"?step=-1", 400, "step"},
		{"?step=1e3", 400, "step"},
		{"?step=1000001", 400, "step"},
		{"?format=json", 400, "expected glb, stl, ply or obj"},
		{"?primitive=deformed", 404, "no surface of the primitive deformed was fitted to level 16"},
		{"?primitive=deformed&compose=blend", 400, "it is composed as it was fitted"},
		{"?source=voxels&primitive=ellipsoid", 400, "beside source=voxels"},
		{"?frame=xyz", 400, "expected ras or lps"},
		{"?compose=sum", 400, "expected blend or union"},
		{"?distance=500&level=2", 400, "distance is given beside level or step"},
		{"?distance=500&step=1", 400, "distance is given beside level or step"},
		{"?distance=-1", 400, "distance is \\\"-1\\\", expected millimetres, 0 to 1000000000"},
		{"?distance=sum", 400, "expected millimetres"},
		{"?distance=1000000001", 400, "expected millimetres"},
		{"?distance=0&primitive=deformed", 404, "no surface of the primitive deformed was fitted to level"},
		{"?source=voxels&distance=500", 400, "beside source=voxels"},
		{"?source=voxels&step=1", 400, "beside source=voxels"},
		{"?source=voxels&compose=blend", 400, "beside source=voxels"},
		{"?format/mesh=glb", 400, "expected level, step, distance, primitive, compose, format, frame, source"},
		{"?step=0.001", 413, "triangles"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = get_mesh(&s, cases[i].query);
		assert_says(&a, cases[i].status, cases[i].says);
		answer_free(&a);
	}
	answer unknown = get(s.f->api, "/shapes/%032d/mesh", 7);
	assert_says(&unknown, 404, "there is no shape");
	assert_int_equal(kept(s.f), 0);
	answer_free(&unknown);
}

/* ---- reconstructions */

static answer post_reconstruction(const shape *s, const char *query)
{
	char target[200];
	snprintf(target, sizeof target, "/shapes/%s/reconstruction%s", s->id, query);
	return ask(s->f->api, &(question){.method = "POST", .target = target});
}

/* Waits for the job to end; its state. */
static answer wait_for(eskel_api *api, const char *url)
{
	for (;;) {
		answer a = get(api, "%s", url);
		assert_status(&a, 200);
		if (strcmp(text_at(&a, "state"), "done") == 0 || strcmp(text_at(&a, "state"), "failed") == 0)
			return a;
		answer_free(&a);
		nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
	}
}

static void reconstruct(const shape *s, const char *query)
{
	answer begun = post_reconstruction(s, query);
	assert_status(&begun, 202);
	assert_string_equal(begun.location, text_at(&begun, "url"));
	answer ended = wait_for(s->f->api, begun.location);
	assert_string_equal(text_at(&ended, "state"), "done");
	answer_free(&begun);
	answer_free(&ended);
}

static void a_fit_is_a_job_and_is_stored(void **state)
{
	const shape s = enroll(state);
	answer none = get(s.f->api, "/shapes/%s/reconstruction?level=2", s.id);
	assert_says(&none, 404, "expected a POST to its reconstruction before");
	answer plain = get_mesh(&s, "?level=2&step=1");
	reconstruct(&s, "?level=2");
	answer fitted = get(s.f->api, "/shapes/%s/reconstruction?level=2", s.id);
	assert_status(&fitted, 200);
	assert_string_equal(text_at(&fitted, "method"), "joint");
	assert_string_equal(text_at(&fitted, "primitive"), "deformed");
	assert_int_equal(json_array_size(at(&fitted, "primitives")), 2);
	assert_int_equal(json_array_size(at(&fitted, "primitives.1.modes")), ESKEL_MODE_COUNT);
	assert_true(number_at(&fitted, "after.mean_error_mm") < number_at(&fitted, "before.mean_error_mm"));
	assert_true(number_at(&fitted, "bytes.volume_ratio") > 0.5);
	answer jobs = get(s.f->api, "/jobs"), result = get(s.f->api, "%s/result", text_at(&jobs, "jobs.0.url"));
	assert_true(json_equal(result.json, fitted.json));
	answer mesh = get_mesh(&s, "?level=2&step=1&primitive=deformed");
	assert_status(&mesh, 200);
	assert_string_equal(mesh.caching, "private, no-cache");
	assert_string_not_equal(mesh.etag, plain.etag);
	answer known = get_with(
		&s, "?level=2&step=1&primitive=deformed", (eskel_field){"If-None-Match", mesh.etag}, (eskel_field){0});
	assert_status(&known, 304);
	api_reopen(s.f);
	answer later = get(s.f->api, "/shapes/%s/reconstruction?level=2", s.id);
	assert_true(json_equal(later.json, fitted.json));
	answer_free(&none);
	answer_free(&plain);
	answer_free(&fitted);
	answer_free(&jobs);
	answer_free(&result);
	answer_free(&mesh);
	answer_free(&known);
	answer_free(&later);
}

static void another_fit_takes_the_place_of_the_last_and_goes_with_the_shape(void **state)
{
	const shape s = enroll(state);
	char target[64];
	reconstruct(&s, "?level=1&primitive=superquadric");
	answer first = get(s.f->api, "/shapes/%s/reconstruction?level=1&primitive=superquadric", s.id);
	answer drawn = get_mesh(&s, "?level=1&primitive=superquadric");
	reconstruct(&s, "?level=1&primitive=superquadric&method=tabu");
	answer second = get(s.f->api, "/shapes/%s/reconstruction?level=1&primitive=superquadric", s.id);
	assert_string_equal(text_at(&second, "method"), "tabu");
	answer redrawn = get_with(
		&s, "?level=1&primitive=superquadric", (eskel_field){"If-None-Match", drawn.etag}, (eskel_field){0});
	assert_status(&redrawn, 200);
	snprintf(target, sizeof target, "/shapes/%s", s.id);
	answer gone = ask(s.f->api, &(question){.method = "DELETE", .target = target});
	assert_status(&gone, 204);
	char again[ESKEL_ID_SIZE];
	enroll_blob(s.f->api, 3, 0, 0, "name=blob", again);
	answer none = get(s.f->api, "/shapes/%s/reconstruction?level=1&primitive=superquadric", again);
	assert_status(&none, 404);
	answer_free(&first);
	answer_free(&drawn);
	answer_free(&second);
	answer_free(&redrawn);
	answer_free(&gone);
	answer_free(&none);
}

static void a_seed_is_said_and_repeats_a_fit(void **state)
{
	const shape s = enroll(state);
	static const char *const queries[] = {"&method=tabu", "&method=tabu&seed=0", "&method=tabu&seed=7",
		"&method=tabu&seed=7", "&method=hopping&seed=2147483647", ""};
	answer fitted[6];
	for (size_t i = 0; i < 6; i++) {
		char query[80];
		snprintf(query, sizeof query, "?level=2&primitive=superquadric%s", queries[i]);
		reconstruct(&s, query);
		fitted[i] = get(s.f->api, "/shapes/%s/reconstruction?level=2&primitive=superquadric", s.id);
	}
	assert_true(number_at(&fitted[0], "seed") == 0);
	assert_true(json_equal(fitted[0].json, fitted[1].json));
	assert_true(number_at(&fitted[2], "seed") == 7);
	assert_true(json_equal(fitted[2].json, fitted[3].json));
	assert_true(number_at(&fitted[4], "seed") == 2147483647);
	assert_null(json_object_get(fitted[5].json, "seed"));
	for (size_t i = 0; i < 6; i++)
		answer_free(&fitted[i]);
}

static void algebraic_surfaces_are_fitted_stored_and_drawn(void **state)
{
	const shape s = enroll(state);
	answer none = get_mesh(&s, "?level=2&primitive=algebraic");
	assert_says(&none, 404, "no surface of the primitive algebraic was fitted to level 2");
	reconstruct(&s, "?level=2");
	reconstruct(&s, "?level=2&primitive=algebraic");
	answer fitted = get(s.f->api, "/shapes/%s/reconstruction?level=2&primitive=algebraic", s.id);
	answer deformed = get(s.f->api, "/shapes/%s/reconstruction?level=2", s.id);
	assert_status(&fitted, 200);
	assert_string_equal(text_at(&fitted, "primitive"), "algebraic");
	assert_string_equal(text_at(&fitted, "method"), "least_squares");
	assert_string_equal(text_at(&fitted, "compose"), "union");
	assert_string_equal(text_at(&deformed, "compose"), "blend");
	assert_int_equal(json_array_size(at(&fitted, "primitives.1.coefficients")), 35);
	assert_true(number_at(&fitted, "primitives.1.coefficients.34") == -1);
	assert_null(json_object_get(at(&fitted, "primitives.1"), "modes"));
	assert_true(number_at(&fitted, "after.mean_error_mm") < number_at(&fitted, "before.mean_error_mm"));
	assert_true(number_at(&fitted, "after.dice") > number_at(&fitted, "before.dice"));
	answer drawn = get_mesh(&s, "?level=2&step=1&primitive=algebraic&format=stl");
	answer other = get_mesh(&s, "?level=2&step=1&primitive=deformed&format=stl");
	assert_status(&drawn, 200);
	assert_string_equal(drawn.caching, "private, no-cache");
	assert_string_not_equal(drawn.etag, other.etag);
	api_reopen(s.f);
	answer later = get(s.f->api, "/shapes/%s/reconstruction?level=2&primitive=algebraic", s.id);
	answer redrawn = get_mesh(&s, "?level=2&step=1&primitive=algebraic&format=stl");
	assert_true(json_equal(later.json, fitted.json));
	assert_string_equal(redrawn.etag, drawn.etag);
	assert_int_equal(redrawn.size, drawn.size);
	reconstruct(&s, "?level=2&primitive=algebraic&method=least_squares");
	answer again = get(s.f->api, "/shapes/%s/reconstruction?level=2&primitive=algebraic", s.id);
	assert_true(json_equal(again.json, fitted.json));
	answer_free(&none);
	answer_free(&fitted);
	answer_free(&deformed);
	answer_free(&drawn);
	answer_free(&other);
	answer_free(&later);
	answer_free(&redrawn);
	answer_free(&again);
}

static void what_cannot_be_fitted_is_refused(void **state)
{
	const shape s = enroll(state);
	char target[100];
	answer ellipsoid = post_reconstruction(&s, "?primitive=ellipsoid"), deep = post_reconstruction(&s, "?level=17");
	assert_says(&ellipsoid, 400, "expected superquadric, deformed or algebraic");
	assert_says(&deep, 400, "level is 17, expected 1 to 16");
	answer joint = post_reconstruction(&s, "?primitive=algebraic&method=joint"),
	       squares = post_reconstruction(&s, "?method=least_squares"),
	       compose = get_mesh(&s, "?primitive=algebraic&compose=union"), seed = post_reconstruction(&s, "?seed=1"),
	       negative = post_reconstruction(&s, "?method=tabu&seed=-1");
	assert_says(&seed, 400, "seed is given beside method joint, expected tabu or hopping");
	assert_says(&negative, 400, "seed is \\\"-1\\\", expected a whole number from 0 to 2147483647");
	assert_says(&joint, 400, "method is joint and primitive is algebraic, expected least_squares");
	assert_says(
		&squares, 400, "method is least_squares and primitive is deformed, expected joint, tabu or hopping");
	assert_says(&compose, 400, "it is composed as it was fitted");
	snprintf(target, sizeof target, "/shapes/%s/reconstruction", s.id);
	answer reader = ask(s.f->api, &(question){.method = "POST", .target = target, .role = ESKEL_ROLE_READ});
	assert_status(&reader, 403);
	/* the shape goes while its job waits */
	answer first = post_reconstruction(&s, "?level=12"), second = post_reconstruction(&s, "?level=2");
	snprintf(target, sizeof target, "/shapes/%s", s.id);
	answer gone = ask(s.f->api, &(question){.method = "DELETE", .target = target});
	answer failed = wait_for(s.f->api, second.location);
	assert_string_equal(text_at(&failed, "state"), "failed");
	answer_free(&ellipsoid);
	answer_free(&deep);
	answer_free(&joint);
	answer_free(&squares);
	answer_free(&compose);
	answer_free(&seed);
	answer_free(&negative);
	answer_free(&reader);
	answer_free(&first);
	answer_free(&second);
	answer_free(&gone);
	answer_free(&failed);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_mesh_comes_in_each_format),
		api_test(a_finer_step_has_more_triangles_and_a_level_is_another_surface),
		api_test(who_has_it_is_told_so_before_it_is_made),
		api_test(parts_are_parts_of_the_whole),
		api_test(a_mesh_goes_with_its_shape),
		api_test(ellipsoids_are_those_of_the_skeleton),
		api_test(levels_of_detail_are_staircases),
		api_test(a_distance_chooses_its_row_of_the_table),
		api_test(a_mesh_that_is_made_while_its_shape_goes_is_not_kept),
		api_test(what_cannot_be_drawn_is_refused),
		api_test(a_fit_is_a_job_and_is_stored),
		api_test(another_fit_takes_the_place_of_the_last_and_goes_with_the_shape),
		api_test(a_seed_is_said_and_repeats_a_fit),
		api_test(algebraic_surfaces_are_fitted_stored_and_drawn),
		api_test(what_cannot_be_fitted_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
