#include "statement.h"

#include "status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool failed(const esk_statement *s)
{
	return s->result != SQLITE_OK && s->result != SQLITE_ROW && s->result != SQLITE_DONE;
}

void esk_statement_fail(esk_statement *s, int result)
{
	if (!failed(s))
		s->result = result;
}

/* The connection's own list of statements is the cache: a few dozen, told apart by their first bytes. */
esk_statement esk_statement_begin(sqlite3 *db, const char *sql)
{
	esk_statement s = {.result = SQLITE_OK};
	sqlite3_stmt *kept = NULL;
	while ((kept = sqlite3_next_stmt(db, kept))) {
		if (!sqlite3_stmt_busy(kept) && strcmp(sqlite3_sql(kept), sql) == 0) {
			s.stmt = kept;
			return s;
		}
	}
	s.result = sqlite3_prepare_v3(db, sql, -1, SQLITE_PREPARE_PERSISTENT, &s.stmt, NULL);
	return s;
}

esk_statement esk_statement_begin_once(sqlite3 *db, const char *sql)
{
	esk_statement s = {.result = SQLITE_OK, .once = true};
	s.result = sqlite3_prepare_v3(db, sql, -1, 0, &s.stmt, NULL);
	return s;
}

void esk_bind_int64(esk_statement *s, int64_t value)
{
	if (!failed(s))
		s->result = sqlite3_bind_int64(s->stmt, ++s->parameter, value);
}

void esk_bind_double(esk_statement *s, double value)
{
	if (!failed(s))
		s->result = sqlite3_bind_double(s->stmt, ++s->parameter, value);
}

void esk_bind_text(esk_statement *s, const char *text)
{
	if (!failed(s))
		s->result = sqlite3_bind_text(s->stmt, ++s->parameter, text, -1, SQLITE_STATIC);
}

void esk_bind_blob(esk_statement *s, const void *bytes, size_t size)
{
	if (!failed(s))
		s->result = sqlite3_bind_blob64(s->stmt, ++s->parameter, bytes, size, SQLITE_STATIC);
}

bool esk_statement_row(esk_statement *s)
{
	if (failed(s))
		return false;
	s->column = 0;
	s->result = sqlite3_step(s->stmt);
	return s->result == SQLITE_ROW;
}

int64_t esk_column_int64(esk_statement *s)
{
	return sqlite3_column_int64(s->stmt, s->column++);
}

double esk_column_double(esk_statement *s)
{
	int column = s->column++;
	bool null = sqlite3_column_type(s->stmt, column) == SQLITE_NULL;
	return null ? (double)NAN : sqlite3_column_double(s->stmt, column);
}

const char *esk_column_borrow(esk_statement *s)
{
	int column = s->column++;
	if (sqlite3_column_type(s->stmt, column) == SQLITE_NULL)
		return NULL;
	const char *text = (const char *)sqlite3_column_text(s->stmt, column);
	if (!text)
		esk_statement_fail(s, SQLITE_NOMEM);
	return text;
}

char *esk_column_text(esk_statement *s)
{
	const char *text = esk_column_borrow(s);
	char *copy = text ? strdup(text) : NULL;
	if (text && !copy)
		esk_statement_fail(s, SQLITE_NOMEM);
	return copy;
}

unsigned esk_column_name(esk_statement *s, const char *const *names, unsigned count)
{
	const char *text = esk_column_borrow(s);
	if (!text)
		return 0;
	for (unsigned i = 0; i < count; i++)
		if (names[i] && strcmp(names[i], text) == 0)
			return i;
	esk_statement_fail(s, SQLITE_CORRUPT);
	return 0;
}

void esk_column_copy(esk_statement *s, char *text, size_t size)
{
	const char *stored = esk_column_borrow(s);
	size_t length = stored ? strlen(stored) : 0;
	if (length >= size) {
		esk_statement_fail(s, SQLITE_CORRUPT);
		length = 0;
	}
	if (length)
		memcpy(text, stored, length);
	text[length] = '\0';
}

void esk_column_blob(esk_statement *s, const void **bytes, size_t *size)
{
	int column = s->column++;
	*bytes = sqlite3_column_blob(s->stmt, column);
	*size = (size_t)sqlite3_column_bytes(s->stmt, column);
	if (*size && !*bytes)
		esk_statement_fail(s, SQLITE_NOMEM);
}

eskel_store_status esk_statement_end(esk_statement *s, eskel_store_error *error)
{
	if (s->once) {
		sqlite3_finalize(s->stmt);
	} else if (s->stmt) {
		sqlite3_reset(s->stmt);
		sqlite3_clear_bindings(s->stmt);
	}
	s->stmt = NULL;
	return esk_status_of_sqlite(s->result, error);
}

eskel_store_status esk_statement_run(esk_statement *s, eskel_store_error *error)
{
	while (esk_statement_row(s))
		continue;
	return esk_statement_end(s, error);
}

eskel_store_status esk_statement_execute(sqlite3 *db, const char *sql, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, sql);
	return esk_statement_run(&s, error);
}
