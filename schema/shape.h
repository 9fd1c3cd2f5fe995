/* A shape as rows. The functions work inside their caller's transaction. */
#ifndef ESK_SHAPE_H
#define ESK_SHAPE_H

#include "eskel_store.h"

#include <sqlite3.h>

/* NOT_FOUND for an id that no shape has; either output may be NULL. */
eskel_store_status esk_shape_find(
	sqlite3 *db, const char *id, int64_t *key, int64_t *revision, eskel_store_error *error);

/* The whole shape: eskel_shape_clear it. */
eskel_store_status esk_shape_read(sqlite3 *db, int64_t key, eskel_shape *shape, eskel_store_error *error);

#endif
