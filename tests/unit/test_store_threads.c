#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "crash/fault_vfs.h"
#include "store_fixture.h"
#include "store_sample.h"

#include <math.h>
#include <pthread.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* cmocka's assertions are for its own thread: the others count what is wrong, and leave the first in words. */
typedef struct {
	eskel_store *store;
	atomic_int wrong, writing, next;
	char first_wrong[300];
} arena;

static void expect(arena *a, bool holds, const char *what, const eskel_store_error *error)
{
	if (!holds && atomic_fetch_add(&a->wrong, 1) == 0)
		snprintf(a->first_wrong, sizeof a->first_wrong, "%s: %s", what, error ? error->text : "");
}

static void assert_nothing_wrong(const arena *a)
{
	if (a->wrong)
		fail_msg("%d things wrong, the first: %s", a->wrong, a->first_wrong);
}

static void expect_found(arena *a, const char *class, size_t expected)
{
	eskel_store_error error = {0};
	eskel_filter filter = eskel_filter_none();
	eskel_key_block *keys = NULL;
	size_t blocks = 0, count = 0;
	filter.class = class;
	eskel_store_status status = eskel_store_keys(a->store, &filter, &keys, &blocks, &error);
	for (size_t i = 0; i < blocks; i++)
		count += (size_t)__builtin_popcountll(keys[i].members);
	expect(a, status == ESKEL_STORE_OK && count == expected, "a filter after the call sees it", &error);
	free(keys);
}

enum { writers = 4, readers = 3, shapes_each = 30 };

/* Each shape is enrolled, read back at once, described twice (name and class always equal), and every third deleted. */
static void write_one(arena *a, uint32_t number)
{
	eskel_store_error error = {0};
	eskel_shape shape, read;
	int64_t key;
	char text[32];
	eskel_store_status status = sample_enroll(a->store, number, &shape, &error);
	expect(a, status == ESKEL_STORE_OK, "enroll", &error);
	if (status != ESKEL_STORE_OK)
		return;
	status = eskel_store_shape(a->store, shape.id, &read, &error);
	expect(a, status == ESKEL_STORE_OK && read.key == shape.key, "a read after the call sees it", &error);
	eskel_shape_clear(&read);
	for (int64_t revision = 1; revision <= 2; revision++) {
		snprintf(text, sizeof text, "%u-%d", number, (int)revision);
		const eskel_description d = {.age = NAN, .name = text, .class = text};
		status = eskel_store_describe(a->store, text, shape.id, revision, &d, &read, &error);
		expect(a, status == ESKEL_STORE_OK && read.revision == revision + 1, "describe", &error);
		expect_found(a, text, 1);
		eskel_shape_clear(&read);
	}
	const eskel_description late = {.age = NAN};
	status = eskel_store_describe(a->store, NULL, shape.id, 1, &late, &read, &error);
	expect(a, status == ESKEL_STORE_CONFLICT, "an old revision is a conflict", &error);
	if (number % 3 == 0)
		expect(a, eskel_store_delete(a->store, NULL, shape.id, 3, &key, &error) == ESKEL_STORE_OK, "delete",
			&error);
	expect_found(a, text, number % 3 == 0 ? 0 : 1);
	eskel_shape_clear(&shape);
}

static void *write_many(void *context)
{
	arena *a = context;
	uint32_t first = (uint32_t)atomic_fetch_add(&a->next, shapes_each);
	for (uint32_t i = 0; i < shapes_each; i++)
		write_one(a, first + i);
	atomic_fetch_sub(&a->writing, 1);
	return NULL;
}

static bool is_text(const char *text, const char *other)
{
	return text == other || (text && other && strcmp(text, other) == 0);
}

static bool ascends(void *context, int64_t key, uint32_t level_count)
{
	int64_t *last = context;
	bool sound = key > *last && level_count == 3;
	*last = sound ? key : INT64_MAX;
	return sound;
}

