#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define THREADS 4
#define SHAPES 100

typedef struct {
	eskel_api *api;
	unsigned number;
	atomic_int *wrong;
} worker;

static void count_unless(worker *w, const answer *a, int status, int other)
{
	if (a->status == status || a->status == other)
		return;
	print_error("%d %s\n", a->status, a->body);
	atomic_fetch_add(w->wrong, 1);
}

/* Enrolls every fourth of SHAPES small shapes, recognising each at once. */
static void *enroll_and_recognize(void *context)
{
	worker *w = context;
	for (unsigned i = w->number; i < SHAPES; i += THREADS) {
		volume_file file = volume_of_family(i % 36, i / 36, 0);
		answer enrolled = post_volume(w->api, &file, "/shapes?levels=6&name=c%u_left", i % 36);
		count_unless(w, &enrolled, 201, 201);
		answer found = get(w->api, "/recognize?shape=%s&limit=3", text_at(&enrolled, "shapes.0.id"));
		count_unless(w, &found, 200, 200);
		answer posted = post_volume(w->api, &file, "/recognize?limit=1");
		count_unless(w, &posted, 200, 200);
		/* what was answered with 201 is there for every request that starts later */
		if (strcmp(text_at(&posted, "results.0.neighbours.0.id"), text_at(&enrolled, "shapes.0.id")) != 0)
			atomic_fetch_add(w->wrong, 1);
		answer_free(&enrolled);
		answer_free(&found);
		answer_free(&posted);
		volume_free(&file);
	}
	return NULL;
}

/* Deletes and enrolls the same few shapes again and again, asking for matrices meanwhile. */
static void *come_and_go(void *context)
{
	worker *w = context;
	for (unsigned i = 0; i < 40; i++) {
		volume_file file = volume_of_family(i % 3, 0, 0);
		answer enrolled = post_volume(w->api, &file, "/shapes?levels=3");
		count_unless(w, &enrolled, 201, 200);
		answer matrix = get(w->api, "/distances");
		count_unless(w, &matrix, 200, 200);
		answer found = get(w->api, "/recognize?shape=%s", text_at(&enrolled, "shapes.0.id"));
		count_unless(w, &found, 200, 404);
		answer gone =
			ask(w->api, &(question){.method = "DELETE", .target = text_at(&enrolled, "shapes.0.url")});
		count_unless(w, &gone, 204, 404);
		answer_free(&enrolled);
		answer_free(&matrix);
		answer_free(&found);
		answer_free(&gone);
		volume_free(&file);
	}
	return NULL;
}

static void run(eskel_api *api, void *(*work)(void *))
{
	pthread_t threads[THREADS];
	worker workers[THREADS];
	atomic_int wrong = 0;
	for (unsigned i = 0; i < THREADS; i++) {
		workers[i] = (worker){api, i, &wrong};
		assert_int_equal(pthread_create(&threads[i], NULL, work, &workers[i]), 0);
	}
	for (unsigned i = 0; i < THREADS; i++)
		pthread_join(threads[i], NULL);
	assert_int_equal(wrong, 0);
}

/* The neighbours and verdicts of every shape. */
static json_t *recognise_all(eskel_api *api)
{
	json_t *all = json_object(), *shape;
	size_t i;
	answer list = get(api, "/shapes?limit=1000");
	json_array_foreach (at(&list, "shapes"), i, shape) {
		const char *id = json_string_value(json_object_get(shape, "id"));
		answer a = get(api, "/recognize?shape=%s&mode=exact", id);
		assert_status(&a, 200);
		json_t *kept = json_pack("[O, O, O]", at(&a, "results.0.query"), at(&a, "results.0.neighbours"),
			at(&a, "results.0.verdict"));
		json_object_set_new(all, id, kept);
		answer_free(&a);
	}
	answer_free(&list);
	return all;
}

