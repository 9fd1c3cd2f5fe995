#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "connection.h"
#include "migrate.h"
#include "store_fixture.h"
#include "store_sample.h"

#include <dirent.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void close_store(store_fixture *f)
{
	eskel_store_close(f->store);
	f->store = NULL;
}

static eskel_store_status open_store(store_fixture *f, const char *path)
{
	return eskel_store_open(path, NULL, &f->store, &f->error);
}

/* The one number that the statement answers, by a connection that nobody hardened. */
static int64_t ask(const char *path, const char *sql)
{
	sqlite3 *db = NULL;
	sqlite3_stmt *s = NULL;
	assert_int_equal(sqlite3_open_v2(path, &db, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &s, NULL), SQLITE_OK);
	assert_int_equal(sqlite3_step(s), SQLITE_ROW);
	int64_t answer = sqlite3_column_int64(s, 0);
	sqlite3_finalize(s);
	sqlite3_close(db);
	return answer;
}

static int files_in(const char *folder)
{
	DIR *entries = opendir(folder);
	int count = 0;
	for (struct dirent *entry; (entry = readdir(entries));)
		count += entry->d_name[0] != '.';
	closedir(entries);
	return count;
}

static void a_new_database_is_its_owners_alone_and_says_whose_it_is(void **state)
{
	store_fixture *f = *state;
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
	static const char *const suffixes[] = {"", "-wal", "-shm", "-lock"};
	for (int i = 0; i < 4; i++) {
		struct stat info;
		char *path = NULL;
		assert_true(asprintf(&path, "%s%s", f->path, suffixes[i]) > 0);
		if (stat(path, &info) != 0)
			fail_msg("there is no %s", path);
		assert_int_equal(info.st_mode & 0777, 0600);
		free(path);
	}
	assert_int_equal(ask(f->path, "PRAGMA application_id"), 0x45534b4c);
	assert_int_equal(ask(f->path, "PRAGMA user_version"), 4);
}

static void a_second_open_is_locked_until_the_first_closes(void **state)
{
	store_fixture *f = *state;
	eskel_store *second = NULL;
	eskel_store_error error;
	assert_int_equal(eskel_store_open(f->path, NULL, &second, &error), ESKEL_STORE_LOCKED);
	assert_null(second);
	assert_non_null(strstr(error.text, f->path));
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
	close_store(f);
	assert_ok(open_store(f, f->path), f);
}

static void another_process_is_locked_out_by_any_name_of_the_file(void **state)
{
	store_fixture *f = *state;
	char *link = scratch_path(f->folder, "link.db");
	assert_int_equal(symlink(f->path, link), 0);
	pid_t child = fork();
	if (child == 0) {
		eskel_store *second = NULL;
		_exit((int)eskel_store_open(link, NULL, &second, NULL));
	}
	int outcome = 0;
	assert_int_equal(waitpid(child, &outcome, 0), child);
	assert_true(WIFEXITED(outcome));
	assert_int_equal(WEXITSTATUS(outcome), ESKEL_STORE_LOCKED);
	free(link);
}

/* What the daemon's token commands do while it runs. */
static int administer(const char *path)
{
	const eskel_store_options options = {.beside_server = true};
	eskel_store *beside = NULL;
	eskel_token token;
	char text[ESKEL_TOKEN_TEXT_SIZE];
	if (eskel_store_open(path, &options, &beside, NULL) != ESKEL_STORE_OK)
		return 1;
	if (sample_enroll(beside, 2, NULL, NULL) != ESKEL_STORE_LOCKED)
		return 2;
	if (eskel_store_token_add(beside, "beside", ESKEL_ROLE_READ, 0, text, &token, NULL) != ESKEL_STORE_OK)
		return 3;
	eskel_store_close(beside);
	return 0;
}

