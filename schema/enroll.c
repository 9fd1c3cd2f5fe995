/* Enrollment: everything that is slow (encoding, hashing) before the transaction, all rows or none in it.
 *
 * The id is a digest of the cloud, so a call is harmless to repeat: when a commit failed and yet landed, the second try
 * finds its shapes there. */
#include "audit.h"
#include "description.h"
#include "file.h"
#include "object.h"
#include "shape.h"
#include "statement.h"
#include "status.h"
#include "warning.h"
#include "write.h"

#include <stdlib.h>
#include <string.h>

/* One enrollment on its way to the database. */
typedef struct {
	const eskel_enrollment *given;
	esk_object objects[ESK_OBJECT_KINDS];
	char id[ESKEL_ID_SIZE];
	bool created;
	eskel_shape shape; /* read back */
} draft;

typedef struct {
	const char *actor;
	draft *drafts;
	size_t count;
} batch;

/* The id is the first half of the digest. */
static void name_by_digest(const uint8_t sha256[ESK_SHA256_BYTES], char id[ESKEL_ID_SIZE])
{
	esk_hex(sha256, (ESKEL_ID_SIZE - 1) / 2, id);
}

eskel_store_status eskel_store_identify(
	const eskel_cloud *cloud, char id[ESKEL_ID_SIZE], char sha256[ESKEL_SHA256_SIZE])
{
	uint8_t *bytes = NULL, digest[ESK_SHA256_BYTES];
	size_t size = 0;
	eskel_status encoded = eskel_cloud_encode(cloud, &bytes, &size);
	if (encoded != ESKEL_OK)
		return encoded == ESKEL_NO_MEMORY ? ESKEL_STORE_NO_MEMORY : ESKEL_STORE_INVALID;
	esk_sha256(bytes, size, digest);
	free(bytes);
	name_by_digest(digest, id);
	esk_hex(digest, sizeof digest, sha256);
	return ESKEL_STORE_OK;
}

static eskel_status encode(const eskel_enrollment *given, esk_object_kind kind, esk_object *object)
{
	switch (kind) {
	case ESK_OBJECT_CLOUD:
		return eskel_cloud_encode(given->cloud, &object->bytes, &object->size);
	case ESK_OBJECT_SKELETON:
		return eskel_skeleton_encode(given->skeleton, &object->bytes, &object->size);
	default:
		return eskel_signature_encode(given->signature, &object->bytes, &object->size);
	}
}

static eskel_store_status prepare(draft *d, const eskel_enrollment *given, eskel_store_error *error)
{
	eskel_store_status status = esk_description_check(given->description, error);
	if (status != ESKEL_STORE_OK)
		return status;
	d->given = given;
	for (esk_object_kind kind = 0; kind < ESK_OBJECT_KINDS; kind++) {
		esk_object *object = &d->objects[kind];
		eskel_status encoded = encode(given, kind, object);
		if (encoded != ESKEL_OK)
			return esk_status_fail(error,
				encoded == ESKEL_NO_MEMORY ? ESKEL_STORE_NO_MEMORY : ESKEL_STORE_INVALID,
				"the shape cannot be encoded: %s", eskel_status_text(encoded));
		esk_sha256(object->bytes, object->size, object->sha256);
	}
	name_by_digest(d->objects[ESK_OBJECT_CLOUD].sha256, d->id);
	return ESKEL_STORE_OK;
}

