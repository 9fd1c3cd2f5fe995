#include "read.h"

#include "array.h"
#include "connection.h"
#include "statement.h"

static sqlite3 *pop(eskel_store *store)
{
	pthread_mutex_lock(&store->readers_mutex);
	sqlite3 *db = store->idle_count ? store->idle[--store->idle_count] : NULL;
	pthread_mutex_unlock(&store->readers_mutex);
	return db;
}

static bool push(eskel_store *store, sqlite3 *db)
{
	pthread_mutex_lock(&store->readers_mutex);
	bool room = esk_array_grow((void **)&store->idle, store->idle_count, sizeof store->idle[0]);
	if (room)
		store->idle[store->idle_count++] = db;
	pthread_mutex_unlock(&store->readers_mutex);
	return room;
}

eskel_store_status esk_read_begin(eskel_store *store, sqlite3 **db, eskel_store_error *error)
{
	eskel_store_status status = ESKEL_STORE_OK;
	sqlite3 *reader = pop(store);
	if (!reader)
		status = esk_connection_open(store->path, ESK_CONNECTION_READ, &reader, error);
	if (status == ESKEL_STORE_OK)
		status = esk_statement_execute(reader, "BEGIN", error);
	if (status != ESKEL_STORE_OK) {
		esk_connection_close(reader);
		return status;
	}
	*db = reader;
	return ESKEL_STORE_OK;
}

/* A transaction sees the moment of its first read. */
static eskel_store_status begin_now(eskel_store *store, sqlite3 **db, eskel_store_error *error)
{
	sqlite3 *begun = NULL;
	eskel_store_status status = esk_read_begin(store, &begun, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = esk_statement_execute(begun, "SELECT key FROM shape LIMIT 1", error);
	if (status == ESKEL_STORE_OK)
		*db = begun;
	else
		esk_read_end(store, begun);
	return status;
}

eskel_store_status esk_read_begin_together(eskel_store *store, sqlite3 **dbs, size_t *count, eskel_store_error *error)
{
	eskel_store_status status = ESKEL_STORE_OK;
	size_t begun = 0;
	pthread_mutex_lock(&store->writes_mutex); /* nobody begins to write */
	while (store->writing)
		pthread_cond_wait(&store->writes_done, &store->writes_mutex);
	while (begun < *count && status == ESKEL_STORE_OK) {
		status = begin_now(store, &dbs[begun], begun ? NULL : error);
		begun += status == ESKEL_STORE_OK;
	}
	pthread_mutex_unlock(&store->writes_mutex);
	if (!begun)
		return status;
	*count = begun;
	return ESKEL_STORE_OK;
}

void esk_read_end(eskel_store *store, sqlite3 *db)
{
	if (!sqlite3_get_autocommit(db))
		esk_statement_execute(db, "ROLLBACK", NULL);
	if (!sqlite3_get_autocommit(db) || !push(store, db))
		esk_connection_close(db);
}

void esk_read_close_idle(eskel_store *store)
{
	while (store->idle_count)
		esk_connection_close(store->idle[--store->idle_count]);
	free(store->idle);
	store->idle = NULL;
}
