/* Rows of jobs, and files beside the database. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "store_fixture.h"
#include "store_sample.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- rows */

static eskel_job job_of(int number)
{
	eskel_job job = {.request = "{}"};
	snprintf(job.id, sizeof job.id, "%032x", (unsigned)number);
	return job;
}

static void jobs_outlive_the_store_in_their_order(void **state)
{
	store_fixture *f = *state;
	for (int i = 3; i > 0; i--) {
		eskel_job job = job_of(i);
		assert_ok(eskel_store_job_add(f->store, &job, &f->error), f);
		assert_int_equal(strlen(job.created), 20);
	}
	eskel_job ended = job_of(2);
	ended.state = ESKEL_JOB_FAILED;
	ended.starts = 2;
	ended.status = 404;
	ended.size = (uint64_t)1 << 40;
	ended.seconds = 1.5;
	strcpy(ended.content_type, "text/csv");
	strcpy(ended.problem, "there is no shape");
	assert_ok(eskel_store_job_update(f->store, &ended, &f->error), f);
	assert_ok(eskel_store_job_remove(f->store, job_of(3).id, &f->error), f);
	store_reopen(f);
	eskel_job *jobs = NULL;
	size_t count = 0;
	assert_ok(eskel_store_jobs(f->store, &jobs, &count, &f->error), f);
	assert_int_equal(count, 2);
	assert_string_equal(jobs[0].id, ended.id);
	assert_string_equal(jobs[0].request, "{}");
	assert_int_equal(jobs[0].state, ESKEL_JOB_FAILED);
	assert_int_equal(jobs[0].starts, 2);
	assert_int_equal(jobs[0].status, 404);
	assert_true(jobs[0].size == ended.size && jobs[0].seconds == 1.5);
	assert_string_equal(jobs[0].content_type, "text/csv");
	assert_string_equal(jobs[0].problem, "there is no shape");
	assert_string_equal(jobs[1].id, job_of(1).id);
	assert_int_equal(jobs[1].state, ESKEL_JOB_QUEUED);
	assert_string_equal(jobs[1].content_type, "");
	eskel_jobs_free(jobs, count);
}

static void a_job_is_there_once_and_one_that_is_gone_stays_so(void **state)
{
	store_fixture *f = *state;
	eskel_job job = job_of(1), *jobs = NULL;
	size_t count = 9;
	assert_ok(eskel_store_job_add(f->store, &job, &f->error), f);
	assert_int_equal(eskel_store_job_add(f->store, &job, &f->error), ESKEL_STORE_INVALID);
	assert_ok(eskel_store_job_remove(f->store, job.id, &f->error), f);
	assert_ok(eskel_store_job_remove(f->store, job.id, &f->error), f);
	assert_ok(eskel_store_job_update(f->store, &job, &f->error), f);
	assert_ok(eskel_store_jobs(f->store, &jobs, &count, &f->error), f);
	assert_int_equal(count, 0);
	eskel_jobs_free(jobs, count);
}

/* ---- files */

static eskel_folder *open_folder(store_fixture *f)
{
	eskel_folder *folder = NULL;
	assert_ok(eskel_folder_open(f->store, "test", &folder, &f->error), f);
	return folder;
}

/* The path of a file in it; "" of the folder. */
static char *path_of(const store_fixture *f, const char *name)
{
	char relative[200];
	snprintf(relative, sizeof relative, "%s-test/%s", strrchr(f->path, '/') + 1, name);
	return scratch_path(f->folder, relative);
}

static void keep(store_fixture *f, eskel_folder *folder, const char *name, const void *bytes, size_t size)
{
	eskel_file *file = NULL;
	assert_ok(eskel_file_create(folder, name, &file, &f->error), f);
	assert_ok(eskel_file_write(file, bytes, size / 2, &f->error), f);
	assert_ok(eskel_file_write(file, (const char *)bytes + size / 2, size - size / 2, &f->error), f);
	assert_ok(eskel_file_keep(file, &f->error), f);
}

static void assert_file(store_fixture *f, eskel_folder *folder, const char *name, const void *bytes, size_t size)
{
	int descriptor = -1;
	uint64_t found = 0;
	assert_ok(eskel_file_open(folder, name, true, &descriptor, &found, &f->error), f);
	assert_int_equal(found, size);
	char *read_back = calloc(1, size + 1);
	assert_int_equal(pread(descriptor, read_back, size, 0), size);
	assert_memory_equal(read_back, bytes, size);
	free(read_back);
	close(descriptor);
}

static eskel_store_status open_file(store_fixture *f, eskel_folder *folder, const char *name, bool verify)
{
	int descriptor = -1;
	uint64_t size;
	eskel_store_status status = eskel_file_open(folder, name, verify, &descriptor, &size, &f->error);
	if (status == ESKEL_STORE_OK)
		close(descriptor);
	return status;
}

static void a_file_that_is_kept_is_there_after_a_restart_and_its_owners_alone(void **state)
{
	store_fixture *f = *state;
	enum { size = 300000 };
	char *bytes = malloc(size), *path = path_of(f, ""), *inside = path_of(f, "a");
	for (size_t i = 0; i < size; i++)
		bytes[i] = (char)(i * i >> 5);
	eskel_folder *folder = open_folder(f);
	keep(f, folder, "a", bytes, 10);
	keep(f, folder, "a", bytes, size); /* takes the place of the first */
	keep(f, folder, "empty", bytes, 0);
	eskel_folder_close(folder);
	folder = open_folder(f);
	assert_file(f, folder, "a", bytes, size);
	assert_file(f, folder, "empty", bytes, 0);
	struct stat is;
	assert_int_equal(stat(path, &is), 0);
	assert_int_equal(is.st_mode & 0777, 0700);
	assert_int_equal(stat(inside, &is), 0);
	assert_int_equal(is.st_mode & 0777, 0600);
	eskel_folder_remove(folder, "a");
	eskel_folder_remove(folder, "a");
	assert_int_equal(open_file(f, folder, "a", false), ESKEL_STORE_NOT_FOUND);
	eskel_folder_close(folder);
	free(bytes);
	free(path);
	free(inside);
}

