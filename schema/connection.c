#include "connection.h"

#include "statement.h"
#include "status.h"

#include <stdio.h>
#include <string.h>

/* How long a statement waits for a lock that another program (a backup, the sqlite3 shell) holds. */
static const int busy_milliseconds = 5000;

/* Nothing in a file that somebody else may have prepared is run or obeyed. */
static const struct {
	int option, value;
} switches[] = {
	{SQLITE_DBCONFIG_DEFENSIVE, 1},
	{SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
	{SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 0},
	{SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
	{SQLITE_DBCONFIG_ENABLE_VIEW, 0},
	{SQLITE_DBCONFIG_DQS_DML, 0},
	{SQLITE_DBCONFIG_DQS_DDL, 0},
};

/* Roughly four times what the store's own SQL needs; a value holds the cloud of 2^27 runs. */
static const struct {
	int limit, value;
} limits[] = {
	{SQLITE_LIMIT_LENGTH, 1 << 29},
	{SQLITE_LIMIT_SQL_LENGTH, 1 << 14},
	{SQLITE_LIMIT_COLUMN, 80},
	{SQLITE_LIMIT_EXPR_DEPTH, 200},
	{SQLITE_LIMIT_COMPOUND_SELECT, 4},
	{SQLITE_LIMIT_VDBE_OP, 10000},
	{SQLITE_LIMIT_FUNCTION_ARG, 8},
	{SQLITE_LIMIT_ATTACHED, 0},
	{SQLITE_LIMIT_LIKE_PATTERN_LENGTH, 16},
	{SQLITE_LIMIT_VARIABLE_NUMBER, 400},
	{SQLITE_LIMIT_TRIGGER_DEPTH, 4},
	{SQLITE_LIMIT_WORKER_THREADS, 0},
};

/* synchronous=FULL: a commit is on disk when it returns. secure_delete: a deleted shape's bytes are zeroed.
 * temp_store: no spill file with shapes in it. journal_size_limit: a log that grew under a long read is cut again. */
static const struct {
	const char *name, *value, *answer;
} pragmas[] = {
	{"synchronous", "FULL", "2"},
	{"foreign_keys", "ON", "1"},
	{"cell_size_check", "ON", "1"},
	{"trusted_schema", "OFF", "0"},
	{"secure_delete", "ON", "1"},
	{"temp_store", "MEMORY", "2"},
	{"journal_size_limit", "67108864", "67108864"},
};

static eskel_store_status refuse(const char *what, const char *setting, eskel_store_error *error)
{
	return esk_status_fail(error, ESKEL_STORE_IO, "SQLite does not take the %s %s", what, setting);
}

/* Some pragmas answer when set, others only when asked: the last answer counts. */
static eskel_store_status set_pragma(
	sqlite3 *db, const char *name, const char *value, const char *answer, eskel_store_error *error)
{
	char sql[2][64];
	snprintf(sql[0], sizeof sql[0], "PRAGMA %s=%s", name, value);
	snprintf(sql[1], sizeof sql[1], "PRAGMA %s", name);
	char answered[16] = "";
	for (int i = 0; i < 2; i++) {
		esk_statement s = esk_statement_begin_once(db, sql[i]);
		while (esk_statement_row(&s))
			esk_column_copy(&s, answered, sizeof answered);
		eskel_store_status status = esk_statement_end(&s, error);
		if (status != ESKEL_STORE_OK)
			return status;
	}
	return strcmp(answered, answer) == 0 ? ESKEL_STORE_OK : refuse("pragma", sql[0] + strlen("PRAGMA "), error);
}

static eskel_store_status harden(sqlite3 *db, eskel_store_error *error)
{
	char number[16];
	sqlite3_extended_result_codes(db, 1);
	sqlite3_busy_timeout(db, busy_milliseconds);
	for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
		sqlite3_limit(db, limits[i].limit, limits[i].value);
		snprintf(number, sizeof number, "%d", limits[i].limit);
		if (sqlite3_limit(db, limits[i].limit, -1) != limits[i].value)
			return refuse("limit", number, error);
	}
	for (size_t i = 0; i < sizeof switches / sizeof switches[0]; i++) {
		int now = -1;
		snprintf(number, sizeof number, "%d", switches[i].option);
		sqlite3_db_config(db, switches[i].option, switches[i].value, &now);
		if (now != switches[i].value)
			return refuse("switch", number, error);
	}
	for (size_t i = 0; i < sizeof pragmas / sizeof pragmas[0]; i++) {
		eskel_store_status status = set_pragma(db, pragmas[i].name, pragmas[i].value, pragmas[i].answer, error);
		if (status != ESKEL_STORE_OK)
			return status;
	}
	return ESKEL_STORE_OK;
}

eskel_store_status esk_connection_use_wal(sqlite3 *db, eskel_store_error *error)
{
	return set_pragma(db, "journal_mode", "WAL", "wal", error);
}

eskel_store_status esk_connection_open(
	const char *path, esk_connection_kind kind, sqlite3 **db, eskel_store_error *error)
{
	int flags = kind == ESK_CONNECTION_WRITE ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY;
	sqlite3 *opened = NULL;
	int result = sqlite3_open_v2(path, &opened, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE, NULL);
	eskel_store_status status = esk_status_of_sqlite(result, error);
	if (status == ESKEL_STORE_OK)
		status = harden(opened, error);
	if (status != ESKEL_STORE_OK) {
		esk_connection_close(opened);
		return status;
	}
	*db = opened;
	return ESKEL_STORE_OK;
}

void esk_connection_close(sqlite3 *db)
{
	sqlite3_stmt *kept;
	while (db && (kept = sqlite3_next_stmt(db, NULL)))
		sqlite3_finalize(kept);
	sqlite3_close(db);
}
