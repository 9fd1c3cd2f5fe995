/* The classes that stored shapes have. Each is found from the one before over the index of classes, so the work grows with
 * the classes and not with the shapes. */
#include "array.h"
#include "read.h"
#include "statement.h"
#include "status.h"

#include <stdlib.h>

void eskel_store_classes_free(char **classes, size_t count)
{
	for (size_t i = 0; classes && i < count; i++)
		free(classes[i]);
	free(classes);
}

/* *class stays NULL when no class comes after. */
static eskel_store_status find_next(sqlite3 *db, const char *after, char **class, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "SELECT class FROM shape WHERE class > ? ORDER BY class LIMIT 1");
	esk_bind_text(&s, after);
	while (esk_statement_row(&s))
		*class = esk_column_text(&s);
	return esk_statement_end(&s, error);
}

static eskel_store_status find_all(sqlite3 *db, char ***classes, size_t *count, eskel_store_error *error)
{
	for (;;) {
		char *class = NULL;
		eskel_store_status status = find_next(db, *count > 0 ? (*classes)[*count - 1] : "", &class, error);
		if (status == ESKEL_STORE_OK && class && !esk_array_grow((void **)classes, *count, sizeof **classes))
			status = esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
		if (status != ESKEL_STORE_OK || !class) {
			free(class);
			return status;
		}
		(*classes)[(*count)++] = class;
	}
}

eskel_store_status eskel_store_classes(eskel_store *store, char ***classes, size_t *count, eskel_store_error *error)
{
	sqlite3 *db = NULL;
	char **found = NULL;
	size_t found_count = 0;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = find_all(db, &found, &found_count, error);
	esk_read_end(store, db);
	if (status != ESKEL_STORE_OK) {
		eskel_store_classes_free(found, found_count);
		return status;
	}
	*classes = found;
	*count = found_count;
	return ESKEL_STORE_OK;
}
