#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"
#include "store_sample.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

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

/* ---- events */

static answer watch(eskel_api *api, const char *id, const char *last_seen)
{
	char target[64];
	snprintf(target, sizeof target, "/jobs/%s/events", id);
	return ask(api, &(question){.target = target, .headers = {{"Last-Event-ID", last_seen}}});
}

static void events_tell_what_becomes_of_a_job(void **state)
{
	api_fixture *f = *state;
	char *target = large_target(f->api, 500), first[ESKEL_ID_SIZE], second[ESKEL_ID_SIZE];
	begin(f->api, target, first);
	begin(f->api, "/distances?id=00000000000000000000000000000001", second);
	answer all = watch(f->api, first, "17"), failed = watch(f->api, second, "18");
	assert_status(&all, 200);
	assert_true(all.streamed);
	assert_string_equal(all.type, "text/event-stream");
	assert_memory_equal(all.body, "event: state\ndata: {\"id\":\"", 26);
	assert_non_null(strstr(all.body, "\n\nevent: progress\ndata: {"));
	const char *last = strstr(all.body, "\n\nid: end\nevent: state\ndata: {");
	assert_non_null(last);
	assert_non_null(strstr(last, "\"state\":\"done\",\"progress\":1.0,"));
	assert_string_equal(strstr(last + 2, "\n\n"), "\n\n");
	answer again = watch(f->api, first, "end"), done = get(f->api, "/jobs/%s", first);
	assert_status(&again, 204);
	assert_int_equal(again.size, 0);
	assert_non_null(strstr(last, done.body));
	assert_non_null(strstr(failed.body, "id: end\nevent: state\ndata: {"));
	assert_non_null(strstr(failed.body, "\"problem\":\"there is no shape"));
	answer unknown = get(f->api, "/jobs/%032d/events", 7);
	assert_says(&unknown, 404, "there is no job");
	answer_free(&all);
	answer_free(&failed);
	answer_free(&again);
	answer_free(&done);
	answer_free(&unknown);
	free(target);
}

static eskel_exchange *open_events(eskel_api *api, const char *id)
{
	char path[64];
	snprintf(path, sizeof path, "/jobs/%s/events", id);
	eskel_exchange *exchange =
		eskel_api_begin(api, &(eskel_request){.method = "GET", .path = path, .role = ESKEL_ROLE_READ});
	assert_non_null(exchange);
	assert_false(eskel_exchange_is_heavy(exchange));
	eskel_exchange_finish(exchange);
	return exchange;
}

static void a_stream_says_nothing_where_there_is_no_news_and_streams_are_limited(void **state)
{
	api_fixture *f = *state;
	char *target = large_target(f->api, 900), first[ESKEL_ID_SIZE], second[ESKEL_ID_SIZE];
	eskel_exchange *streams[65];
	const void *bytes = NULL;
	size_t size = 0;
	begin(f->api, target, first);
	begin(f->api, target, second);
	for (size_t i = 0; i < 65; i++) {
		streams[i] = open_events(f->api, second);
		assert_int_equal(eskel_exchange_response(streams[i])->status, i < 64 ? 200 : 503);
	}
	assert_true(eskel_exchange_response(streams[0])->live);
	assert_true(eskel_exchange_next(streams[0], &bytes, &size));
	assert_true(size > 0);
	assert_true(eskel_exchange_next(streams[0], &bytes, &size)); /* it waits for the first job */
	assert_int_equal(size, 0);
	assert_false(eskel_exchange_ended(streams[0]));
	assert_int_equal(delete_job(f->api, second), 204);
	assert_true(eskel_exchange_next(streams[0], &bytes, &size));
	assert_memory_equal(bytes, "event: gone\ndata: {\"id\":\"", 25);
	assert_true(eskel_exchange_next(streams[0], &bytes, &size));
	assert_int_equal(size, 0);
	assert_true(eskel_exchange_ended(streams[0]));
	for (size_t i = 0; i < 65; i++)
		eskel_exchange_free(streams[i]);
	streams[0] = open_events(f->api, first);
	assert_int_equal(eskel_exchange_response(streams[0])->status, 200);
	eskel_exchange_free(streams[0]);
	free(target);
}

/* ---- restarts */

static char *result_path(const api_fixture *f, const char *id)
{
	char relative[100];
	snprintf(relative, sizeof relative, "shapes.eskel-jobs/%s", id);
	return scratch_path(f->folder, relative);
}

