#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "crash/fault_vfs.h"
#include "failing_allocations.h"
#include "store_fixture.h"
#include "store_sample.h"

#include <math.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------------------------ memory */

static sqlite3_mem_methods sqlite_memory;

static void *sqlite_malloc(int size)
{
	return failing_allocations_next() ? NULL : sqlite_memory.xMalloc(size);
}

static void *sqlite_realloc(void *memory, int size)
{
	return failing_allocations_next() ? NULL : sqlite_memory.xRealloc(memory, size);
}

/* ------------------------------------------------------------------------------------------------ helpers */

static uint64_t stored_count(store_fixture *f)
{
	uint64_t count = 0;
	assert_ok(eskel_store_count(f->store, &count, &f->error), f);
	return count;
}

static void assert_audit_is_whole(store_fixture *f)
{
	uint64_t rows;
	assert_ok(eskel_store_audit_verify(f->store, &rows, &f->error), f);
}

static void delete_all(store_fixture *f)
{
	eskel_filter none = eskel_filter_none();
	eskel_shape *shapes = NULL;
	size_t count;
	bool more;
	int64_t key;
	assert_ok(eskel_store_list(f->store, &none, 0, 1000, &shapes, &count, &more, &f->error), f);
	for (size_t i = 0; i < count; i++)
		assert_ok(eskel_store_delete(f->store, NULL, shapes[i].id, 0, &key, &f->error), f);
	eskel_shapes_free(shapes, count);
}

/* ------------------------------------------------------------------------------------------------ tests */

/* Some allocations SQLite can do without, so a call may succeed; it must then have done all of its work. */
static void an_enrollment_that_runs_out_of_memory_anywhere_leaves_nothing(void **state)
{
	store_fixture *f = *state;
	sample s = sample_new(1);
	eskel_attribute attributes[] = {{"a", "1"}, {"b", "2"}};
	s.description = (eskel_description){
		.name = "n", .class = "c", .age = NAN, .attribute_count = 2, .attributes = attributes};
	const eskel_warning warning = {ESKEL_WARNING_FLAT, "flat"};
	eskel_enrollment enrollment = sample_enrollment(&s, 1);
	enrollment.warnings = &warning;
	enrollment.warning_count = 1;
	int refused = 0;
	bool reached = true;
	for (int n = 1; reached; n++) {
		eskel_shape shape;
		bool created;
		failing_allocations_begin(n - 1);
		eskel_store_status status =
			eskel_store_enroll(f->store, NULL, &enrollment, 1, &shape, &created, &f->error);
		reached = failing_allocations_end();
		if (status != ESKEL_STORE_OK && status != ESKEL_STORE_NO_MEMORY)
			fail_msg("allocation %d: %s", n, f->error.text);
		assert_int_equal(stored_count(f), status == ESKEL_STORE_OK);
		refused += status != ESKEL_STORE_OK;
		if (status == ESKEL_STORE_OK)
			eskel_shape_clear(&shape);
		delete_all(f);
	}
	assert_true(refused > 10);
	assert_audit_is_whole(f);
	sample_free(&s);
}

static void an_open_that_runs_out_of_memory_anywhere_can_be_repeated(void **state)
{
	store_fixture *f = *state;
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
	bool reached = true;
	for (int n = 1; reached; n++) {
		eskel_store_close(f->store);
		f->store = NULL;
		failing_allocations_begin(n - 1);
		eskel_store_status status = eskel_store_open(f->path, NULL, &f->store, &f->error);
		reached = failing_allocations_end();
		if (status != ESKEL_STORE_OK && status != ESKEL_STORE_NO_MEMORY)
			fail_msg("allocation %d: %s", n, f->error.text);
		assert_true((status == ESKEL_STORE_OK) == (f->store != NULL));
	}
	assert_int_equal(stored_count(f), 1);
}

static void a_list_that_runs_out_of_memory_anywhere_can_be_repeated(void **state)
{
	store_fixture *f = *state;
	for (uint32_t i = 0; i < 3; i++)
		assert_ok(sample_enroll(f->store, i, NULL, &f->error), f);
	eskel_filter filter = eskel_filter_none();
	bool reached = true;
	for (int n = 1; reached; n++) {
		eskel_shape *shapes = NULL;
		size_t count = 0;
		bool more;
		failing_allocations_begin(n - 1);
		eskel_store_status status =
			eskel_store_list(f->store, &filter, 0, 10, &shapes, &count, &more, &f->error);
		reached = failing_allocations_end();
		if (status == ESKEL_STORE_OK)
			assert_int_equal(count, 3);
		else
			assert_int_equal(status, ESKEL_STORE_NO_MEMORY);
		eskel_shapes_free(shapes, count);
	}
}

