/* An SQLite connection that trusts its file as little as it can. */
#ifndef ESK_CONNECTION_H
#define ESK_CONNECTION_H

#include "eskel_store.h"

#include <sqlite3.h>

typedef enum { ESK_CONNECTION_READ, ESK_CONNECTION_WRITE } esk_connection_kind;

/* Opens an existing file; every setting is read back (IO when SQLite does not take one). A connection is used by one
 * thread at a time. */
eskel_store_status esk_connection_open(
	const char *path, esk_connection_kind kind, sqlite3 **db, eskel_store_error *error);
/* Write-ahead logging is kept in the file: set once its schema is there, for a crash before that must leave a main
 * file which says whose it is. */
eskel_store_status esk_connection_use_wal(sqlite3 *db, eskel_store_error *error);
/* Finalizes the statements that the connection kept. */
void esk_connection_close(sqlite3 *db);

#endif