static void assert_result(eskel_api *api, const char *id, const answer *expected)
{
	answer done = wait_for(api, id), result = get(api, "/jobs/%s/result", id);
	assert_string_equal(text_at(&done, "state"), "done");
	assert_status(&result, 200);
	assert_string_equal(result.type, expected->type);
	assert_int_equal(result.size, expected->size);
	assert_memory_equal(result.body, expected->body, expected->size);
	answer_free(&done);
	answer_free(&result);
}

static void jobs_are_in_their_state_after_a_restart(void **state)
{
	api_fixture *f = *state;
	char done[ESKEL_ID_SIZE], failed[ESKEL_ID_SIZE], running[ESKEL_ID_SIZE], queued[ESKEL_ID_SIZE];
	char *target = large_target(f->api, 500);
	begin(f->api, "/distances?format=csv&class=femur", done);
	begin(f->api, "/distances?id=00000000000000000000000000000001", failed);
	answer csv = get(f->api, "/distances?format=csv&class=femur"), large = get(f->api, "%s", target);
	answer first = wait_for(f->api, done), second = wait_for(f->api, failed);
	begin(f->api, target, running);
	begin(f->api, "/distances?format=csv&class=femur", queued);
	api_reopen(f);
	answer list = get(f->api, "/jobs");
	assert_int_equal(json_array_size(at(&list, "jobs")), 4);
	assert_true(json_equal(at(&list, "jobs.0"), first.json));
	assert_true(json_equal(at(&list, "jobs.1"), second.json));
	assert_string_equal(text_at(&list, "jobs.2.id"), running);
	assert_string_equal(text_at(&list, "jobs.3.path"), "/distances");
	assert_result(f->api, done, &csv);
	assert_result(f->api, running, &large);
	assert_result(f->api, queued, &csv);
	answer_free(&csv);
	answer_free(&large);
	answer_free(&first);
	answer_free(&second);
	answer_free(&list);
	free(target);
}

static void a_negotiated_format_is_remembered(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	answer a = ask(f->api,
		&(question){.method = "POST", .target = "/distances", .headers = {{"Accept", "application/x-npy"}}});
	memcpy(id, text_at(&a, "id"), sizeof id);
	api_reopen(f);
	answer done = wait_for(f->api, id);
	assert_string_equal(text_at(&done, "content_type"), "application/x-npy");
	answer_free(&a);
	answer_free(&done);
}

static void a_result_that_is_damaged_or_gone_is_made_again(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE], shape[ESKEL_ID_SIZE];
	enroll_blob(f->api, 3, 0, 0, "class=femur", shape);
	begin(f->api, "/distances?format=csv", id);
	answer csv = get(f->api, "/distances?format=csv");
	assert_result(f->api, id, &csv);
	char *path = result_path(f, id);

	size_t size;
	uint8_t *bytes = file_read(path, &size);
	bytes[3] ^= 1;
	file_write(path, bytes, size);
	api_reopen(f);
	answer damaged = get(f->api, "/jobs/%s/result", id);
	assert_says(&damaged, 409, "was damaged; the job is done again");
	assert_result(f->api, id, &csv);

	file_write(path, bytes, size - 1); /* is seen at the start */
	api_reopen(f);
	assert_result(f->api, id, &csv);

	assert_int_equal(unlink(path), 0); /* beside a server that has it verified */
	answer gone = get(f->api, "/jobs/%s/result", id);
	assert_says(&gone, 409, "the job is done again");
	assert_result(f->api, id, &csv);
	answer_free(&csv);
	answer_free(&damaged);
	answer_free(&gone);
	free(bytes);
	free(path);
}

/* As long as no file may grow, as on a disk that fails. */
static int status_without_writing(eskel_api *api, const char *path)
{
	struct rlimit before, none;
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
	none = (struct rlimit){.rlim_cur = 0, .rlim_max = before.rlim_max};
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
	eskel_exchange *exchange =
		eskel_api_begin(api, &(eskel_request){.method = "GET", .path = path, .role = ESKEL_ROLE_READ});
	assert_non_null(exchange);
	eskel_exchange_finish(exchange);
	const int status = eskel_exchange_response(exchange)->status;
	eskel_exchange_free(exchange);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
	return status;
}

