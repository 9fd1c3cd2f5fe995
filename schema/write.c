#include "write.h"

#include "statement.h"
#include "status.h"

/* Pages in the write-ahead log from which a commit copies them to the database: 16 MB. */
static const int checkpoint_pages = 1000;

struct esk_write {
	esk_change change;
	esk_committed committed; /* or NULL */
	void *context;
	eskel_store_error *error;
	eskel_store_status status;
	bool done;
	struct esk_write *next;
};

eskel_store_status esk_write_allowed(eskel_store *store, eskel_store_error *error)
{
	if (!atomic_load(&store->read_only))
		return ESKEL_STORE_OK;
	return esk_status_fail(error, ESKEL_STORE_READ_ONLY, "%s", eskel_store_status_text(ESKEL_STORE_READ_ONLY));
}

/* False when the transaction is over for all of the group: SQLite has rolled it back, a savepoint could not be undone,
 * or the disk cannot be trusted. */
static bool run_change(sqlite3 *writer, struct esk_write *write)
{
	write->status = esk_statement_execute(writer, "SAVEPOINT change", write->error);
	if (write->status != ESKEL_STORE_OK)
		return false;
	write->status = write->change(writer, write->context, write->error);
	if (sqlite3_get_autocommit(writer) && write->status == ESKEL_STORE_OK)
		write->status = esk_status_fail(write->error, ESKEL_STORE_IO, "SQLite ended the transaction by itself");
	if (sqlite3_get_autocommit(writer) || write->status == ESKEL_STORE_IO || write->status == ESKEL_STORE_CORRUPT)
		return false;
	eskel_store_status ended = ESKEL_STORE_OK;
	if (write->status != ESKEL_STORE_OK)
		ended = esk_statement_execute(writer, "ROLLBACK TO change", write->error);
	if (ended == ESKEL_STORE_OK)
		ended = esk_statement_execute(writer, "RELEASE change", write->error);
	if (ended != ESKEL_STORE_OK)
		write->status = ended;
	return ended == ESKEL_STORE_OK;
}

static eskel_store_status run_group(sqlite3 *writer, struct esk_write *group, eskel_store_error *error)
{
	eskel_store_status status = esk_statement_execute(writer, "BEGIN IMMEDIATE", error);
	if (status != ESKEL_STORE_OK)
		return status;
	for (struct esk_write *w = group; w; w = w->next) {
		if (!run_change(writer, w))
			return esk_status_fail(error, w->status, "%s", eskel_store_status_text(w->status));
	}
	return esk_statement_execute(writer, "COMMIT", error);
}

static void fail_group(struct esk_write *group, const eskel_store_error *error)
{
	for (struct esk_write *w = group; w; w = w->next)
		if (w->status == ESKEL_STORE_OK)
			w->status = esk_status_fail(w->error, error->status, "%s", error->text);
}

static void tell_committed(eskel_store *store, const struct esk_write *group)
{
	for (const struct esk_write *w = group; w; w = w->next)
		if (w->status == ESKEL_STORE_OK && w->committed)
			w->committed(store, w->context);
}

/* A failure is not that of the commit before, which is durable: it ends the writes that follow. */
static void checkpoint(eskel_store *store)
{
	int result = sqlite3_wal_checkpoint_v2(store->writer, NULL, SQLITE_CHECKPOINT_PASSIVE, NULL, NULL);
	if (esk_status_of_sqlite(result, NULL) == ESKEL_STORE_IO)
		atomic_store(&store->read_only, true);
}

static void commit_group(eskel_store *store, struct esk_write *group)
{
	eskel_store_error error;
	eskel_store_status status = esk_write_allowed(store, &error);
	if (status == ESKEL_STORE_OK)
		status = run_group(store->writer, group, &error);
	if (!sqlite3_get_autocommit(store->writer))
		esk_statement_execute(store->writer, "ROLLBACK", NULL);
	if (status == ESKEL_STORE_IO || status == ESKEL_STORE_CORRUPT)
		atomic_store(&store->read_only, true);
	if (status == ESKEL_STORE_OK)
		tell_committed(store, group);
	if (status != ESKEL_STORE_OK)
		fail_group(group, &error);
	else if (store->log_pages >= checkpoint_pages)
		checkpoint(store);
}

static eskel_store_status enqueue(eskel_store *store, struct esk_write write)
{
	struct esk_write mine = write;
	pthread_mutex_lock(&store->writes_mutex);
	struct esk_write **end = &store->waiting;
	while (*end)
		end = &(*end)->next;
	*end = &mine;
	while (!mine.done && store->writing)
		pthread_cond_wait(&store->writes_done, &store->writes_mutex);
	if (!mine.done) {
		struct esk_write *group = store->waiting;
		store->waiting = NULL;
		store->writing = true;
		pthread_mutex_unlock(&store->writes_mutex);
		commit_group(store, group);
		pthread_mutex_lock(&store->writes_mutex);
		store->writing = false;
		for (struct esk_write *w = group; w; w = w->next)
			w->done = true;
		pthread_cond_broadcast(&store->writes_done);
	}
	pthread_mutex_unlock(&store->writes_mutex);
	return mine.status;
}

eskel_store_status esk_write(eskel_store *store, esk_change change, void *context, eskel_store_error *error)
{
	return enqueue(store, (struct esk_write){.change = change, .context = context, .error = error});
}

eskel_store_status esk_write_shapes(
	eskel_store *store, esk_change change, esk_committed committed, void *context, eskel_store_error *error)
{
	if (store->is_beside)
		return esk_status_fail(error, ESKEL_STORE_LOCKED,
			"only the server that has %s open can change its shapes", store->path);
	return enqueue(store, (struct esk_write){.change = change,
				      .committed = store->catalogue ? committed : NULL,
				      .context = context,
				      .error = error});
}

static int count_log_pages(void *context, sqlite3 *writer, const char *schema, int pages)
{
	(void)writer;
	(void)schema;
	((eskel_store *)context)->log_pages = pages;
	return SQLITE_OK;
}

void esk_write_prepare(eskel_store *store)
{
	sqlite3_wal_hook(store->writer, count_log_pages, store);
}