static void beside_a_server_tokens_can_be_made_and_shapes_cannot_be_changed(void **state)
{
	store_fixture *f = *state;
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
	pid_t child = fork();
	if (child == 0)
		_exit(administer(f->path));
	int outcome = 0;
	assert_int_equal(waitpid(child, &outcome, 0), child);
	assert_true(WIFEXITED(outcome));
	assert_int_equal(WEXITSTATUS(outcome), 0);
	eskel_token *tokens = NULL;
	size_t count = 0;
	assert_ok(eskel_store_tokens(f->store, &tokens, &count, &f->error), f);
	assert_int_equal(count, 1);
	assert_string_equal(tokens[0].name, "beside");
	free(tokens);
	uint64_t rows = 0;
	assert_ok(eskel_store_audit_verify(f->store, &rows, &f->error), f);
	assert_int_equal(rows, 2);
}

static void assert_refused_untouched(store_fixture *f, const char *path, const char *reason)
{
	size_t size, size_after;
	int files = files_in(f->folder);
	uint8_t *before = file_read(path, &size);
	assert_int_equal(open_store(f, path), ESKEL_STORE_FOREIGN);
	assert_null(f->store);
	if (!strstr(f->error.text, reason))
		fail_msg("\"%s\" does not say \"%s\"", f->error.text, reason);
	uint8_t *after = file_read(path, &size_after);
	assert_int_equal(size, size_after);
	assert_memory_equal(before, after, size);
	assert_true(files_in(f->folder) <= files); /* no log, no lock */
	free(before);
	free(after);
}

static void a_file_that_is_no_database_is_refused_untouched(void **state)
{
	store_fixture *f = *state;
	close_store(f);
	char *path = scratch_path(f->folder, "notes.txt");
	file_write(path, "not a database", 14);
	assert_refused_untouched(f, path, "is not an SQLite database");
	char long_text[5000];
	memset(long_text, 'x', sizeof long_text);
	file_write(path, long_text, sizeof long_text);
	assert_refused_untouched(f, path, "is not an SQLite database");
	static const char zeros[4096];
	file_write(path, zeros, sizeof zeros);
	assert_refused_untouched(f, path, "not a database");
	free(path);
}

static void a_database_of_another_program_is_refused_untouched(void **state)
{
	store_fixture *f = *state;
	close_store(f);
	char *path = scratch_path(f->folder, "other.db");
	database_edit(path, "CREATE TABLE t (a)");
	assert_refused_untouched(f, path, "application id is 00000000, expected 45534b4c");
	database_edit(path, "PRAGMA journal_mode = WAL; PRAGMA application_id = 1");
	assert_refused_untouched(f, path, "application id is 00000001");
	free(path);
}

static void a_newer_schema_is_refused_untouched(void **state)
{
	store_fixture *f = *state;
	close_store(f);
	database_edit(f->path, "PRAGMA user_version = 5");
	assert_refused_untouched(f, f->path, "its schema is 5, expected at most 4");
	database_edit(f->path, "PRAGMA user_version = -1");
	assert_refused_untouched(f, f->path, "expected at most 4");
}

static void a_newer_schema_that_is_only_in_the_log_is_refused(void **state)
{
	store_fixture *f = *state;
	close_store(f);
	sqlite3 *db = NULL;
	assert_int_equal(sqlite3_open(f->path, &db), SQLITE_OK);
	assert_int_equal(sqlite3_exec(db, "PRAGMA user_version = 5", NULL, NULL, NULL), SQLITE_OK);
	assert_int_equal(open_store(f, f->path), ESKEL_STORE_FOREIGN);
	assert_non_null(strstr(f->error.text, "the schema is 5, expected at most 4"));
	sqlite3_close(db);
}

static void an_empty_file_becomes_a_new_database(void **state)
{
	store_fixture *f = *state;
	close_store(f);
	char *path = scratch_path(f->folder, "empty.db");
	file_write(path, "", 0);
	assert_ok(open_store(f, path), f);
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
	free(path);
}

static void a_folder_that_is_not_there_is_an_io_error(void **state)
{
	store_fixture *f = *state;
	close_store(f);
	assert_int_equal(open_store(f, "/no/such/folder/shapes.db"), ESKEL_STORE_IO);
	assert_non_null(strstr(f->error.text, "/no/such/folder/shapes.db cannot be created"));
	assert_int_equal(open_store(f, f->folder), ESKEL_STORE_IO);
}