static void the_classes_are_whole_or_refused_wherever_memory_ran_out(void **state)
{
	store_fixture *f = *state;
	for (uint32_t i = 0; i < 3; i++) {
		static char names[3][2] = {"a", "b", "c"};
		sample s = sample_new(i);
		eskel_shape shape;
		bool created;
		s.description.class = names[i];
		eskel_enrollment enrollment = sample_enrollment(&s, 1);
		assert_ok(eskel_store_enroll(f->store, NULL, &enrollment, 1, &shape, &created, &f->error), f);
		eskel_shape_clear(&shape);
		sample_free(&s);
	}
	bool reached = true;
	for (int n = 1; reached; n++) {
		char **classes = NULL;
		size_t count = 0;
		failing_allocations_begin(n - 1);
		eskel_store_status status = eskel_store_classes(f->store, &classes, &count, &f->error);
		reached = failing_allocations_end();
		if (status == ESKEL_STORE_OK)
			assert_int_equal(count, 3);
		else
			assert_int_equal(status, ESKEL_STORE_NO_MEMORY);
		eskel_store_classes_free(classes, count);
	}
}

static size_t found_count(store_fixture *f, const eskel_filter *filter)
{
	eskel_key_block *keys = NULL;
	size_t blocks = 0, count = 0;
	assert_ok(eskel_store_keys(f->store, filter, &keys, &blocks, &f->error), f);
	for (size_t i = 0; i < blocks; i++)
		count += (size_t)__builtin_popcountll(keys[i].members);
	free(keys);
	return count;
}

/* What is kept in memory is right, or the database is asked. */
static void filters_find_all_wherever_memory_ran_out(void **state)
{
	store_fixture *f = *state;
	eskel_attribute attributes[] = {{"a", "1"}, {"b", "2"}};
	eskel_filter filter = eskel_filter_none();
	sample samples[2] = {sample_new(0), sample_new(1)};
	eskel_enrollment enrollments[2];
	filter.class = "c";
	filter.attribute_count = 2;
	filter.attributes = attributes;
	for (int i = 0; i < 2; i++) {
		samples[i].description = (eskel_description){
			.class = "c", .subject = "s", .age = NAN, .attribute_count = 2, .attributes = attributes};
		enrollments[i] = sample_enrollment(&samples[i], 1);
	}
	eskel_shape shape;
	bool created, reached = true;
	assert_ok(eskel_store_enroll(f->store, NULL, &enrollments[0], 1, &shape, &created, &f->error), f);
	eskel_shape_clear(&shape);
	for (int n = 1; reached; n++) {
		store_reopen(f);
		failing_allocations_begin(n - 1);
		eskel_store_status status = eskel_store_keep_descriptions(f->store, &f->error);
		reached = failing_allocations_end();
		assert_true(status == ESKEL_STORE_OK || status == ESKEL_STORE_NO_MEMORY);
		assert_int_equal(found_count(f, &filter), 1);
	}
	reached = true;
	for (int n = 1; reached; n++) {
		store_reopen(f);
		assert_ok(eskel_store_keep_descriptions(f->store, &f->error), f);
		failing_allocations_begin(n - 1);
		eskel_store_status status =
			eskel_store_enroll(f->store, NULL, &enrollments[1], 1, &shape, &created, &f->error);
		reached = failing_allocations_end();
		assert_int_equal(found_count(f, &filter), status == ESKEL_STORE_OK ? 2 : 1);
		if (status != ESKEL_STORE_OK)
			continue;
		assert_ok(eskel_store_delete(f->store, NULL, shape.id, 0, NULL, &f->error), f);
		assert_int_equal(found_count(f, &filter), 1);
		eskel_shape_clear(&shape);
	}
	sample_free(&samples[0]);
	sample_free(&samples[1]);
}

static void a_disk_that_fills_at_any_write_leaves_the_shape_out_and_the_store_usable(void **state)
{
	store_fixture *f = *state;
	assert_ok(sample_enroll(f->store, 0, NULL, &f->error), f);
	bool reached = true;
	for (int n = 1; reached; n++) {
		fault_vfs_fail(FAULT_VFS_WRITE, SQLITE_OPEN_WAL, n, SQLITE_FULL);
		eskel_store_status status = sample_enroll(f->store, 1, NULL, &f->error);
		assert_int_equal(stored_count(f), status == ESKEL_STORE_OK ? 2 : 1);
		reached = fault_vfs_heal() > 0;
		assert_int_equal(status, reached ? ESKEL_STORE_FULL : ESKEL_STORE_OK);
		assert_ok(eskel_store_ready(f->store, &f->error), f);
	}
	assert_audit_is_whole(f);
}

