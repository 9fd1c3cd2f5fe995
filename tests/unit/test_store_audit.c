#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "store_fixture.h"
#include "store_sample.h"

#include <math.h>
#include <nettle/sha2.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

/* Six changes: enroll, describe, enroll, delete, token add, token revoke. */
static void make_history(store_fixture *f)
{
	const eskel_description description = {.age = NAN, .name = "x"};
	eskel_shape first, second, described;
	eskel_token token;
	char text[ESKEL_TOKEN_TEXT_SIZE];
	int64_t key;
	assert_ok(sample_enroll(f->store, 1, &first, &f->error), f);
	assert_ok(eskel_store_describe(f->store, "Zoë", first.id, 1, &description, &described, &f->error), f);
	assert_ok(sample_enroll(f->store, 2, &second, &f->error), f);
	assert_ok(eskel_store_delete(f->store, "me", second.id, 0, &key, &f->error), f);
	assert_ok(eskel_store_token_add(f->store, "t", ESKEL_ROLE_READ, 0, text, &token, &f->error), f);
	assert_ok(eskel_store_token_revoke(f->store, token.number, &f->error), f);
	eskel_shape_clear(&first);
	eskel_shape_clear(&second);
	eskel_shape_clear(&described);
}

static eskel_store_status verify(store_fixture *f, uint64_t *rows)
{
	return eskel_store_audit_verify(f->store, rows, &f->error);
}

static void each_change_has_one_row_and_no_other_call_has(void **state)
{
	store_fixture *f = *state;
	uint64_t rows = 9;
	assert_ok(verify(f, &rows), f);
	assert_int_equal(rows, 0);
	make_history(f);
	assert_ok(verify(f, &rows), f);
	assert_int_equal(rows, 6);
	int64_t key;
	assert_ok(sample_enroll(f->store, 1, NULL, &f->error), f); /* there already */
	assert_int_equal(eskel_store_delete(f->store, NULL, "none", 0, &key, NULL), ESKEL_STORE_NOT_FOUND);
	assert_int_equal(eskel_store_token_revoke(f->store, 7, NULL), ESKEL_STORE_NOT_FOUND);
	store_reopen(f);
	assert_ok(verify(f, &rows), f);
	assert_int_equal(rows, 6);
}

/* An auditor's own program: the chain as audit.c documents it, from the rows alone. */
static void put_number(struct sha256_ctx *context, int64_t number)
{
	const uint64_t n = (uint64_t)number;
	const uint8_t bytes[8] = {(uint8_t)n, (uint8_t)(n >> 8), (uint8_t)(n >> 16), (uint8_t)(n >> 24),
		(uint8_t)(n >> 32), (uint8_t)(n >> 40), (uint8_t)(n >> 48), (uint8_t)(n >> 56)};
	sha256_update(context, 8, bytes);
}

static void put_text(struct sha256_ctx *context, const unsigned char *text)
{
	sha256_update(context, 1, (const uint8_t *)(text ? "\1" : "\0"));
	if (text)
		sha256_update(context, strlen((const char *)text) + 1, text);
}

static void the_hashes_are_those_that_the_documented_form_gives(void **state)
{
	store_fixture *f = *state;
	make_history(f);
	sqlite3 *db = NULL;
	sqlite3_stmt *s = NULL;
	assert_int_equal(sqlite3_open_v2(f->path, &db, SQLITE_OPEN_READONLY, NULL), SQLITE_OK);
	assert_int_equal(
		sqlite3_prepare_v2(db, "SELECT number, time, revision, token, actor, action, shape, hash FROM audit",
			-1, &s, NULL),
		SQLITE_OK);
	uint8_t hash[32] = {0};
	int rows = 0;
	for (; sqlite3_step(s) == SQLITE_ROW; rows++) {
		struct sha256_ctx context;
		sha256_init(&context);
		sha256_update(&context, 32, hash);
		for (int column = 0; column < 4; column++)
			put_number(&context, sqlite3_column_int64(s, column));
		for (int column = 4; column < 7; column++)
			put_text(&context, sqlite3_column_text(s, column));
		sha256_digest(&context, 32, hash);
		assert_memory_equal(sqlite3_column_blob(s, 7), hash, 32);
	}
	assert_int_equal(rows, 6);
	sqlite3_finalize(s);
	sqlite3_close(db);
}

static void a_row_changed_inserted_or_removed_is_named(void **state)
{
	static const struct {
		const char *sql, *named;
	} edits[] = {
		{"UPDATE audit SET actor = 'you' WHERE number = 4", "audit row 4 "},
		{"UPDATE audit SET actor = NULL WHERE number = 2", "audit row 2 "},
		{"UPDATE audit SET time = time + 1 WHERE number = 1", "audit row 1 "},
		{"UPDATE audit SET revision = 7 WHERE number = 3", "audit row 3 "},
		{"UPDATE audit SET token = 2 WHERE number = 6", "audit row 6 "},
		{"UPDATE audit SET action = 'delete' WHERE number = 3", "audit row 3 "},
		{"UPDATE audit SET hash = zeroblob(32) WHERE number = 5", "audit row 5 "},
		{"DELETE FROM audit WHERE number = 3", "audit row 3 "},
		{"DELETE FROM audit WHERE number >= 5", "audit row 5 "},
		{"INSERT INTO audit (time, action, hash) VALUES (0, 'delete', zeroblob(32))", "audit row 7 "},
	};
	store_fixture *f = *state;
	make_history(f);
	eskel_store_close(f->store);
	f->store = NULL;
	size_t size;
	uint8_t *sound = file_read(f->path, &size);
	for (size_t i = 0; i < sizeof edits / sizeof edits[0]; i++) {
		uint64_t rows = 99;
		store_edit(f, edits[i].sql);
		assert_int_equal(verify(f, &rows), ESKEL_STORE_CORRUPT);
		if (!strstr(f->error.text, edits[i].named))
			fail_msg("%s: \"%s\", expected \"%s\"", edits[i].sql, f->error.text, edits[i].named);
		assert_int_equal(rows, 99);
		eskel_store_close(f->store);
		f->store = NULL;
		file_write(f->path, sound, size);
	}
	free(sound);
}

static void a_change_after_a_broken_row_does_not_mend_the_chain(void **state)
{
	store_fixture *f = *state;
	make_history(f);
	store_edit(f, "UPDATE audit SET actor = 'you' WHERE number = 4");
	assert_ok(sample_enroll(f->store, 3, NULL, &f->error), f);
	uint64_t rows;
	assert_int_equal(verify(f, &rows), ESKEL_STORE_CORRUPT);
	assert_non_null(strstr(f->error.text, "row 4 "));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		store_test(each_change_has_one_row_and_no_other_call_has),
		store_test(the_hashes_are_those_that_the_documented_form_gives),
		store_test(a_row_changed_inserted_or_removed_is_named),
		store_test(a_change_after_a_broken_row_does_not_mend_the_chain),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
