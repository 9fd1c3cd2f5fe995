/* The audit's hash chain.
 *
 *	hash(n) = SHA-256(hash(n - 1) | number | time | revision | token | actor | action | shape)
 *
 * hash(0) is 32 zero bytes. Numbers are 8 bytes, least first, NULL as 0. A text is the byte 1, its UTF-8 and a zero
 * byte, or the byte 0 alone for NULL, so that no two rows have the same bytes. Rows are numbered from 1 without a gap.
 *
 * A changed, inserted or removed row breaks the chain at its place. Rows cut off the end are found by the highest
 * number that SQLite keeps in sqlite_sequence. Somebody who can write the file can also compute a new chain: to notice
 * that, keep the last hash elsewhere. */
#include "audit.h"

#include "read.h"
#include "sha256.h"
#include "statement.h"
#include "status.h"
#include "write.h"

#include <inttypes.h>
#include <nettle/sha2.h>
#include <string.h>
#include <time.h>

typedef struct {
	int64_t number, time;
	esk_audit_entry entry;
} row;

static void hash_number(struct sha256_ctx *context, int64_t number)
{
	uint8_t bytes[8];
	for (int i = 0; i < 8; i++)
		bytes[i] = (uint8_t)((uint64_t)number >> (8 * i));
	sha256_update(context, sizeof bytes, bytes);
}

static void hash_text(struct sha256_ctx *context, const char *text)
{
	uint8_t is_there = text != NULL;
	sha256_update(context, 1, &is_there);
	if (text)
		sha256_update(context, strlen(text) + 1, (const uint8_t *)text);
}

static void chain(const uint8_t before[ESK_SHA256_BYTES], const row *r, uint8_t hash[ESK_SHA256_BYTES])
{
	struct sha256_ctx context;
	sha256_init(&context);
	sha256_update(&context, ESK_SHA256_BYTES, before);
	hash_number(&context, r->number);
	hash_number(&context, r->time);
	hash_number(&context, r->entry.revision);
	hash_number(&context, r->entry.token);
	hash_text(&context, r->entry.actor);
	hash_text(&context, r->entry.action);
	hash_text(&context, r->entry.shape);
	sha256_digest(&context, ESK_SHA256_BYTES, hash);
}

static void read_hash(esk_statement *s, uint8_t hash[ESK_SHA256_BYTES])
{
	const void *bytes;
	size_t size;
	esk_column_blob(s, &bytes, &size);
	if (size == ESK_SHA256_BYTES)
		memcpy(hash, bytes, size);
	else
		esk_statement_fail(s, SQLITE_CORRUPT);
}

static eskel_store_status read_last(
	sqlite3 *db, int64_t *number, uint8_t hash[ESK_SHA256_BYTES], eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "SELECT number, hash FROM audit ORDER BY number DESC LIMIT 1");
	if (esk_statement_row(&s)) {
		*number = esk_column_int64(&s);
		read_hash(&s, hash);
	}
	return esk_statement_end(&s, error);
}

static void bind_number(esk_statement *s, int64_t number)
{
	if (number)
		esk_bind_int64(s, number);
	else
		esk_bind_text(s, NULL);
}

eskel_store_status esk_audit_append(sqlite3 *writer, const esk_audit_entry *entry, eskel_store_error *error)
{
	uint8_t before[ESK_SHA256_BYTES] = {0}, hash[ESK_SHA256_BYTES];
	int64_t last = 0;
	eskel_store_status status = read_last(writer, &last, before, error);
	if (status != ESKEL_STORE_OK)
		return status;
	row r = {.number = last + 1, .time = (int64_t)time(NULL), .entry = *entry};
	chain(before, &r, hash);
	esk_statement s = esk_statement_begin(writer,
		"INSERT INTO audit (number, time, revision, token, actor, action, shape, hash)"
		" VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
	esk_bind_int64(&s, r.number);
	esk_bind_int64(&s, r.time);
	bind_number(&s, r.entry.revision);
	bind_number(&s, r.entry.token);
	esk_bind_text(&s, r.entry.actor);
	esk_bind_text(&s, r.entry.action);
	esk_bind_text(&s, r.entry.shape);
	esk_bind_blob(&s, hash, sizeof hash);
	return esk_statement_run(&s, error);
}

static row read_row(esk_statement *s, uint8_t hash[ESK_SHA256_BYTES])
{
	row r;
	r.number = esk_column_int64(s);
	r.time = esk_column_int64(s);
	r.entry.revision = esk_column_int64(s);
	r.entry.token = esk_column_int64(s);
	r.entry.actor = esk_column_borrow(s);
	r.entry.action = esk_column_borrow(s);
	r.entry.shape = esk_column_borrow(s);
	read_hash(s, hash);
	return r;
}

/* Walks the chain up to its end or the first row that breaks it: *rows are sound. */
static eskel_store_status walk(sqlite3 *db, int64_t *rows, bool *broken, eskel_store_error *error)
{
	uint8_t before[ESK_SHA256_BYTES] = {0}, hash[ESK_SHA256_BYTES], expected[ESK_SHA256_BYTES];
	esk_statement s = esk_statement_begin(
		db, "SELECT number, time, revision, token, actor, action, shape, hash FROM audit ORDER BY number");
	while (!*broken && esk_statement_row(&s)) {
		row r = read_row(&s, hash);
		chain(before, &r, expected);
		*broken = r.number != *rows + 1 || memcmp(hash, expected, sizeof hash) != 0;
		if (!*broken)
			*rows = r.number;
		memcpy(before, hash, sizeof hash);
	}
	return esk_statement_end(&s, error);
}

static eskel_store_status read_highest(sqlite3 *db, int64_t *highest, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "SELECT seq FROM sqlite_sequence WHERE name = 'audit'");
	if (esk_statement_row(&s))
		*highest = esk_column_int64(&s);
	return esk_statement_end(&s, error);
}

eskel_store_status eskel_store_audit_verify(eskel_store *store, uint64_t *rows, eskel_store_error *error)
{
	int64_t sound = 0, highest = 0;
	bool broken = false;
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = walk(db, &sound, &broken, error);
	if (status == ESKEL_STORE_OK)
		status = read_highest(db, &highest, error);
	esk_read_end(store, db);
	if (status != ESKEL_STORE_OK)
		return status;
	if (broken || sound != highest)
		return esk_status_fail(error, ESKEL_STORE_CORRUPT, "audit row %" PRId64 " %s", sound + 1,
			broken ? "does not follow from the row before it" : "and those after it are gone");
	*rows = (uint64_t)sound;
	return ESKEL_STORE_OK;
}
