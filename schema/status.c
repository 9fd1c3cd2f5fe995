#include "status.h"

#include <sqlite3.h>
#include <stdarg.h>
#include <stdio.h>

#define STATUS_TEXT(code, text) [code] = text,
static const char *const status_texts[ESKEL_STORE_STATUS_COUNT] = {ESKEL_STORE_STATUSES(STATUS_TEXT)};

const char *eskel_store_status_text(eskel_store_status status)
{
	if ((unsigned)status >= ESKEL_STORE_STATUS_COUNT)
		return "an unknown status";
	return status_texts[status];
}

eskel_store_status esk_status_fail(eskel_store_error *error, eskel_store_status status, const char *format, ...)
{
	if (error) {
		va_list arguments;
		va_start(arguments, format);
		error->status = status;
		vsnprintf(error->text, sizeof error->text, format, arguments);
		va_end(arguments);
	}
	return status;
}

static eskel_store_status status_of_result(int result)
{
	if (result == SQLITE_IOERR_NOMEM)
		return ESKEL_STORE_NO_MEMORY;
	switch (result & 0xff) {
	case SQLITE_OK:
	case SQLITE_ROW:
	case SQLITE_DONE:
		return ESKEL_STORE_OK;
	case SQLITE_NOMEM:
		return ESKEL_STORE_NO_MEMORY;
	case SQLITE_BUSY:
	case SQLITE_LOCKED:
		return ESKEL_STORE_BUSY;
	case SQLITE_FULL:
		return ESKEL_STORE_FULL;
	case SQLITE_CORRUPT:
		return ESKEL_STORE_CORRUPT;
	case SQLITE_NOTADB:
		return ESKEL_STORE_FOREIGN;
	case SQLITE_CONSTRAINT:
	case SQLITE_MISMATCH:
	case SQLITE_TOOBIG:
		return ESKEL_STORE_INVALID;
	default:
		return ESKEL_STORE_IO;
	}
}

eskel_store_status esk_status_of_sqlite(int result, eskel_store_error *error)
{
	eskel_store_status status = status_of_result(result);
	if (status == ESKEL_STORE_OK)
		return status;
	/* sqlite3_errstr and not sqlite3_errmsg, which can quote the database. */
	return esk_status_fail(error, status, "%s: SQLite says \"%s\" (%d)", eskel_store_status_text(status),
		sqlite3_errstr(result), result);
}