/* The bytes behind the header of a table's root page say where its cells are. */
static void damage_a_table(store_fixture *f)
{
	for (uint32_t i = 0; i < 30; i++)
		assert_ok(sample_enroll(f->store, i, NULL, &f->error), f);
	close_store(f);
	int64_t root = ask(f->path, "SELECT rootpage FROM sqlite_schema WHERE name = 'shape'");
	size_t size;
	uint8_t *file = file_read(f->path, &size);
	memset(file + (root - 1) * 16384 + 8, 0xff, 40);
	file_write(f->path, file, size);
	free(file);
}

static void a_damaged_table_is_found_at_the_open(void **state)
{
	store_fixture *f = *state;
	damage_a_table(f);
	assert_int_equal(open_store(f, f->path), ESKEL_STORE_CORRUPT);
	assert_null(f->store);
}

static void a_damaged_table_is_found_by_a_check_that_was_left_for_later(void **state)
{
	store_fixture *f = *state;
	const eskel_store_options options = {.check_later = true};
	assert_ok(eskel_store_check(f->store, &f->error), f);
	damage_a_table(f);
	assert_ok(eskel_store_open(f->path, &options, &f->store, &f->error), f);
	assert_int_equal(eskel_store_check(f->store, &f->error), ESKEL_STORE_CORRUPT);
}

/* ------------------------------------------------------------------------------------------------ connection */

static int execute(sqlite3 *db, const char *sql)
{
	return sqlite3_exec(db, sql, NULL, NULL, NULL);
}

static void a_connection_takes_no_orders_from_its_file(void **state)
{
	store_fixture *f = *state;
	sqlite3 *db = NULL;
	assert_ok(esk_connection_open(f->path, ESK_CONNECTION_WRITE, &db, &f->error), f);
	assert_int_not_equal(execute(db, "SELECT \"a text\""), SQLITE_OK);
	assert_int_not_equal(execute(db, "ATTACH ':memory:' AS other"), SQLITE_OK);
	assert_int_not_equal(execute(db, "SELECT load_extension('x')"), SQLITE_OK);
	execute(db, "PRAGMA writable_schema = ON");
	assert_int_not_equal(execute(db, "UPDATE sqlite_schema SET sql = ''"), SQLITE_OK);
	assert_int_not_equal(execute(db, "INSERT INTO attribute VALUES (77, 'key', 'value')"), SQLITE_OK);
	assert_int_not_equal(execute(db, "INSERT INTO attribute VALUES ('no integer', 'key', 'value')"), SQLITE_OK);
	esk_connection_close(db);
}

static void a_planted_trigger_does_not_run(void **state)
{
	store_fixture *f = *state;
	store_edit(f, "CREATE TRIGGER planted AFTER INSERT ON shape BEGIN DELETE FROM shape; END");
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
	uint64_t count = 0;
	assert_ok(eskel_store_count(f->store, &count, &f->error), f);
	assert_int_equal(count, 1);
}

static void a_reading_connection_cannot_write(void **state)
{
	store_fixture *f = *state;
	sqlite3 *db = NULL;
	assert_ok(esk_connection_open(f->path, ESK_CONNECTION_READ, &db, &f->error), f);
	assert_int_equal(execute(db, "DELETE FROM shape") & 0xff, SQLITE_READONLY);
	esk_connection_close(db);
}

static void a_database_that_another_program_keeps_locked_is_busy(void **state)
{
	store_fixture *f = *state;
	sqlite3 *db = NULL;
	assert_int_equal(sqlite3_open(f->path, &db), SQLITE_OK);
	assert_int_equal(execute(db, "BEGIN IMMEDIATE"), SQLITE_OK);
	assert_int_equal(sample_enroll(f->store, 1, NULL, &f->error), ESKEL_STORE_BUSY);
	assert_int_equal(execute(db, "ROLLBACK"), SQLITE_OK);
	sqlite3_close(db);
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
}

