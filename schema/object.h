/* The encoded cloud, skeleton and signature of a shape, each beside its SHA-256. */
#ifndef ESK_OBJECT_H
#define ESK_OBJECT_H

#include "eskel_store.h"
#include "sha256.h"

#include <sqlite3.h>

typedef enum { ESK_OBJECT_CLOUD, ESK_OBJECT_SKELETON, ESK_OBJECT_SIGNATURE, ESK_OBJECT_KINDS } esk_object_kind;

typedef struct {
	uint8_t *bytes; /* owned */
	size_t size;
	uint8_t sha256[ESK_SHA256_BYTES];
} esk_object;

eskel_store_status esk_object_write(
	sqlite3 *writer, esk_object_kind kind, int64_t shape, const esk_object *object, eskel_store_error *error);

#endif