static void answers_are_the_same_after_a_restart(void **state)
{
	api_fixture *f = *state;
	run(f->api, enroll_and_recognize);
	assert_int_equal(eskel_api_shape_count(f->api), SHAPES);
	json_t *before = recognise_all(f->api);
	assert_int_equal(json_object_size(before), SHAPES);
	api_reopen(f);
	assert_int_equal(eskel_api_shape_count(f->api), SHAPES);
	json_t *after = recognise_all(f->api);
	assert_true(json_equal(before, after));
	json_decref(before);
	json_decref(after);
}

static void store_and_library_stay_the_same_set(void **state)
{
	api_fixture *f = *state;
	run(f->api, come_and_go);
	uint64_t count = 0;
	assert_int_equal(eskel_store_count(eskel_api_store(f->api), &count, NULL), ESKEL_STORE_OK);
	assert_int_equal(eskel_api_shape_count(f->api), count);
	answer a = get(f->api, "/distances");
	assert_status(&a, 200);
	answer_free(&a);
}

typedef struct {
	eskel_api *api;
	const char *id, *query;
	answer answer;
} asker;

static void *ask_for_mesh(void *context)
{
	asker *a = context;
	a->answer = get(a->api, "/shapes/%s/mesh%s", a->id, a->query);
	return NULL;
}

static void ask_at_once(const asker *model, asker askers[THREADS])
{
	pthread_t threads[THREADS];
	for (int i = 0; i < THREADS; i++) {
		askers[i] = *model;
		assert_int_equal(pthread_create(&threads[i], NULL, ask_for_mesh, &askers[i]), 0);
	}
	for (int i = 0; i < THREADS; i++)
		pthread_join(threads[i], NULL);
}

/* Who makes it answers from memory, the others from the file. */
static void a_mesh_that_many_ask_for_at_once_is_made_once(void **state)
{
	api_fixture *f = *state;
	static const char *const queries[] = {"?step=0.5", "?source=voxels", "?step=0.4&format=obj"};
	char id[ESKEL_ID_SIZE];
	asker askers[THREADS];
	enroll_blob(f->api, 3, 0, 0, "name=blob", id);
	for (size_t q = 0; q < sizeof queries / sizeof *queries; q++) {
		const asker model = {.api = f->api, .id = id, .query = queries[q]};
		int made = 0;
		ask_at_once(&model, askers);
		for (int i = 0; i < THREADS; i++) {
			const answer *a = &askers[i].answer, *first = &askers[0].answer;
			assert_status(a, 200);
			assert_int_equal(a->size, first->size);
			assert_memory_equal(a->body, first->body, first->size);
			made += !a->streamed;
		}
		assert_int_equal(made, 1);
		for (int i = 0; i < THREADS; i++)
			answer_free(&askers[i].answer);
	}
}

static bool stop_loading(void *context, uint64_t loaded, uint64_t total)
{
	uint64_t *told = context;
	told[0] = loaded;
	told[1] = total;
	return false;
}

static void loading_can_be_stopped(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	uint64_t told[2] = {7, 7};
	eskel_store_error error = {0};
	enroll_blob(f->api, 0, 0, 0, "levels=2", id);
	eskel_api_close(f->api);
	f->api = NULL;
	const eskel_api_options options = {.loading = stop_loading, .context = told};
	assert_int_equal(eskel_api_open(f->path, &options, &f->api, &error), ESKEL_STORE_INVALID);
	assert_null(f->api);
	assert_non_null(strstr(error.text, "the caller asked to stop"));
	assert_int_equal(told[0], 0);
	assert_int_equal(told[1], 1);
	assert_int_equal(eskel_api_open(f->path, NULL, &f->api, &error), ESKEL_STORE_OK);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(answers_are_the_same_after_a_restart),
		api_test(store_and_library_stay_the_same_set),
		api_test(a_mesh_that_many_ask_for_at_once_is_made_once),
		api_test(loading_can_be_stopped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