/* ------------------------------------------------------------------------------------------------ steps */

static void each_step_runs_once_and_a_failing_one_leaves_nothing(void **state)
{
	static const char *const steps[] = {
		"CREATE TABLE a (x); INSERT INTO a VALUES (1)",
		"INSERT INTO a VALUES (2); CREATE TABLE b (x)",
		"INSERT INTO a VALUES (3); CREATE TABLE a (x)",
		"INSERT INTO a VALUES (4)",
	};
	store_fixture *f = *state;
	char *path = scratch_path(f->folder, "steps.db");
	file_write(path, "", 0);
	sqlite3 *db = NULL;
	assert_ok(esk_connection_open(path, ESK_CONNECTION_WRITE, &db, &f->error), f);
	assert_ok(esk_migrate(db, steps, 1, &f->error), f);
	assert_ok(esk_migrate(db, steps, 2, &f->error), f);
	assert_ok(esk_migrate(db, steps, 2, &f->error), f);
	assert_int_equal(ask(path, "SELECT sum(x) FROM a"), 3);
	assert_int_equal(esk_migrate(db, steps, 4, &f->error), ESKEL_STORE_IO);
	assert_int_equal(ask(path, "SELECT sum(x) FROM a"), 3);
	assert_int_equal(ask(path, "PRAGMA user_version"), 2);
	assert_int_equal(esk_migrate(db, steps, 1, &f->error), ESKEL_STORE_FOREIGN);
	esk_connection_close(db);
	free(path);
}

static void assert_holds_the_fixture(store_fixture *f)
{
	sample s = sample_new(1);
	char id[ESKEL_ID_SIZE], sha256[ESKEL_SHA256_SIZE];
	assert_int_equal(eskel_store_identify(s.cloud, id, sha256), ESKEL_STORE_OK);
	eskel_shape shape;
	assert_ok(eskel_store_shape(f->store, id, &shape, &f->error), f);
	assert_string_equal(shape.description.name, "left femur");
	assert_int_equal(shape.description.sex, ESKEL_SEX_MALE);
	assert_true(shape.description.age == 63);
	assert_int_equal(shape.description.attribute_count, 2);
	assert_string_equal(shape.description.attributes[1].value, "Zürich");
	assert_int_equal(shape.warning_count, 1);
	assert_int_equal(shape.voxels, s.cloud->voxels);
	eskel_cloud *cloud = NULL;
	eskel_skeleton *skeleton = NULL;
	eskel_signature *signature = NULL;
	assert_ok(eskel_store_cloud(f->store, shape.key, &cloud, &f->error), f);
	assert_ok(eskel_store_skeleton(f->store, shape.key, &skeleton, &f->error), f);
	assert_ok(eskel_store_signature(f->store, shape.key, &signature, &f->error), f);
	assert_int_equal(cloud->voxels, s.cloud->voxels);
	assert_int_equal(skeleton->level_count, 3);
	assert_int_equal(signature->level_count, 3);
	eskel_cloud_free(cloud);
	eskel_skeleton_free(skeleton);
	eskel_signature_free(signature);
	eskel_shape_clear(&shape);
	sample_free(&s);
}

static void assert_holds_jobs(store_fixture *f, size_t expected)
{
	eskel_job *jobs = NULL;
	size_t count = 9;
	assert_ok(eskel_store_jobs(f->store, &jobs, &count, &f->error), f);
	assert_int_equal(count, expected);
	for (size_t i = 0; i < count; i++) {
		assert_string_equal(jobs[i].id, "000102030405060708090a0b0c0d0e0f");
		assert_non_null(strstr(jobs[i].request, "/distances"));
		assert_int_equal(jobs[i].state, ESKEL_JOB_QUEUED);
	}
	eskel_jobs_free(jobs, count);
}