static void read_once(arena *a)
{
	eskel_store_error error = {0};
	eskel_filter none = eskel_filter_none();
	eskel_shape *shapes = NULL;
	size_t count = 0;
	bool more;
	eskel_store_status status = eskel_store_list(a->store, &none, 0, 1000, &shapes, &count, &more, &error);
	expect(a, status == ESKEL_STORE_OK, "list", &error);
	for (size_t i = 0; i < count; i++) {
		const eskel_description *d = &shapes[i].description;
		expect(a, is_text(d->name, d->class), "a shape is read at one moment", NULL);
		eskel_cloud *cloud = NULL;
		status = eskel_store_cloud(a->store, shapes[i].key, &cloud, &error);
		expect(a, status == ESKEL_STORE_OK || status == ESKEL_STORE_NOT_FOUND, "cloud", &error);
		eskel_cloud_free(cloud);
	}
	eskel_shapes_free(shapes, count);
	int64_t last = 0;
	status = store_each_signature(a->store, ascends, &last, &error);
	expect(a, status == ESKEL_STORE_OK && last != INT64_MAX, "signatures", &error);
	uint64_t rows;
	expect(a, eskel_store_audit_verify(a->store, &rows, &error) == ESKEL_STORE_OK, "audit", &error);
	expect(a, eskel_store_ready(a->store, &error) == ESKEL_STORE_OK, "ready", &error);
}

static void *read_until_written(void *context)
{
	arena *a = context;
	do
		read_once(a);
	while (atomic_load(&a->writing));
	return NULL;
}

static void readers_see_whole_shapes_while_writers_change_them(void **state)
{
	store_fixture *f = *state;
	arena a = {.store = f->store, .writing = writers};
	assert_ok(eskel_store_keep_descriptions(f->store, &f->error), f);
	pthread_t threads[writers + readers];
	for (int i = 0; i < writers + readers; i++)
		assert_int_equal(
			pthread_create(&threads[i], NULL, i < writers ? write_many : read_until_written, &a), 0);
	for (int i = 0; i < writers + readers; i++)
		pthread_join(threads[i], NULL);
	assert_nothing_wrong(&a);
	uint64_t count = 0, rows = 0;
	const int enrolled = writers * shapes_each, deleted = enrolled / 3;
	assert_ok(eskel_store_count(f->store, &count, &f->error), f);
	assert_ok(eskel_store_audit_verify(f->store, &rows, &f->error), f);
	assert_int_equal(count, enrolled - deleted);
	assert_int_equal(rows, 3 * enrolled + deleted);
}

static void *enroll_same(void *context)
{
	arena *a = context;
	eskel_store_error error = {0};
	for (uint32_t number = 0; number < 20; number++)
		expect(a, sample_enroll(a->store, number, NULL, &error) == ESKEL_STORE_OK, "enroll", &error);
	return NULL;
}

static void the_same_shapes_from_many_threads_are_stored_once(void **state)
{
	store_fixture *f = *state;
	arena a = {.store = f->store};
	pthread_t threads[writers];
	for (int i = 0; i < writers; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, enroll_same, &a), 0);
	for (int i = 0; i < writers; i++)
		pthread_join(threads[i], NULL);
	assert_nothing_wrong(&a);
	uint64_t count = 0, rows = 0;
	assert_ok(eskel_store_count(f->store, &count, &f->error), f);
	assert_ok(eskel_store_audit_verify(f->store, &rows, &f->error), f);
	assert_int_equal(count, 20);
	assert_int_equal(rows, 20);
}

/* ------------------------------------------------------------------------------------------------ group commit */

enum { clients = 8 };

static void *enroll_one(void *context)
{
	arena *a = context;
	eskel_store_error error = {0};
	uint32_t number = (uint32_t)atomic_fetch_add(&a->next, 1);
	expect(a, sample_enroll(a->store, number, NULL, &error) == ESKEL_STORE_OK, "enroll", &error);
	return NULL;
}