/* The shape's own row, unless its id is there: created says which. */
static eskel_store_status insert_row(sqlite3 *writer, draft *d, eskel_store_error *error)
{
	const eskel_enrollment *given = d->given;
	esk_statement s = esk_statement_begin(writer,
		"INSERT INTO shape (sha256, label, voxels, volume, centre_x, centre_y, centre_z, levels,"
		" " ESK_DESCRIPTION_COLUMNS ") VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"
		" ON CONFLICT (id) DO NOTHING");
	esk_bind_blob(&s, d->objects[ESK_OBJECT_CLOUD].sha256, ESK_SHA256_BYTES);
	esk_bind_int64(&s, given->label);
	esk_bind_int64(&s, (int64_t)given->cloud->voxels);
	esk_bind_double(&s, eskel_cloud_volume(given->cloud));
	for (int i = 0; i < 3; i++)
		esk_bind_double(&s, given->skeleton->nodes[0].centre[i]);
	esk_bind_int64(&s, given->skeleton->level_count);
	esk_description_bind(&s, given->description);
	eskel_store_status status = esk_statement_run(&s, error);
	if (status == ESKEL_STORE_OK)
		d->created = sqlite3_changes(writer) == 1;
	return status;
}

static eskel_store_status insert_rest(sqlite3 *writer, const char *actor, const draft *d, eskel_store_error *error)
{
	const eskel_enrollment *given = d->given;
	int64_t key = sqlite3_last_insert_rowid(writer);
	eskel_store_status status = esk_attributes_write(writer, key, given->description, error);
	if (status == ESKEL_STORE_OK)
		status = esk_warnings_write(writer, key, given->warnings, given->warning_count, error);
	for (esk_object_kind kind = 0; kind < ESK_OBJECT_KINDS && status == ESKEL_STORE_OK; kind++)
		status = esk_object_write(writer, kind, key, &d->objects[kind], error);
	if (status == ESKEL_STORE_OK)
		status = esk_audit_append(writer,
			&(esk_audit_entry){.actor = actor, .action = "enroll", .shape = d->id, .revision = 1}, error);
	return status;
}

static eskel_store_status insert(sqlite3 *writer, void *context, eskel_store_error *error)
{
	batch *b = context;
	eskel_store_status status = ESKEL_STORE_OK;
	for (size_t i = 0; i < b->count && status == ESKEL_STORE_OK; i++) {
		draft *d = &b->drafts[i];
		int64_t key = 0;
		status = insert_row(writer, d, error);
		if (status == ESKEL_STORE_OK && d->created)
			status = insert_rest(writer, b->actor, d, error);
		if (status == ESKEL_STORE_OK)
			status = esk_shape_find(writer, d->id, &key, NULL, error);
		if (status == ESKEL_STORE_OK)
			status = esk_shape_read(writer, key, &d->shape, error);
	}
	return status;
}

static void put_in_memory(eskel_store *store, void *context)
{
	const batch *b = context;
	for (size_t i = 0; i < b->count; i++)
		if (b->drafts[i].created)
			esk_catalogue_put(store->catalogue, b->drafts[i].shape.key, b->drafts[i].given->description);
}

static void free_drafts(draft *drafts, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		for (esk_object_kind kind = 0; kind < ESK_OBJECT_KINDS; kind++)
			free(drafts[i].objects[kind].bytes);
		eskel_shape_clear(&drafts[i].shape);
	}
	free(drafts);
}

eskel_store_status eskel_store_enroll(eskel_store *store, const char *actor, const eskel_enrollment *enrollments,
	size_t count, eskel_shape *shapes, bool *created, eskel_store_error *error)
{
	eskel_store_status status = esk_file_check_room(store->path, store->least_free_bytes, error);
	if (status != ESKEL_STORE_OK)
		return status;
	batch b = {.actor = actor, .drafts = calloc(count ? count : 1, sizeof(draft)), .count = count};
	if (!b.drafts)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	for (size_t i = 0; i < count && status == ESKEL_STORE_OK; i++)
		status = prepare(&b.drafts[i], &enrollments[i], error);
	if (status == ESKEL_STORE_OK)
		status = esk_write_shapes(store, insert, put_in_memory, &b, error);
	for (size_t i = 0; i < count && status == ESKEL_STORE_OK; i++) {
		shapes[i] = b.drafts[i].shape;
		created[i] = b.drafts[i].created;
		b.drafts[i].shape = (eskel_shape){0};
	}
	free_drafts(b.drafts, count);
	return status;
}