static void assert_holds_surface(store_fixture *f, bool expected)
{
	eskel_fitted fitted = {0};
	eskel_surface *surface = NULL;
	const eskel_store_status status = eskel_store_surface(f->store, 1, 2, "deformed", &fitted, &f->error);
	assert_int_equal(status, expected ? ESKEL_STORE_OK : ESKEL_STORE_NOT_FOUND);
	if (!expected)
		return;
	assert_string_equal(fitted.summary, "{}");
	assert_int_equal(eskel_surface_decode(fitted.bytes, fitted.size, &surface, NULL), ESKEL_OK);
	assert_int_equal(eskel_surface_count(surface), 2);
	eskel_surface_free(surface);
	eskel_fitted_clear(&fitted);
}

static void a_database_of_every_step_opens_and_comes_up_to_date(void **state)
{
	store_fixture *f = *state;
	for (int step = 1; step <= 4; step++) {
		char name[64];
		snprintf(name, sizeof name, "fixtures/databases/schema_%03d.db", step);
		size_t size;
		uint8_t *file = file_read(name, &size);
		close_store(f);
		char *copy = scratch_path(f->folder, "copy.db");
		file_write(copy, file, size);
		assert_int_equal(ask(copy, "PRAGMA user_version"), step);
		assert_ok(open_store(f, copy), f);
		assert_int_equal(ask(copy, "PRAGMA user_version"), 4);
		assert_holds_the_fixture(f);
		assert_holds_jobs(f, step >= 3);
		assert_holds_surface(f, step >= 4);
		assert_ok(sample_enroll(f->store, 2, NULL, &f->error), f);
		uint64_t rows = 0;
		assert_ok(eskel_store_audit_verify(f->store, &rows, &f->error), f);
		assert_int_equal(rows, step == 1 ? 1 : 3);
		free(copy);
		free(file);
	}
}

static void an_open_store_is_ready(void **state)
{
	store_fixture *f = *state;
	assert_ok(eskel_store_ready(f->store, &f->error), f);
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f);
	assert_ok(eskel_store_ready(f->store, &f->error), f);
}

static void a_disk_with_too_little_room_takes_no_enrollment_but_a_deletion(void **state)
{
	store_fixture *f = *state;
	eskel_shape shape;
	int64_t key;
	assert_ok(sample_enroll(f->store, 1, &shape, &f->error), f);
	close_store(f);
	const eskel_store_options options = {.least_free_bytes = UINT64_MAX};
	assert_ok(eskel_store_open(f->path, &options, &f->store, &f->error), f);
	assert_int_equal(sample_enroll(f->store, 2, NULL, &f->error), ESKEL_STORE_FULL);
	assert_ok(eskel_store_delete(f->store, NULL, shape.id, 0, &key, &f->error), f);
	eskel_shape_clear(&shape);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		store_test(a_new_database_is_its_owners_alone_and_says_whose_it_is),
		store_test(a_second_open_is_locked_until_the_first_closes),
		store_test(another_process_is_locked_out_by_any_name_of_the_file),
		store_test(beside_a_server_tokens_can_be_made_and_shapes_cannot_be_changed),
		store_test(a_file_that_is_no_database_is_refused_untouched),
		store_test(a_database_of_another_program_is_refused_untouched),
		store_test(a_newer_schema_is_refused_untouched),
		store_test(a_newer_schema_that_is_only_in_the_log_is_refused),
		store_test(an_empty_file_becomes_a_new_database),
		store_test(a_folder_that_is_not_there_is_an_io_error),
		store_test(a_damaged_table_is_found_at_the_open),
		store_test(a_damaged_table_is_found_by_a_check_that_was_left_for_later),
		store_test(a_connection_takes_no_orders_from_its_file),
		store_test(a_planted_trigger_does_not_run),
		store_test(a_reading_connection_cannot_write),
		store_test(a_database_that_another_program_keeps_locked_is_busy),
		store_test(each_step_runs_once_and_a_failing_one_leaves_nothing),
		store_test(a_database_of_every_step_opens_and_comes_up_to_date),
		store_test(an_open_store_is_ready),
		store_test(a_disk_with_too_little_room_takes_no_enrollment_but_a_deletion),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
