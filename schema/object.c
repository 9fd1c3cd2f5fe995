#include "object.h"

#include "read.h"
#include "statement.h"
#include "status.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const struct {
	const char *name, *insert, *select;
} kinds[ESK_OBJECT_KINDS] = {
	[ESK_OBJECT_CLOUD] = {"cloud", "INSERT INTO cloud (shape, sha256, bytes) VALUES (?, ?, ?)",
		"SELECT shape, sha256, bytes FROM cloud WHERE shape = ?"},
	[ESK_OBJECT_SKELETON] = {"skeleton", "INSERT INTO skeleton (shape, sha256, bytes) VALUES (?, ?, ?)",
		"SELECT shape, sha256, bytes FROM skeleton WHERE shape = ?"},
	[ESK_OBJECT_SIGNATURE] = {"signature", "INSERT INTO signature (shape, sha256, bytes) VALUES (?, ?, ?)",
		"SELECT shape, sha256, bytes FROM signature WHERE shape = ?"},
};

eskel_store_status esk_object_write(
	sqlite3 *writer, esk_object_kind kind, int64_t shape, const esk_object *object, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(writer, kinds[kind].insert);
	esk_bind_int64(&s, shape);
	esk_bind_blob(&s, object->sha256, sizeof object->sha256);
	esk_bind_blob(&s, object->bytes, object->size);
	return esk_statement_run(&s, error);
}

eskel_store_status esk_object_read(
	esk_statement *s, esk_object_kind kind, esk_object_row *row, eskel_store_error *error)
{
	const void *stored;
	size_t stored_size;
	uint8_t computed[ESK_SHA256_BYTES];
	row->shape = esk_column_int64(s);
	esk_column_blob(s, &stored, &stored_size);
	esk_column_blob(s, &row->bytes, &row->size);
	if (s->result != SQLITE_ROW)
		return esk_status_of_sqlite(s->result, error);
	esk_sha256(row->bytes, row->size, computed);
	if (stored_size != sizeof computed || memcmp(stored, computed, sizeof computed) != 0)
		return esk_status_fail(error, ESKEL_STORE_CORRUPT,
			"the stored %s of the shape with the key %" PRId64 " does not match its SHA-256",
			kinds[kind].name, row->shape);
	return ESKEL_STORE_OK;
}

eskel_store_status esk_object_decoded(
	eskel_status decoded, esk_object_kind kind, int64_t shape, eskel_store_error *error)
{
	if (decoded == ESKEL_OK)
		return ESKEL_STORE_OK;
	if (decoded == ESKEL_NO_MEMORY)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	return esk_status_fail(error, ESKEL_STORE_CORRUPT,
		"the stored %s of the shape with the key %" PRId64 " cannot be decoded: %s", kinds[kind].name, shape,
		eskel_status_text(decoded));
}

static eskel_store_status copy_row(
	esk_statement *s, esk_object_kind kind, uint8_t **bytes, size_t *size, eskel_store_error *error)
{
	esk_object_row row;
	eskel_store_status status = esk_object_read(s, kind, &row, error);
	if (status != ESKEL_STORE_OK)
		return status;
	uint8_t *copy = malloc(row.size ? row.size : 1);
	if (!copy)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	if (row.size)
		memcpy(copy, row.bytes, row.size);
	*bytes = copy;
	*size = row.size;
	return ESKEL_STORE_OK;
}

/* A verified copy of the bytes, free() it. */
static eskel_store_status fetch(eskel_store *store, esk_object_kind kind, int64_t shape, uint8_t **bytes, size_t *size,
	eskel_store_error *error)
{
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_statement s = esk_statement_begin(db, kinds[kind].select);
	esk_bind_int64(&s, shape);
	bool is_there = esk_statement_row(&s);
	if (is_there)
		status = copy_row(&s, kind, bytes, size, error);
	eskel_store_status ended = esk_statement_end(&s, status == ESKEL_STORE_OK ? error : NULL);
	esk_read_end(store, db);
	if (status == ESKEL_STORE_OK)
		status = ended;
	if (status == ESKEL_STORE_OK && !is_there)
		status =
			esk_status_fail(error, ESKEL_STORE_NOT_FOUND, "there is no shape with the key %" PRId64, shape);
	return status;
}

eskel_store_status eskel_store_cloud(eskel_store *store, int64_t key, eskel_cloud **cloud, eskel_store_error *error)
{
	uint8_t *bytes = NULL;
	size_t size = 0;
	eskel_store_status status = fetch(store, ESK_OBJECT_CLOUD, key, &bytes, &size, error);
	if (status == ESKEL_STORE_OK)
		status = esk_object_decoded(eskel_cloud_decode(bytes, size, cloud, NULL), ESK_OBJECT_CLOUD, key, error);
	free(bytes);
	return status;
}

eskel_store_status eskel_store_skeleton(
	eskel_store *store, int64_t key, eskel_skeleton **skeleton, eskel_store_error *error)
{
	uint8_t *bytes = NULL;
	size_t size = 0;
	eskel_store_status status = fetch(store, ESK_OBJECT_SKELETON, key, &bytes, &size, error);
	if (status == ESKEL_STORE_OK)
		status = esk_object_decoded(
			eskel_skeleton_decode(bytes, size, skeleton, NULL), ESK_OBJECT_SKELETON, key, error);
	free(bytes);
	return status;
}

eskel_store_status eskel_store_signature(
	eskel_store *store, int64_t key, eskel_signature **signature, eskel_store_error *error)
{
	uint8_t *bytes = NULL;
	size_t size = 0;
	eskel_store_status status = fetch(store, ESK_OBJECT_SIGNATURE, key, &bytes, &size, error);
	if (status == ESKEL_STORE_OK)
		status = esk_object_decoded(
			eskel_signature_decode(bytes, size, signature, NULL), ESK_OBJECT_SIGNATURE, key, error);
	free(bytes);
	return status;
}
