/* A statement from its SQL to its status, without a check a line: the first failure is kept, what follows it does
 * nothing, and the end reports it.
 *
 *	esk_statement s = esk_statement_begin(db, "SELECT name, age FROM shape WHERE key = ?");
 *	esk_bind_int64(&s, key);
 *	while (esk_statement_row(&s)) {
 *		char *name = esk_column_text(&s);
 *		...
 *	}
 *	return esk_statement_end(&s, error);
 *
 * Parameters are bound, and columns read, from left to right. Text and blobs are not copied when bound: they must live
 * until the end. */
#ifndef ESK_STATEMENT_H
#define ESK_STATEMENT_H

#include "eskel_store.h"

#include <sqlite3.h>

typedef struct {
	sqlite3_stmt *stmt;
	int result;    /* SQLITE_OK, SQLITE_ROW, SQLITE_DONE or the first failure */
	int parameter; /* the last one bound, from 1 */
	int column;    /* the next one read, from 0 */
	bool once;
} esk_statement;

/* The connection keeps the prepared statement for the next begin with the same SQL ... */
esk_statement esk_statement_begin(sqlite3 *db, const char *sql);
/* ... or not: for SQL in more variants than are worth keeping. */
esk_statement esk_statement_begin_once(sqlite3 *db, const char *sql);

void esk_bind_int64(esk_statement *s, int64_t value);
void esk_bind_double(esk_statement *s, double value);   /* NaN: NULL */
void esk_bind_text(esk_statement *s, const char *text); /* NULL: NULL */
void esk_bind_blob(esk_statement *s, const void *bytes, size_t size);

/* True when there is a row to read. */
bool esk_statement_row(esk_statement *s);

int64_t esk_column_int64(esk_statement *s);      /* NULL: 0 */
double esk_column_double(esk_statement *s);      /* NULL: NaN */
char *esk_column_text(esk_statement *s);         /* free() it; NULL: NULL */
const char *esk_column_borrow(esk_statement *s); /* valid until the next row or the end */
/* The text's place in names[count], 0 for NULL. A text that is not there is a failure (SQLITE_CORRUPT). */
unsigned esk_column_name(esk_statement *s, const char *const *names, unsigned count);
/* Writes a text of less than size bytes; a longer one is a failure. */
void esk_column_copy(esk_statement *s, char *text, size_t size);
/* The bytes are valid until the next row or the end. */
void esk_column_blob(esk_statement *s, const void **bytes, size_t *size);

/* Keeps a failure from outside, as memory that ran out while rows were read. */
void esk_statement_fail(esk_statement *s, int result);
eskel_store_status esk_statement_end(esk_statement *s, eskel_store_error *error);
/* Steps past all rows and ends. */
eskel_store_status esk_statement_run(esk_statement *s, eskel_store_error *error);
/* The whole of a statement without parameters and rows. */
eskel_store_status esk_statement_execute(sqlite3 *db, const char *sql, eskel_store_error *error);

#endif
