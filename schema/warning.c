#include "warning.h"

#include "array.h"

#define WARNING_NAME(code, name) [code] = name,
static const char *const names[ESKEL_WARNING_COUNT] = {ESKEL_WARNINGS(WARNING_NAME)};

/* NULL, which the table refuses, for a code that there is not. */
static const char *name_of(eskel_warning_code code)
{
	return (unsigned)code < ESKEL_WARNING_COUNT ? names[code] : NULL;
}

eskel_store_status esk_warnings_write(
	sqlite3 *db, int64_t shape, const eskel_warning *warnings, size_t count, eskel_store_error *error)
{
	eskel_store_status status = ESKEL_STORE_OK;
	for (size_t i = 0; i < count && status == ESKEL_STORE_OK; i++) {
		esk_statement s = esk_statement_begin(
			db, "INSERT INTO warning (shape, position, code, text) VALUES (?, ?, ?, ?)");
		esk_bind_int64(&s, shape);
		esk_bind_int64(&s, (int64_t)i);
		esk_bind_text(&s, name_of(warnings[i].code));
		esk_bind_text(&s, warnings[i].text);
		status = esk_statement_run(&s, error);
	}
	return status;
}

eskel_store_status esk_warnings_read(
	sqlite3 *db, int64_t shape, eskel_warning **warnings, size_t *count, eskel_store_error *error)
{
	eskel_warning *read = NULL;
	size_t read_count = 0;
	esk_statement s = esk_statement_begin(db, "SELECT code, text FROM warning WHERE shape = ? ORDER BY position");
	esk_bind_int64(&s, shape);
	while (esk_statement_row(&s)) {
		if (!esk_array_grow((void **)&read, read_count, sizeof read[0])) {
			esk_statement_fail(&s, SQLITE_NOMEM);
			break;
		}
		eskel_warning *w = &read[read_count++];
		w->code = (eskel_warning_code)esk_column_name(&s, names, ESKEL_WARNING_COUNT);
		esk_column_copy(&s, w->text, sizeof w->text);
	}
	eskel_store_status status = esk_statement_end(&s, error);
	if (status != ESKEL_STORE_OK) {
		free(read);
		return status;
	}
	*warnings = read;
	*count = read_count;
	return ESKEL_STORE_OK;
}
