#include "shape.h"

#include "description.h"
#include "read.h"
#include "sha256.h"
#include "statement.h"
#include "status.h"
#include "warning.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

eskel_store_status esk_shape_find(
	sqlite3 *db, const char *id, int64_t *key, int64_t *revision, eskel_store_error *error)
{
	int64_t found[2] = {0, 0};
	esk_statement s = esk_statement_begin(db, "SELECT key, revision FROM shape WHERE id = ?");
	esk_bind_text(&s, id);
	bool is_there = esk_statement_row(&s);
	if (is_there) {
		found[0] = esk_column_int64(&s);
		found[1] = esk_column_int64(&s);
	}
	eskel_store_status status = esk_statement_end(&s, error);
	if (status == ESKEL_STORE_OK && !is_there)
		status = esk_status_fail(error, ESKEL_STORE_NOT_FOUND, "there is no shape with the id %.32s", id);
	if (status != ESKEL_STORE_OK)
		return status;
	if (key)
		*key = found[0];
	if (revision)
		*revision = found[1];
	return ESKEL_STORE_OK;
}

static void read_columns(esk_statement *s, eskel_shape *shape)
{
	shape->key = esk_column_int64(s);
	esk_column_copy(s, shape->id, sizeof shape->id);
	const void *digest;
	size_t size;
	esk_column_blob(s, &digest, &size);
	if (size == ESK_SHA256_BYTES)
		esk_hex(digest, size, shape->sha256);
	else
		esk_statement_fail(s, SQLITE_CORRUPT);
	shape->revision = esk_column_int64(s);
	esk_column_copy(s, shape->created, sizeof shape->created);
	shape->label = (int32_t)esk_column_int64(s);
	shape->voxels = (uint64_t)esk_column_int64(s);
	shape->volume = esk_column_double(s);
	for (int i = 0; i < 3; i++)
		shape->centre[i] = esk_column_double(s);
	shape->levels = (uint32_t)esk_column_int64(s);
	esk_description_read(s, &shape->description);
}

static eskel_store_status read_row(sqlite3 *db, int64_t key, eskel_shape *shape, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db,
		"SELECT key, id, sha256, revision, strftime('%Y-%m-%dT%H:%M:%SZ', created, 'unixepoch'), label,"
		" voxels, volume, centre_x, centre_y, centre_z, levels, " ESK_DESCRIPTION_COLUMNS
		" FROM shape WHERE key = ?");
	esk_bind_int64(&s, key);
	bool is_there = esk_statement_row(&s);
	if (is_there)
		read_columns(&s, shape);
	eskel_store_status status = esk_statement_end(&s, error);
	if (status == ESKEL_STORE_OK && !is_there)
		return esk_status_fail(error, ESKEL_STORE_NOT_FOUND, "there is no shape with the key %" PRId64, key);
	return status;
}

eskel_store_status esk_shape_read(sqlite3 *db, int64_t key, eskel_shape *shape, eskel_store_error *error)
{
	eskel_shape read = {.key = key};
	eskel_store_status status = read_row(db, key, &read, error);
	if (status == ESKEL_STORE_OK)
		status = esk_attributes_read(db, key, &read.description, error);
	if (status == ESKEL_STORE_OK)
		status = esk_warnings_read(db, key, &read.warnings, &read.warning_count, error);
	if (status != ESKEL_STORE_OK) {
		eskel_shape_clear(&read);
		return status;
	}
	*shape = read;
	return ESKEL_STORE_OK;
}

eskel_store_status eskel_store_shape(eskel_store *store, const char *id, eskel_shape *shape, eskel_store_error *error)
{
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	int64_t key = 0;
	status = esk_shape_find(db, id, &key, NULL, error);
	if (status == ESKEL_STORE_OK)
		status = esk_shape_read(db, key, shape, error);
	esk_read_end(store, db);
	return status;
}

eskel_store_status eskel_store_shape_by_key(
	eskel_store *store, int64_t key, eskel_shape *shape, eskel_store_error *error)
{
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = esk_shape_read(db, key, shape, error);
	esk_read_end(store, db);
	return status;
}

eskel_store_status eskel_store_count(eskel_store *store, uint64_t *count, eskel_store_error *error)
{
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	int64_t counted = 0;
	esk_statement s = esk_statement_begin(db, "SELECT count(*) FROM shape");
	if (esk_statement_row(&s))
		counted = esk_column_int64(&s);
	status = esk_statement_end(&s, error);
	esk_read_end(store, db);
	if (status == ESKEL_STORE_OK)
		*count = (uint64_t)counted;
	return status;
}

void eskel_shape_clear(eskel_shape *shape)
{
	free(shape->warnings);
	eskel_description_clear(&shape->description);
	memset(shape, 0, sizeof *shape);
}

void eskel_shapes_free(eskel_shape *shapes, size_t count)
{
	for (size_t i = 0; i < count; i++)
		eskel_shape_clear(&shapes[i]);
	free(shapes);
}