/* Another program holds the lock until all clients wait: then two commits do, the first one's and the others'. */
static void clients_that_wait_share_a_commit(void **state)
{
	const struct timespec until_all_wait = {.tv_nsec = 300000000};
	store_fixture *f = *state;
	arena a = {.store = f->store};
	pthread_t threads[clients];
	sqlite3 *other = NULL;
	assert_ok(sample_enroll(f->store, 1000, NULL, &f->error), f);
	assert_int_equal(sqlite3_open(f->path, &other), SQLITE_OK);
	assert_int_equal(sqlite3_exec(other, "BEGIN IMMEDIATE", NULL, NULL, NULL), SQLITE_OK);
	fault_vfs_fail(FAULT_VFS_SYNC, SQLITE_OPEN_WAL, 1, SQLITE_OK); /* counts only */
	for (int i = 0; i < clients; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, enroll_one, &a), 0);
	nanosleep(&until_all_wait, NULL);
	assert_int_equal(sqlite3_exec(other, "ROLLBACK", NULL, NULL, NULL), SQLITE_OK);
	for (int i = 0; i < clients; i++)
		pthread_join(threads[i], NULL);
	sqlite3_close(other);
	assert_nothing_wrong(&a);
	int syncs = fault_vfs_heal();
	if (syncs < 1 || syncs >= clients)
		fail_msg("%d syncs for %d enrollments", syncs, clients);
	uint64_t count = 0;
	assert_ok(eskel_store_count(f->store, &count, &f->error), f);
	assert_int_equal(count, clients + 1);
}

/* ------------------------------------------------------------------------------------------------ reading ahead */

enum { many = 2100 }; /* more than the scan of which is done before threads that read ahead would be */

static void enroll_many(store_fixture *f)
{
	sample *samples = calloc(many, sizeof samples[0]);
	eskel_enrollment *enrollments = calloc(many, sizeof enrollments[0]);
	eskel_shape *shapes = calloc(many, sizeof shapes[0]);
	bool *created = calloc(many, sizeof created[0]);
	for (uint32_t i = 0; i < many; i++) {
		samples[i] = sample_new(i);
		enrollments[i] = sample_enrollment(&samples[i], 1);
	}
	assert_ok(eskel_store_enroll(f->store, NULL, enrollments, many, shapes, created, &f->error), f);
	for (int i = 0; i < many; i++)
		sample_free(&samples[i]);
	eskel_shapes_free(shapes, many);
	free(samples);
	free(enrollments);
	free(created);
}

static bool count_up_to(void *context, int64_t key, uint32_t level_count)
{
	int64_t *left = context;
	(void)key;
	(void)level_count;
	return --*left > 0;
}

static void a_scan_that_reads_ahead_sees_every_signature_once_or_stops(void **state)
{
	store_fixture *f = *state;
	enroll_many(f);
	store_reopen(f);
	int64_t last = 0, left = many + 1;
	assert_ok(store_each_signature(f->store, ascends, &last, &f->error), f);
	assert_int_not_equal(last, INT64_MAX);
	assert_ok(store_each_signature(f->store, count_up_to, &left, &f->error), f);
	assert_int_equal(left, 1);
	left = 10;
	assert_ok(store_each_signature(f->store, count_up_to, &left, &f->error), f);
	assert_int_equal(left, 0);
}

/* Before the damage everything, after it nothing. */
static void a_scan_that_reads_ahead_ends_at_a_damaged_signature(void **state)
{
	enum { damaged = 1500 };
	store_fixture *f = *state;
	sqlite3 *other = NULL;
	enroll_many(f);
	store_reopen(f);
	assert_int_equal(sqlite3_open(f->path, &other), SQLITE_OK);
	assert_int_equal(
		sqlite3_exec(other, "UPDATE signature SET bytes = zeroblob(99) WHERE shape = 1500", NULL, NULL, NULL),
		SQLITE_OK);
	sqlite3_close(other);
	int64_t last = 0, left = many + 1;
	assert_int_equal(store_each_signature(f->store, ascends, &last, &f->error), ESKEL_STORE_CORRUPT);
	assert_non_null(strstr(f->error.text, "1500"));
	assert_int_equal(last, damaged - 1);
	assert_int_equal(store_each_signature(f->store, count_up_to, &left, &f->error), ESKEL_STORE_CORRUPT);
	assert_int_equal(left, many + 1 - (damaged - 1));
	left = damaged - 1;
	assert_ok(store_each_signature(f->store, count_up_to, &left, &f->error), f);
}

int main(void)
{
	fault_vfs_install(FAULT_VFS_PASS);
	const struct CMUnitTest tests[] = {
		store_test(readers_see_whole_shapes_while_writers_change_them),
		store_test(the_same_shapes_from_many_threads_are_stored_once),
		store_test(clients_that_wait_share_a_commit),
		store_test(a_scan_that_reads_ahead_sees_every_signature_once_or_stops),
		store_test(a_scan_that_reads_ahead_ends_at_a_damaged_signature),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
