#include "migrate.h"

#include "file.h"
#include "statement.h"
#include "status.h"

#include <stdio.h>

static eskel_store_status run_step(sqlite3 *db, const char *step, int number, eskel_store_error *error)
{
	char stamp[96];
	snprintf(stamp, sizeof stamp, "PRAGMA application_id = %d; PRAGMA user_version = %d", ESK_APPLICATION_ID,
		number);
	const char *const parts[] = {"BEGIN IMMEDIATE", step, stamp, "COMMIT"};
	int result = SQLITE_OK;
	for (size_t i = 0; i < sizeof parts / sizeof parts[0] && result == SQLITE_OK; i++)
		result = sqlite3_exec(db, parts[i], NULL, NULL, NULL);
	if (result != SQLITE_OK && !sqlite3_get_autocommit(db))
		sqlite3_exec(db, "ROLLBACK", NULL, NULL, NULL);
	return esk_status_of_sqlite(result, error);
}

static eskel_store_status read_version(sqlite3 *db, int *version, eskel_store_error *error)
{
	int read = 0;
	esk_statement s = esk_statement_begin_once(db, "PRAGMA user_version");
	if (esk_statement_row(&s))
		read = (int)esk_column_int64(&s);
	eskel_store_status status = esk_statement_end(&s, error);
	if (status == ESKEL_STORE_OK)
		*version = read;
	return status;
}

/* 16 KB pages hold five signatures of 16 levels or a skeleton: a fifth of the reads that 4 KB pages need to fill a
 * library, for two and a half times the bytes in the log of an enrollment. */
static const char new_database[] = "PRAGMA page_size = 16384";

eskel_store_status esk_migrate(sqlite3 *db, const char *const *steps, int count, eskel_store_error *error)
{
	int version = 0;
	eskel_store_status status = read_version(db, &version, error);
	if (status != ESKEL_STORE_OK)
		return status;
	/* esk_file_check has seen the main file; a newer version can still stand in the write-ahead log. */
	if (version < 0 || version > count)
		return esk_status_fail(
			error, ESKEL_STORE_FOREIGN, "the schema is %d, expected at most %d", version, count);
	if (version == 0)
		status = esk_statement_execute(db, new_database, error);
	for (; version < count && status == ESKEL_STORE_OK; version++)
		status = run_step(db, steps[version], version + 1, error);
	return status;
}

eskel_store_status esk_migrate_check(sqlite3 *db, int count, eskel_store_error *error)
{
	int version = 0;
	eskel_store_status status = read_version(db, &version, error);
	if (status == ESKEL_STORE_OK && version != count)
		return esk_status_fail(error, ESKEL_STORE_FOREIGN,
			"the running server's schema is %d, expected %d: use its own program", version, count);
	return status;
}
