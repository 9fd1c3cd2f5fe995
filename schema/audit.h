/* The audit: one row a change, written in its transaction. */
#ifndef ESK_AUDIT_H
#define ESK_AUDIT_H

#include "eskel_store.h"

#include <sqlite3.h>

typedef struct {
	const char *actor;  /* NULL: not known */
	const char *action; /* one of those that 002_access.sql lists */
	const char *shape;  /* an id, or NULL */
	int64_t revision;   /* of the shape after the change, before a deletion; 0: none */
	int64_t token;      /* its number; 0: none */
} esk_audit_entry;

eskel_store_status esk_audit_append(sqlite3 *writer, const esk_audit_entry *entry, eskel_store_error *error);

#endif
