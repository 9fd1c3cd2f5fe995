/* The schema's history: numbered SQL steps, forward only. A new database is made by running them all, so an old one
 * and a new one cannot differ. */
#ifndef ESK_MIGRATE_H
#define ESK_MIGRATE_H

#include "eskel_store.h"

#include <sqlite3.h>

/* Runs those of steps[count] that the database has not had, each in a transaction with its number (user_version).
 * FOREIGN, and nothing is written, when it has had more. */
eskel_store_status esk_migrate(sqlite3 *db, const char *const *steps, int count, eskel_store_error *error);

/* FOREIGN unless the database has had exactly count steps. Writes nothing. */
eskel_store_status esk_migrate_check(sqlite3 *db, int count, eskel_store_error *error);

#endif