static void a_damaged_file_is_found(void **state)
{
	store_fixture *f = *state;
	char *path = path_of(f, "a");
	eskel_folder *folder = open_folder(f);
	for (size_t at = 0; at < 8 + 32; at += 13) {
		size_t size;
		keep(f, folder, "a", "8 bytes.", 8);
		uint8_t *bytes = file_read(path, &size);
		assert_int_equal(size, 8 + 32);
		bytes[at] ^= 1;
		file_write(path, bytes, size);
		assert_int_equal(open_file(f, folder, "a", true), ESKEL_STORE_CORRUPT);
		assert_non_null(strstr(f->error.text, "is damaged"));
		assert_int_equal(open_file(f, folder, "a", false), ESKEL_STORE_OK);
		file_write(path, bytes, 31);
		assert_int_equal(open_file(f, folder, "a", false), ESKEL_STORE_CORRUPT);
		free(bytes);
	}
	assert_int_equal(unlink(path), 0);
	assert_int_equal(symlink("/etc/passwd", path), 0);
	assert_int_equal(open_file(f, folder, "a", false), ESKEL_STORE_IO);
	eskel_folder_close(folder);
	free(path);
}

static bool keep_b(void *context, const char *name, uint64_t size, int64_t used)
{
	size_t *count = context;
	(*count)++;
	assert_true(used > 1700000000000000000);
	assert_int_equal(size, 5);
	return strcmp(name, "b") == 0;
}

static void what_is_unfinished_or_unwanted_is_removed(void **state)
{
	store_fixture *f = *state;
	static const char *const names[] = {"a", "b", "c"};
	eskel_file *file = NULL, *other = NULL;
	size_t count = 0;
	eskel_folder *folder = open_folder(f);
	for (size_t i = 0; i < 3; i++)
		keep(f, folder, names[i], "bytes", 5);
	assert_ok(eskel_file_create(folder, "a", &file, &f->error), f);
	assert_ok(eskel_file_create(folder, "a", &other, &f->error), f); /* two at once do not meet */
	assert_ok(eskel_file_write(file, "new", 3, &f->error), f);
	eskel_file_discard(other);
	assert_file(f, folder, "a", "bytes", 5);
	eskel_folder *again = open_folder(f); /* as after a crash: sweeps the unfinished one */
	assert_int_equal(eskel_file_keep(file, &f->error), ESKEL_STORE_IO);
	assert_file(f, folder, "a", "bytes", 5);
	assert_ok(eskel_folder_each(again, keep_b, &count, &f->error), f);
	assert_int_equal(count, 3);
	assert_int_equal(open_file(f, folder, "a", false), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(open_file(f, folder, "b", true), ESKEL_STORE_OK);
	eskel_folder_close(again);
	eskel_folder_close(folder);
}

static void a_folder_that_is_not_ours_alone_is_refused(void **state)
{
	store_fixture *f = *state;
	eskel_folder *folder = NULL;
	char *path = path_of(f, "");
	path[strlen(path) - 1] = '\0';
	assert_int_equal(mkdir(path, 0755), 0);
	assert_int_equal(eskel_folder_open(f->store, "test", &folder, &f->error), ESKEL_STORE_FOREIGN);
	assert_non_null(strstr(f->error.text, "mode 755, expected user"));
	assert_int_equal(rmdir(path), 0);
	assert_int_equal(symlink("/tmp", path), 0);
	assert_int_equal(eskel_folder_open(f->store, "test", &folder, &f->error), ESKEL_STORE_IO);
	assert_int_equal(unlink(path), 0);
	file_write(path, "", 0);
	assert_int_equal(eskel_folder_open(f->store, "test", &folder, &f->error), ESKEL_STORE_IO);
	assert_null(folder);
	free(path);
}

static void a_disk_with_too_little_room_takes_no_file(void **state)
{
	store_fixture *f = *state;
	eskel_file *file = NULL;
	eskel_store_close(f->store);
	f->store = NULL;
	const eskel_store_options options = {.least_free_bytes = UINT64_MAX};
	assert_ok(eskel_store_open(f->path, &options, &f->store, &f->error), f);
	eskel_folder *folder = open_folder(f);
	assert_ok(eskel_file_create(folder, "a", &file, &f->error), f);
	assert_int_equal(eskel_file_write(file, "a", 1, &f->error), ESKEL_STORE_FULL);
	eskel_file_discard(file);
	eskel_folder_close(folder);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		store_test(jobs_outlive_the_store_in_their_order),
		store_test(a_job_is_there_once_and_one_that_is_gone_stays_so),
		store_test(a_file_that_is_kept_is_there_after_a_restart_and_its_owners_alone),
		store_test(a_damaged_file_is_found),
		store_test(what_is_unfinished_or_unwanted_is_removed),
		store_test(a_folder_that_is_not_ours_alone_is_refused),
		store_test(a_disk_with_too_little_room_takes_no_file),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
