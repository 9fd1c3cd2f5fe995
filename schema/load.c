/* Fills the catalogue from the database: one scan of the shapes beside one of their attributes. */
#include "catalogue.h"
#include "description.h"
#include "read.h"
#include "statement.h"
#include "status.h"

/* The attributes of all shapes, by shape and key. */
typedef struct {
	esk_statement statement;
	bool is_there; /* a row that is not yet read, of this shape: */
	int64_t shape;
} attribute_scan;

static void advance(attribute_scan *a)
{
	a->is_there = esk_statement_row(&a->statement);
	if (a->is_there)
		a->shape = esk_column_int64(&a->statement);
}

static attribute_scan begin_attributes(sqlite3 *db)
{
	attribute_scan a = {.statement = esk_statement_begin_once(
				    db, "SELECT shape, key, value FROM attribute ORDER BY shape, key")};
	advance(&a);
	return a;
}

/* Those of the next shape. False after a failure, which the statement keeps. */
static bool read_attributes(attribute_scan *a, int64_t shape, eskel_description *description)
{
	for (; a->is_there && a->shape <= shape; advance(a))
		if (a->shape == shape)
			esk_attribute_read(&a->statement, description);
	return a->is_there || a->statement.result == SQLITE_DONE;
}

static eskel_store_status load(sqlite3 *db, esk_catalogue *catalogue, eskel_store_error *error)
{
	esk_statement s =
		esk_statement_begin_once(db, "SELECT key, " ESK_DESCRIPTION_COLUMNS " FROM shape ORDER BY key");
	attribute_scan attributes = begin_attributes(db);
	bool good = true;
	while (good && esk_statement_row(&s)) {
		eskel_description description = {0};
		int64_t key = esk_column_int64(&s);
		esk_description_read(&s, &description);
		good = read_attributes(&attributes, key, &description);
		if (good)
			esk_catalogue_put(catalogue, key, &description);
		eskel_description_clear(&description);
	}
	eskel_store_status status = esk_statement_end(&s, error);
	eskel_store_status ended = esk_statement_end(&attributes.statement, status == ESKEL_STORE_OK ? error : NULL);
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
