/* The warnings with which a shape was accepted, in their order. */
#ifndef ESK_WARNING_H
#define ESK_WARNING_H

#include "statement.h"

eskel_store_status esk_warnings_write(
	sqlite3 *db, int64_t shape, const eskel_warning *warnings, size_t count, eskel_store_error *error);
eskel_store_status esk_warnings_read(
	sqlite3 *db, int64_t shape, eskel_warning **warnings, size_t *count, eskel_store_error *error);

#endif
