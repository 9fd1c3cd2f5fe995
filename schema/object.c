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

/* Reads shape, sha256 and bytes; the bytes are the statement's until its next row. CORRUPT unless they match. */
static eskel_store_status read_row(esk_statement *s, esk_object_kind kind, int64_t *shape, const void **bytes,
	size_t *size, eskel_store_error *error)
{
	const void *stored;
	size_t stored_size;
	uint8_t computed[ESK_SHA256_BYTES];
	*shape = esk_column_int64(s);
	esk_column_blob(s, &stored, &stored_size);
	esk_column_blob(s, bytes, size);
	if (s->result != SQLITE_ROW)
		return esk_status_of_sqlite(s->result, error);
	esk_sha256(*bytes, *size, computed);
	if (stored_size != sizeof computed || memcmp(stored, computed, sizeof computed) != 0)
		return esk_status_fail(error, ESKEL_STORE_CORRUPT,
			"the stored %s of the shape with the key %" PRId64 " does not match its SHA-256",
			kinds[kind].name, *shape);
	return ESKEL_STORE_OK;
}

/* Bytes that match their checksum and yet do not decode were written by a faulty or a newer program. */
static eskel_store_status status_of_decode(
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

/* A copy of the bytes, free() it. */
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
	if (is_there) {
		const void *stored = NULL;
		status = read_row(&s, kind, &shape, &stored, size, error);
		if (status == ESKEL_STORE_OK && !(*bytes = malloc(*size)))
			status = esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
		if (status == ESKEL_STORE_OK)
			memcpy(*bytes, stored, *size);
	}
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
		status = status_of_decode(eskel_cloud_decode(bytes, size, cloud, NULL), ESK_OBJECT_CLOUD, key, error);
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
		status = status_of_decode(
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
		status = status_of_decode(
			eskel_signature_decode(bytes, size, signature, NULL), ESK_OBJECT_SIGNATURE, key, error);
	free(bytes);
	return status;
}

static eskel_store_status visit(esk_statement *s,
	bool (*each)(void *context, int64_t key, const eskel_signature *signature), void *context, bool *go_on,
	eskel_store_error *error)
{
	int64_t key = 0;
	const void *bytes = NULL;
	size_t size = 0;
	eskel_store_status status = read_row(s, ESK_OBJECT_SIGNATURE, &key, &bytes, &size, error);
	if (status != ESKEL_STORE_OK)
		return status;
	eskel_signature *signature = NULL;
	status = status_of_decode(
		eskel_signature_decode(bytes, size, &signature, NULL), ESK_OBJECT_SIGNATURE, key, error);
	if (status == ESKEL_STORE_OK)
		*go_on = each(context, key, signature);
	eskel_signature_free(signature);
	return status;
}

eskel_store_status eskel_store_each_signature(eskel_store *store,
	bool (*each)(void *context, int64_t key, const eskel_signature *signature), void *context,
	eskel_store_error *error)
{
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	bool go_on = true;
	esk_statement s = esk_statement_begin(db, "SELECT shape, sha256, bytes FROM signature ORDER BY shape");
	while (go_on && status == ESKEL_STORE_OK && esk_statement_row(&s))
		status = visit(&s, each, context, &go_on, error);
	eskel_store_status ended = esk_statement_end(&s, status == ESKEL_STORE_OK ? error : NULL);
	esk_read_end(store, db);
	return status == ESKEL_STORE_OK ? ended : status;
}
