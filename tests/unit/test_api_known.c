/* Recognitions answer from shapes in memory, and as if there were none. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api.h"
#include "api/client.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHAPES = 6, READERS = 3, PATCHES = 40, AN_ENTRY = 25000 };

static void enroll_some(eskel_api *api, char ids[SHAPES][ESKEL_ID_SIZE])
{
	for (unsigned i = 0; i < SHAPES; i++)
		enroll_blob(api, 5 * (i / 2), i % 2, 0, "name=femur_left", ids[i]);
}

static void reopen_with(api_fixture *f, uint64_t most_known_bytes)
{
	const eskel_api_options options = {.most_known_bytes = most_known_bytes};
	eskel_api_close(f->api);
	f->api = NULL;
	assert_int_equal(eskel_api_open(f->path, &options, &f->api, NULL), ESKEL_STORE_OK);
}

/* All but how long the search took. */
static json_t *recognise(eskel_api *api, const char *id)
{
	answer a = get(api, "/recognize?shape=%s&explain=true", id);
	assert_status(&a, 200);
	json_object_del(at(&a, "results.0.search"), "milliseconds");
	json_t *all = json_incref(at(&a, "results"));
	answer_free(&a);
	return all;
}

static void patch(eskel_api *api, const char *id, const char *body)
{
	char target[64];
	snprintf(target, sizeof target, "/shapes/%s", id);
	answer a = ask(api, &(question){.method = "PATCH", .target = target, .body = body, .size = strlen(body)});
	assert_status(&a, 200);
	answer_free(&a);
}

static void remembered_shapes_answer_as_those_read_anew(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE];
	json_t *first[SHAPES];
	enroll_some(f->api, ids);
	for (unsigned i = 0; i < SHAPES; i++)
		first[i] = recognise(f->api, ids[i]);
	static const uint64_t rooms[] = {1, 2 * AN_ENTRY, 0};
	for (size_t r = 0; r < sizeof rooms / sizeof *rooms; r++) {
		reopen_with(f, rooms[r]);
		for (unsigned n = 0; n < 3 * SHAPES; n++) {
			json_t *again = recognise(f->api, ids[n % SHAPES]);
			assert_true(json_equal(again, first[n % SHAPES]));
			json_decref(again);
		}
	}
	for (unsigned i = 0; i < SHAPES; i++)
		json_decref(first[i]);
}

static void a_patch_is_seen_in_the_next_recognition(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE];
	enroll_some(f->api, ids);
	json_decref(recognise(f->api, ids[0]));
	patch(f->api, ids[0], "{\"name\": \"new name\"}");
	patch(f->api, ids[1], "{\"class\": \"talus\"}");
	answer a = get(f->api, "/recognize?shape=%s", ids[0]);
	assert_string_equal(text_at(&a, "results.0.query.name"), "new name");
	assert_string_equal(text_at(&a, "results.0.neighbours.0.id"), ids[1]);
	assert_string_equal(text_at(&a, "results.0.neighbours.0.class"), "talus");
	answer_free(&a);
}

static void a_deleted_shape_is_forgotten(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE], target[64];
	enroll_some(f->api, ids);
	json_decref(recognise(f->api, ids[0]));
	snprintf(target, sizeof target, "/shapes/%s", ids[0]);
	answer gone = ask(f->api, &(question){.method = "DELETE", .target = target});
	assert_status(&gone, 204);
	answer_free(&gone);
	answer a = get(f->api, "/recognize?shape=%s", ids[0]);
	assert_says(&a, 404, ids[0]);
	answer_free(&a);
	a = get(f->api, "/recognize?shape=%s", ids[1]);
	assert_status(&a, 200);
	assert_int_equal(json_array_size(at(&a, "results.0.neighbours")), SHAPES - 2);
	answer_free(&a);
}

static void the_least_recently_used_goes_and_a_shape_in_use_stays_whole(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE];
	const esk_known_shape *held = NULL, *other = NULL, *again = NULL;
	enroll_some(f->api, ids);
	esk_known *known = esk_known_new(f->api->store, 2 * AN_ENTRY);
	assert_non_null(known);
	assert_int_equal(esk_known_by_id(known, ids[0], &held, NULL), ESKEL_STORE_OK);
	for (unsigned i = 1; i < SHAPES; i++) {
		assert_int_equal(esk_known_by_id(known, ids[i], &other, NULL), ESKEL_STORE_OK);
		esk_known_release(known, other);
	}
	assert_string_equal(held->shape.id, ids[0]);
	/* kept: the last ones, under key and id */
	assert_int_equal(esk_known_by_key(known, other->shape.key, &again, NULL), ESKEL_STORE_OK);
	assert_ptr_equal(again, other);
	esk_known_release(known, again);
	/* not kept: the first, which is read anew */
	assert_int_equal(esk_known_by_key(known, held->shape.key, &again, NULL), ESKEL_STORE_OK);
	assert_ptr_not_equal(again, held);
	esk_known_drop(known, held->shape.key);
	assert_string_equal(again->shape.id, ids[0]);
	esk_known_release(known, again);
	esk_known_release(known, held);
	assert_int_equal(esk_known_by_key(known, 12345, &again, NULL), ESKEL_STORE_NOT_FOUND);
	esk_known_free(known);
}

typedef struct {
	eskel_api *api;
	const char *id;
	atomic_int *patched; /* the number in the name of the last patch that was answered */
	atomic_int *wrong;
} reader;

/* A recognition that begins after a patch was answered shows that patch or a later one. */
static void *read_on(void *context)
{
	reader *r = context;
	while (atomic_load(r->patched) < PATCHES) {
		int least = atomic_load(r->patched);
		answer a = get(r->api, "/recognize?shape=%s&limit=1", r->id);
		if (a.status != 200 || atoi(text_at(&a, "results.0.query.name")) < least ||
			atoi(text_at(&a, "results.0.neighbours.0.name")) < least)
			atomic_fetch_add(r->wrong, 1);
		answer_free(&a);
	}
	return NULL;
}

static void no_reader_sees_what_was_patched_before_it_began(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE];
	pthread_t threads[READERS];
	atomic_int patched = 0, wrong = 0;
	enroll_some(f->api, ids);
	patch(f->api, ids[0], "{\"name\": \"0\"}");
	patch(f->api, ids[1], "{\"name\": \"0\"}");
	reader r = {f->api, ids[0], &patched, &wrong};
	for (int i = 0; i < READERS; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, read_on, &r), 0);
	for (int n = 1; n <= PATCHES; n++) {
		char body[40];
		snprintf(body, sizeof body, "{\"name\": \"%d\"}", n);
		patch(f->api, ids[0], body);
		patch(f->api, ids[1], body);
		atomic_store(&patched, n);
	}
	for (int i = 0; i < READERS; i++)
		pthread_join(threads[i], NULL);
	assert_int_equal(wrong, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(remembered_shapes_answer_as_those_read_anew),
		api_test(a_patch_is_seen_in_the_next_recognition),
		api_test(a_deleted_shape_is_forgotten),
		api_test(the_least_recently_used_goes_and_a_shape_in_use_stays_whole),
		api_test(no_reader_sees_what_was_patched_before_it_began),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
