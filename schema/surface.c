/* Fitted surfaces: one a shape, level and kind of primitive; the last that was fitted. */
#include "read.h"
#include "sha256.h"
#include "statement.h"
#include "status.h"
#include "write.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	int64_t key;
	const eskel_fitted *fitted;
	uint8_t sha256[ESK_SHA256_BYTES];
} insertion;

void eskel_fitted_clear(eskel_fitted *fitted)
{
	free(fitted->summary);
	free(fitted->bytes);
	*fitted = (eskel_fitted){0};
}

static eskel_store_status insert(sqlite3 *writer, void *context, eskel_store_error *error)
{
	const insertion *i = context;
	esk_statement s = esk_statement_begin(writer,
		"INSERT OR REPLACE INTO surface (shape, level, primitive, summary, sha256, bytes)"
		" SELECT key, ?, ?, ?, ?, ? FROM shape WHERE key = ?");
	esk_bind_int64(&s, i->fitted->level);
	esk_bind_text(&s, i->fitted->primitive);
	esk_bind_text(&s, i->fitted->summary);
	esk_bind_blob(&s, i->sha256, sizeof i->sha256);
	esk_bind_blob(&s, i->fitted->bytes, i->fitted->size);
	esk_bind_int64(&s, i->key);
	eskel_store_status status = esk_statement_run(&s, error);
	if (status == ESKEL_STORE_OK && sqlite3_changes(writer) == 0)
		return esk_status_fail(error, ESKEL_STORE_NOT_FOUND, "the shape is gone");
	return status;
}

eskel_store_status eskel_store_surface_put(
	eskel_store *store, int64_t key, const eskel_fitted *fitted, eskel_store_error *error)
{
	insertion i = {.key = key, .fitted = fitted};
	esk_sha256(fitted->bytes, fitted->size, i.sha256);
	return esk_write(store, insert, &i, error);
}

/* The summary and the bytes, verified. */
static void read_row(esk_statement *s, eskel_fitted *read)
{
	const void *stored, *bytes;
	size_t stored_size, size;
	uint8_t digest[ESK_SHA256_BYTES];
	read->summary = esk_column_text(s);
	esk_column_blob(s, &stored, &stored_size);
	esk_column_blob(s, &bytes, &size);
	esk_sha256(bytes, size, digest);
	if (stored_size != sizeof digest || memcmp(stored, digest, sizeof digest) != 0) {
		esk_statement_fail(s, SQLITE_CORRUPT);
		return;
	}
	esk_hex(digest, sizeof digest, read->sha256);
	read->bytes = malloc(size + 1);
	if (!read->bytes) {
		esk_statement_fail(s, SQLITE_NOMEM);
		return;
	}
	memcpy(read->bytes, bytes, size);
	read->size = size;
}

eskel_store_status eskel_store_surface(eskel_store *store, int64_t key, uint32_t level, const char *primitive,
	eskel_fitted *fitted, eskel_store_error *error)
{
	eskel_fitted read = {.level = level, .primitive = primitive};
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_statement s = esk_statement_begin(
		db, "SELECT summary, sha256, bytes FROM surface WHERE shape = ? AND level = ? AND primitive = ?");
	esk_bind_int64(&s, key);
	esk_bind_int64(&s, level);
	esk_bind_text(&s, primitive);
	if (esk_statement_row(&s))
		read_row(&s, &read);
	status = esk_statement_end(&s, error);
	esk_read_end(store, db);
	if (status == ESKEL_STORE_OK && !read.bytes)
		status = esk_status_fail(error, ESKEL_STORE_NOT_FOUND, "the level has no such surface");
	if (status == ESKEL_STORE_OK)
		*fitted = read;
	else
		eskel_fitted_clear(&read);
	return status;
}
