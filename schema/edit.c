/* Changes of a stored shape: a new description, or its end. */
#include "audit.h"
#include "description.h"
#include "shape.h"
#include "statement.h"
#include "status.h"
#include "write.h"

#include <inttypes.h>

typedef struct {
	const char *actor, *id;
	int64_t revision; /* expected, 0: any */
	const eskel_description *description;
	int64_t key;       /* of the shape found */
	eskel_shape shape; /* as described */
} edit;

/* Finds the shape; CONFLICT unless it has the expected revision. */
static eskel_store_status find(sqlite3 *writer, edit *e, int64_t *revision, eskel_store_error *error)
{
	eskel_store_status status = esk_shape_find(writer, e->id, &e->key, revision, error);
	if (status == ESKEL_STORE_OK && e->revision && e->revision != *revision)
		return esk_status_fail(error, ESKEL_STORE_CONFLICT,
			"the shape is at revision %" PRId64 ", expected %" PRId64, *revision, e->revision);
	return status;
}

static eskel_store_status update_row(sqlite3 *writer, const edit *e, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(writer,
		"UPDATE shape SET (" ESK_DESCRIPTION_COLUMNS ") = (?, ?, ?, ?, ?, ?), revision = revision + 1"
		" WHERE key = ?");
	esk_description_bind(&s, e->description);
	esk_bind_int64(&s, e->key);
	return esk_statement_run(&s, error);
}

static eskel_store_status describe(sqlite3 *writer, void *context, eskel_store_error *error)
{
	edit *e = context;
	int64_t revision = 0;
	eskel_store_status status = find(writer, e, &revision, error);
	if (status == ESKEL_STORE_OK)
		status = update_row(writer, e, error);
	if (status == ESKEL_STORE_OK)
		status = esk_attributes_write(writer, e->key, e->description, error);
	esk_audit_entry entry = {.actor = e->actor, .action = "describe", .shape = e->id, .revision = revision + 1};
	if (status == ESKEL_STORE_OK)
		status = esk_audit_append(writer, &entry, error);
	if (status == ESKEL_STORE_OK)
		status = esk_shape_read(writer, e->key, &e->shape, error);
	return status;
}

static void describe_in_memory(eskel_store *store, void *context)
{
	const edit *e = context;
	esk_catalogue_put(store->catalogue, e->key, e->description);
}

eskel_store_status eskel_store_describe(eskel_store *store, const char *actor, const char *id, int64_t revision,
	const eskel_description *description, eskel_shape *shape, eskel_store_error *error)
{
	edit e = {.actor = actor, .id = id, .revision = revision, .description = description};
	eskel_store_status status = esk_description_check(description, error);
	if (status == ESKEL_STORE_OK)
		status = esk_write_shapes(store, describe, describe_in_memory, &e, error);
	if (status == ESKEL_STORE_OK)
		*shape = e.shape;
	else
		eskel_shape_clear(&e.shape);
	return status;
}

static eskel_store_status remove_row(sqlite3 *writer, void *context, eskel_store_error *error)
{
	edit *e = context;
	int64_t revision = 0;
	eskel_store_status status = find(writer, e, &revision, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_statement s = esk_statement_begin(writer, "DELETE FROM shape WHERE key = ?");
	esk_bind_int64(&s, e->key);
	status = esk_statement_run(&s, error);
	esk_audit_entry entry = {.actor = e->actor, .action = "delete", .shape = e->id, .revision = revision};
	if (status == ESKEL_STORE_OK)
		status = esk_audit_append(writer, &entry, error);
	return status;
}

static void remove_from_memory(eskel_store *store, void *context)
{
	const edit *e = context;
	esk_catalogue_remove(store->catalogue, e->key);
}

eskel_store_status eskel_store_delete(
	eskel_store *store, const char *actor, const char *id, int64_t revision, int64_t *key, eskel_store_error *error)
{
	edit e = {.actor = actor, .id = id, .revision = revision};
	eskel_store_status status = esk_write_shapes(store, remove_row, remove_from_memory, &e, error);
	if (status == ESKEL_STORE_OK && key)
		*key = e.key;
	return status;
}
