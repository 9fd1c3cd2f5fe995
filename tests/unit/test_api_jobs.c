#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static answer post(eskel_api *api, const char *target)
{
	return ask(api, &(question){.method = "POST", .target = target});
}

static int delete_job(eskel_api *api, const char *id)
{
	char target[64];
	snprintf(target, sizeof target, "/jobs/%s", id);
	answer a = ask(api, &(question){.method = "DELETE", .target = target});
	const int status = a.status;
	answer_free(&a);
	return status;
}

/* Begins a job; its id. */
static void begin(eskel_api *api, const char *target, char id[ESKEL_ID_SIZE])
{
	answer a = post(api, target);
	assert_status(&a, 202);
	memcpy(id, text_at(&a, "id"), ESKEL_ID_SIZE);
	assert_string_equal(a.location, text_at(&a, "url"));
	answer_free(&a);
}

/* Waits for a job to end; its state. */
static answer wait_for(eskel_api *api, const char *id)
{
	for (;;) {
		answer a = get(api, "/jobs/%s", id);
		assert_status(&a, 200);
		const char *state = text_at(&a, "state");
		if (strcmp(state, "done") == 0 || strcmp(state, "failed") == 0)
			return a;
		answer_free(&a);
		nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
	}
}

/* A matrix of three shapes, each named so often that it takes some time. */
static char *large_target(eskel_api *api, unsigned times)
{
	char ids[3][ESKEL_ID_SIZE];
	char *target = calloc(1, 200 + 2 * (size_t)times * ESKEL_ID_SIZE), *end = target;
	for (unsigned i = 0; i < 3; i++)
		enroll_blob(api, 5 * i + 3, 0, 0, "class=femur", ids[i]);
	end += sprintf(end, "/distances?format=npy&id=");
	for (unsigned i = 0; i < times; i++)
		end += sprintf(end, "%s%s", i ? "," : "", ids[i % 3]);
	end += sprintf(end, "&columns.id=");
	for (unsigned i = 0; i < times; i++)
		end += sprintf(end, "%s%s", i ? "," : "", ids[i % 3]);
	return target;
}

static void a_job_answers_what_the_request_would(void **state)
{
	api_fixture *f = *state;
	static const char *const formats[] = {"json", "csv", "npy", "svg"};
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 3, 0, 0, "name=femur_left", id);
	enroll_blob(f->api, 8, 0, 0, "name=talus_left", id);
	for (size_t i = 0; i < 4; i++) {
		char target[64];
		snprintf(target, sizeof target, "/distances?format=%s", formats[i]);
		begin(f->api, target, id);
		answer done = wait_for(f->api, id), result = get(f->api, "/jobs/%s/result", id);
		answer expected = get(f->api, "/distances?format=%s", formats[i]);
		assert_string_equal(text_at(&done, "state"), "done");
		assert_true(number_at(&done, "progress") == 1);
		assert_true(number_at(&done, "size") == (double)expected.size);
		assert_string_equal(text_at(&done, "content_type"), expected.type);
		assert_status(&result, 200);
		assert_string_equal(result.type, expected.type);
		assert_int_equal(result.size, expected.size);
		assert_memory_equal(result.body, expected.body, expected.size);
		answer_free(&done);
		answer_free(&result);
		answer_free(&expected);
	}
	answer list = get(f->api, "/jobs");
	assert_int_equal(json_array_size(at(&list, "jobs")), 4);
	assert_int_equal(delete_job(f->api, id), 204);
	assert_int_equal(delete_job(f->api, id), 404);
	answer gone = get(f->api, "/jobs/%s/result", id);
	assert_says(&gone, 404, "there is no job");
	answer_free(&list);
	answer_free(&gone);
}

static void a_job_that_runs_can_be_watched_and_cancelled(void **state)
{
	api_fixture *f = *state;
	char first[ESKEL_ID_SIZE], second[ESKEL_ID_SIZE];
	char *target = large_target(f->api, 900);
	begin(f->api, target, first);
	begin(f->api, target, second);
	answer waiting = get(f->api, "/jobs/%s", second), early = get(f->api, "/jobs/%s/result", second);
	assert_string_equal(text_at(&waiting, "state"), "queued");
	assert_true(number_at(&waiting, "progress") == 0);
	assert_null(text_at(&waiting, "result"));
	assert_says(&early, 409, "the job is 0 % done, expected a job that is done");
	assert_int_equal(delete_job(f->api, first), 204); /* runs, or is about to */
	assert_int_equal(delete_job(f->api, second), 204);
	answer list = get(f->api, "/jobs");
	assert_int_equal(json_array_size(at(&list, "jobs")), 0);
	answer_free(&waiting);
	answer_free(&early);
	answer_free(&list);
	free(target);
}

static void a_streamed_matrix_is_whole_in_the_file(void **state)
{
	api_fixture *f = *state;
	enum { times = 260 }; /* more cells than are answered at once */
	char id[ESKEL_ID_SIZE];
	char *target = large_target(f->api, times);
	begin(f->api, target, id);
	answer done = wait_for(f->api, id), result = get(f->api, "/jobs/%s/result", id);
	assert_string_equal(text_at(&done, "state"), "done");
	assert_int_equal(result.size, 128 + 8 * times * times);
	answer_free(&done);
	answer_free(&result);
	free(target);
}

static void what_cannot_be_begun_is_refused_and_what_fails_says_why(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	answer bad = post(f->api, "/distances?colour=red");
	assert_says(&bad, 400, "there is no query parameter");
	begin(f->api, "/distances?id=00000000000000000000000000000001", id); /* found out when it runs */
	answer failed = wait_for(f->api, id), result = get(f->api, "/jobs/%s/result", id);
	assert_string_equal(text_at(&failed, "state"), "failed");
	assert_non_null(strstr(text_at(&failed, "problem"), "there is no shape"));
	assert_says(&result, 404, "there is no shape");
	answer unknown = get(f->api, "/jobs/%032d", 7);
	assert_says(&unknown, 404, "there is no job");
	answer_free(&bad);
	answer_free(&failed);
	answer_free(&result);
	answer_free(&unknown);
}

static void jobs_that_ended_make_room_for_new_ones(void **state)
{
	api_fixture *f = *state;
	char ids[20][ESKEL_ID_SIZE];
	for (unsigned i = 0; i < 20; i++) {
		begin(f->api, "/distances", ids[i]);
		answer done = wait_for(f->api, ids[i]);
		answer_free(&done);
	}
	answer list = get(f->api, "/jobs"), first = get(f->api, "/jobs/%s", ids[0]);
	assert_int_equal(json_array_size(at(&list, "jobs")), 16);
	assert_string_equal(text_at(&list, "jobs.15.id"), ids[19]);
	assert_status(&first, 404);
	answer_free(&list);
	answer_free(&first);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_job_answers_what_the_request_would),
		api_test(a_job_that_runs_can_be_watched_and_cancelled),
		api_test(a_streamed_matrix_is_whole_in_the_file),
		api_test(what_cannot_be_begun_is_refused_and_what_fails_says_why),
		api_test(jobs_that_ended_make_room_for_new_ones),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
