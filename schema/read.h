/* Read transactions: each on a read-only connection of its own, and each one moment of the database. */
#ifndef ESK_READ_H
#define ESK_READ_H

#include "store.h"

/* Takes an idle connection or opens one more: there are never more than there were readers at a time. */
eskel_store_status esk_read_begin(eskel_store *store, sqlite3 **db, eskel_store_error *error);
/* Up to *count of them, all of the same moment, at least one; *count becomes how many. */
eskel_store_status esk_read_begin_together(eskel_store *store, sqlite3 **dbs, size_t *count, eskel_store_error *error);
void esk_read_end(eskel_store *store, sqlite3 *db);

void esk_read_close_idle(eskel_store *store);

#endif
