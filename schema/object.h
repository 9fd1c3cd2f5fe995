/* The encoded cloud, skeleton and signature of a shape, each beside its SHA-256. */
#ifndef ESK_OBJECT_H
#define ESK_OBJECT_H

#include "eskel_store.h"
#include "sha256.h"
#include "statement.h"

typedef enum { ESK_OBJECT_CLOUD, ESK_OBJECT_SKELETON, ESK_OBJECT_SIGNATURE, ESK_OBJECT_KINDS } esk_object_kind;

typedef struct {
	uint8_t *bytes; /* owned */
	size_t size;
	uint8_t sha256[ESK_SHA256_BYTES];
} esk_object;

/* A row of one of the three tables; the bytes are the statement's until its next row. */
typedef struct {
	int64_t shape;
	const void *bytes;
	size_t size;
} esk_object_row;

eskel_store_status esk_object_write(
	sqlite3 *writer, esk_object_kind kind, int64_t shape, const esk_object *object, eskel_store_error *error);

/* Reads the columns shape, sha256 and bytes. CORRUPT unless the bytes match. */
eskel_store_status esk_object_read(
	esk_statement *s, esk_object_kind kind, esk_object_row *row, eskel_store_error *error);

/* What the engine's answer to stored bytes that match their checksum means: if they do not decode (CORRUPT), a faulty
 * or a newer program wrote them. */
eskel_store_status esk_object_decoded(
	eskel_status decoded, esk_object_kind kind, int64_t shape, eskel_store_error *error);

#endif
