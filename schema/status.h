/* One sentence for a person, and what an SQLite result means to the store. Sentences name ids, numbers and limits,
 * never what people wrote of a shape. */
#ifndef ESK_STATUS_H
#define ESK_STATUS_H

#include "eskel_store.h"

/* Fills error (which may be NULL) and returns status, so that a refusal is one line. */
eskel_store_status esk_status_fail(eskel_store_error *error, eskel_store_status status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* The status of an (extended) SQLite result. Fills error unless it is OK. */
eskel_store_status esk_status_of_sqlite(int result, eskel_store_error *error);

#endif