static void a_job_that_cannot_be_queued_again_is_not_called_unknown(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE], target[64];
	begin(f->api, "/distances", id);
	answer done = wait_for(f->api, id);
	char *path = result_path(f, id);
	assert_int_equal(unlink(path), 0);
	snprintf(target, sizeof target, "/jobs/%s/result", id);
	assert_int_equal(status_without_writing(f->api, target), 500);
	answer_free(&done);
	free(path);
}

static void files_that_belong_to_no_job_are_swept(void **state)
{
	api_fixture *f = *state;
	static const char *const names[] = {"00000000000000000000000000000001", "x.0.part", "stray"};
	char *paths[4], id[ESKEL_ID_SIZE];
	begin(f->api, "/distances", id);
	answer done = wait_for(f->api, id);
	for (size_t i = 0; i < 3; i++) {
		paths[i] = result_path(f, names[i]);
		file_write(paths[i], "a result of which the server was killed before it said so", 57);
	}
	api_reopen(f);
	paths[3] = result_path(f, id);
	for (size_t i = 0; i < 4; i++) {
		assert_int_equal(access(paths[i], F_OK), i < 3 ? -1 : 0);
		free(paths[i]);
	}
	answer_free(&done);
}

static void a_job_that_brings_the_server_down_is_not_begun_for_ever(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	begin(f->api, "/distances", id);
	answer done = wait_for(f->api, id);
	for (unsigned starts = 2; starts <= 3; starts++) {
		eskel_job row = {.starts = starts};
		memcpy(row.id, id, sizeof row.id);
		assert_int_equal(eskel_store_job_update(eskel_api_store(f->api), &row, NULL), ESKEL_STORE_OK);
		api_reopen(f);
		answer ended = wait_for(f->api, id);
		assert_string_equal(text_at(&ended, "state"), starts < 3 ? "done" : "failed");
		answer_free(&ended);
	}
	answer result = get(f->api, "/jobs/%s/result", id);
	assert_says(&result, 500, "the server ended 3 times while it ran");
	answer_free(&done);
	answer_free(&result);
}

static void reopen_with_room(api_fixture *f, uint64_t bytes)
{
	eskel_api_close(f->api);
	f->api = NULL;
	const eskel_api_options options = {.most_result_bytes = bytes};
	assert_int_equal(eskel_api_open(f->path, &options, &f->api, NULL), ESKEL_STORE_OK);
}

static void results_have_only_so_much_room(void **state)
{
	api_fixture *f = *state;
	char *target = large_target(f->api, 100), ids[3][ESKEL_ID_SIZE]; /* 80128 bytes */
	reopen_with_room(f, 200000);
	for (size_t i = 0; i < 3; i++) {
		begin(f->api, target, ids[i]);
		answer done = wait_for(f->api, ids[i]);
		assert_string_equal(text_at(&done, "state"), "done");
		answer_free(&done);
	}
	answer list = get(f->api, "/jobs");
	assert_int_equal(json_array_size(at(&list, "jobs")), 2);
	assert_string_equal(text_at(&list, "jobs.0.id"), ids[1]);
	reopen_with_room(f, 70000);
	begin(f->api, target, ids[0]);
	answer failed = wait_for(f->api, ids[0]), result = get(f->api, "/jobs/%s/result", ids[0]);
	assert_string_equal(text_at(&failed, "state"), "failed");
	assert_true(number_at(&failed, "size") == 0);
	assert_says(&result, 413, "bytes, expected at most 70000");
	answer_free(&list);
	answer_free(&failed);
	answer_free(&result);
	free(target);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_job_answers_what_the_request_would),
		api_test(a_job_that_runs_can_be_watched_and_cancelled),
		api_test(a_streamed_matrix_is_whole_in_the_file),
		api_test(what_cannot_be_begun_is_refused_and_what_fails_says_why),
		api_test(jobs_that_ended_make_room_for_new_ones),
		api_test(events_tell_what_becomes_of_a_job),
		api_test(a_stream_says_nothing_where_there_is_no_news_and_streams_are_limited),
		api_test(jobs_are_in_their_state_after_a_restart),
		api_test(a_negotiated_format_is_remembered),
		api_test(a_result_that_is_damaged_or_gone_is_made_again),
		api_test(a_job_that_cannot_be_queued_again_is_not_called_unknown),
		api_test(files_that_belong_to_no_job_are_swept),
		api_test(a_job_that_brings_the_server_down_is_not_begun_for_ever),
		api_test(results_have_only_so_much_room),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
