/* Fills the catalogue from the database: one scan of the shapes beside one of their attributes. */
#include "catalogue.h"
#include "description.h"
#include "read.h"
#include "statement.h"
#include "status.h"

/* Reads one shape's columns; its attributes follow in rows of the same key. */
static int64_t read_shape(esk_statement *s, eskel_description *description)
{
	int64_t key = esk_column_int64(s);
	esk_description_read(s, description);
	return key;
}

static eskel_store_status load(sqlite3 *db, esk_catalogue *catalogue, eskel_store_error *error)
{
	eskel_store_status status = ESKEL_STORE_OK;
	esk_statement s =
		esk_statement_begin_once(db, "SELECT key, " ESK_DESCRIPTION_COLUMNS " FROM shape ORDER BY key");
	while (status == ESKEL_STORE_OK && esk_statement_row(&s)) {
		eskel_description description = {0};
		int64_t key = read_shape(&s, &description);
		status = esk_attributes_read(db, key, &description, error);
		if (status == ESKEL_STORE_OK)
			esk_catalogue_put(catalogue, key, &description);
		eskel_description_clear(&description);
	}
	eskel_store_status ended = esk_statement_end(&s, status == ESKEL_STORE_OK ? error : NULL);
	if (status == ESKEL_STORE_OK)
		status = ended;
	if (status == ESKEL_STORE_OK && !esk_catalogue_is_whole(catalogue))
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	return status;
}

eskel_store_status eskel_store_keep_descriptions(eskel_store *store, eskel_store_error *error)
{
	sqlite3 *db = NULL;
	esk_catalogue *catalogue = esk_catalogue_new();
	if (!catalogue)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status == ESKEL_STORE_OK) {
		status = load(db, catalogue, error);
		esk_read_end(store, db);
	}
	if (status == ESKEL_STORE_OK)
		store->catalogue = catalogue;
	else
		esk_catalogue_free(catalogue);
	return status;
}