static void after_a_failed_sync_the_store_only_reads_until_it_is_opened_again(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape;
	int64_t key;
	assert_ok(sample_enroll(f->store, 1, &shape, &f->error), f);
	fault_vfs_fail(FAULT_VFS_SYNC, SQLITE_OPEN_WAL, 1, SQLITE_IOERR_FSYNC);
	assert_int_equal(sample_enroll(f->store, 2, NULL, &f->error), ESKEL_STORE_IO);
	assert_int_equal(fault_vfs_heal(), 1);
	assert_int_equal(sample_enroll(f->store, 2, NULL, &f->error), ESKEL_STORE_READ_ONLY);
	assert_int_equal(eskel_store_delete(f->store, NULL, shape.id, 0, &key, &f->error), ESKEL_STORE_READ_ONLY);
	assert_int_equal(eskel_store_ready(f->store, &f->error), ESKEL_STORE_READ_ONLY);
	assert_int_equal(stored_count(f), 1);
	store_reopen(f);
	assert_ok(eskel_store_ready(f->store, &f->error), f);
	/* The commit may have landed all the same: to repeat it is harmless. */
	assert_ok(sample_enroll(f->store, 2, NULL, &f->error), f);
	assert_int_equal(stored_count(f), 2);
	assert_audit_is_whole(f);
	eskel_shape_clear(&shape);
}

static void a_write_error_at_any_write_ends_the_writes_and_loses_nothing_acknowledged(void **state)
{
	store_fixture *f = *state;
	bool reached = true;
	for (uint32_t n = 1; reached; n++) {
		uint64_t before = stored_count(f);
		fault_vfs_fail(FAULT_VFS_WRITE, SQLITE_OPEN_WAL, (int)n, SQLITE_IOERR_WRITE);
		eskel_store_status status = sample_enroll(f->store, n, NULL, &f->error);
		reached = fault_vfs_heal() > 0;
		assert_int_equal(status, reached ? ESKEL_STORE_IO : ESKEL_STORE_OK);
		assert_int_equal(eskel_store_ready(f->store, NULL), reached ? ESKEL_STORE_READ_ONLY : ESKEL_STORE_OK);
		store_reopen(f);
		assert_true(stored_count(f) >= before + (status == ESKEL_STORE_OK));
	}
	assert_audit_is_whole(f);
}

static void a_checkpoint_that_fails_ends_the_writes_but_not_the_commit_before(void **state)
{
	store_fixture *f = *state;
	uint32_t enrolled = 0;
	fault_vfs_fail(FAULT_VFS_WRITE, SQLITE_OPEN_MAIN_DB, 1, SQLITE_IOERR_WRITE);
	while (enrolled < 1000 && eskel_store_ready(f->store, NULL) == ESKEL_STORE_OK)
		assert_ok(sample_enroll(f->store, enrolled++, NULL, &f->error), f);
	assert_true(fault_vfs_heal() > 0);
	assert_int_equal(eskel_store_ready(f->store, NULL), ESKEL_STORE_READ_ONLY);
	assert_int_equal(stored_count(f), enrolled);
	store_reopen(f);
	assert_int_equal(stored_count(f), enrolled);
	assert_audit_is_whole(f);
}

static void a_read_error_is_an_io_error_and_does_not_end_the_writes(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape;
	eskel_cloud *cloud = NULL;
	assert_ok(sample_enroll(f->store, 1, &shape, &f->error), f);
	store_reopen(f);
	fault_vfs_fail(FAULT_VFS_READ, SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_WAL, 1, SQLITE_IOERR_READ);
	assert_int_equal(eskel_store_cloud(f->store, shape.key, &cloud, &f->error), ESKEL_STORE_IO);
	assert_true(fault_vfs_heal() > 0);
	assert_ok(eskel_store_cloud(f->store, shape.key, &cloud, &f->error), f);
	assert_ok(eskel_store_ready(f->store, &f->error), f);
	eskel_cloud_free(cloud);
	eskel_shape_clear(&shape);
}

int main(void)
{
	sqlite3_config(SQLITE_CONFIG_GETMALLOC, &sqlite_memory);
	sqlite3_mem_methods failing = sqlite_memory;
	failing.xMalloc = sqlite_malloc;
	failing.xRealloc = sqlite_realloc;
	sqlite3_config(SQLITE_CONFIG_MALLOC, &failing);
	fault_vfs_install(FAULT_VFS_PASS);
	const struct CMUnitTest tests[] = {
		store_test(an_enrollment_that_runs_out_of_memory_anywhere_leaves_nothing),
		store_test(an_open_that_runs_out_of_memory_anywhere_can_be_repeated),
		store_test(a_list_that_runs_out_of_memory_anywhere_can_be_repeated),
		store_test(the_classes_are_whole_or_refused_wherever_memory_ran_out),
		store_test(filters_find_all_wherever_memory_ran_out),
		store_test(a_disk_that_fills_at_any_write_leaves_the_shape_out_and_the_store_usable),
		store_test(after_a_failed_sync_the_store_only_reads_until_it_is_opened_again),
		store_test(a_write_error_at_any_write_ends_the_writes_and_loses_nothing_acknowledged),
		store_test(a_checkpoint_that_fails_ends_the_writes_but_not_the_commit_before),
		store_test(a_read_error_is_an_io_error_and_does_not_end_the_writes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
