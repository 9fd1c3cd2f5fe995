/* The scan of all signatures with which a library is filled. */
#include "object.h"
#include "prefetch.h"
#include "read.h"
#include "statement.h"

typedef struct {
	bool (*each)(void *context, int64_t key, const eskel_signature *signature);
	void *context;
	bool stopped;
} visitor;

static eskel_store_status visit(esk_statement *s, visitor *v, esk_prefetch *ahead, eskel_store_error *error)
{
	esk_object_row row;
	eskel_store_status status = esk_object_read(s, ESK_OBJECT_SIGNATURE, &row, error);
	if (status != ESKEL_STORE_OK)
		return status;
	eskel_signature *signature = NULL;
	eskel_status decoded = eskel_signature_decode(row.bytes, row.size, &signature, NULL);
	status = esk_object_decoded(decoded, ESK_OBJECT_SIGNATURE, row.shape, error);
	if (status == ESKEL_STORE_OK)
		v->stopped = !v->each(v->context, row.shape, signature);
	eskel_signature_free(signature);
	esk_prefetch_pass(ahead, row.shape);
	return status;
}

static eskel_store_status read_last_key(sqlite3 *db, int64_t *last, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(db, "SELECT max(shape) FROM signature");
	if (esk_statement_row(&s))
		*last = esk_column_int64(&s);
	return esk_statement_end(&s, error);
}

static eskel_store_status scan(eskel_store *store, sqlite3 *db, visitor *v, eskel_store_error *error)
{
	int64_t last = 0;
	eskel_store_status status = read_last_key(db, &last, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_prefetch ahead;
	esk_prefetch_start(&ahead, store, last);
	esk_statement s = esk_statement_begin(db, "SELECT shape, sha256, bytes FROM signature ORDER BY shape");
	while (!v->stopped && status == ESKEL_STORE_OK && esk_statement_row(&s))
		status = visit(&s, v, &ahead, error);
	eskel_store_status ended = esk_statement_end(&s, status == ESKEL_STORE_OK ? error : NULL);
	esk_prefetch_stop(&ahead);
	return status == ESKEL_STORE_OK ? ended : status;
}

eskel_store_status eskel_store_each_signature(eskel_store *store,
	bool (*each)(void *context, int64_t key, const eskel_signature *signature), void *context,
	eskel_store_error *error)
{
	visitor v = {.each = each, .context = context};
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = scan(store, db, &v, error);
	esk_read_end(store, db);
	return status;
}
