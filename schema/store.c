#include "store.h"

#include "connection.h"
#include "file.h"
#include "migrate.h"
#include "read.h"
#include "statement.h"
#include "status.h"
#include "steps.h"
#include "write.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const uint64_t default_least_free_bytes = UINT64_C(64) << 20;

/* Every table but the four of blobs: those are most of the file, minutes for a million shapes, and each blob is
 * verified when it is read. */
static const char *const quick_checks[] = {
	"PRAGMA quick_check(shape)",
	"PRAGMA quick_check(attribute)",
	"PRAGMA quick_check(warning)",
	"PRAGMA quick_check(token)",
	"PRAGMA quick_check(audit)",
	"PRAGMA quick_check(job)",
};

static eskel_store_status quick_check(sqlite3 *db, eskel_store_error *error)
{
	for (size_t i = 0; i < sizeof quick_checks / sizeof quick_checks[0]; i++) {
		bool sound = false;
		esk_statement s = esk_statement_begin_once(db, quick_checks[i]);
		if (esk_statement_row(&s)) {
			char *answer = esk_column_text(&s);
			sound = answer && strcmp(answer, "ok") == 0;
			free(answer);
		}
		eskel_store_status status = esk_statement_end(&s, error);
		if (status != ESKEL_STORE_OK)
			return status;
		if (!sound)
			return esk_status_fail(
				error, ESKEL_STORE_CORRUPT, "the database is damaged: %s fails", quick_checks[i]);
	}
	return ESKEL_STORE_OK;
}

eskel_store_status eskel_store_check(eskel_store *store, eskel_store_error *error)
{
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = quick_check(db, error);
	esk_read_end(store, db);
	return status;
}

static eskel_store_status bring_up_to_date(sqlite3 *writer, bool check_later, eskel_store_error *error)
{
	eskel_store_status status = esk_migrate(writer, esk_steps, esk_step_count, error);
	if (status == ESKEL_STORE_OK)
		status = esk_connection_use_wal(writer, error);
	if (status == ESKEL_STORE_OK && !check_later)
		status = quick_check(writer, error);
	return status;
}

/* Beside a server the file is as that server has left it, or it is refused. */
static eskel_store_status bring_up(
	eskel_store *store, const char *path, const eskel_store_options *options, eskel_store_error *error)
{
	eskel_store_status status = esk_file_resolve(path, &store->path, error);
	if (status == ESKEL_STORE_OK)
		status = esk_file_lock(store->path, &store->lock, error);
	store->is_beside = status == ESKEL_STORE_LOCKED && options->beside_server;
	if (status != ESKEL_STORE_OK && !store->is_beside)
		return status;
	status = esk_file_check(store->path, esk_step_count, error);
	if (status == ESKEL_STORE_OK)
		status = esk_connection_open(store->path, ESK_CONNECTION_WRITE, &store->writer, error);
	if (status == ESKEL_STORE_OK)
		status = store->is_beside ? esk_migrate_check(store->writer, esk_step_count, error)
					  : bring_up_to_date(store->writer, options->check_later, error);
	if (status == ESKEL_STORE_OK)
		esk_write_prepare(store);
	return status;
}

eskel_store_status eskel_store_open(
	const char *path, const eskel_store_options *options, eskel_store **store, eskel_store_error *error)
{
	const eskel_store_options asked = options ? *options : (eskel_store_options){0};
	eskel_store *opened = calloc(1, sizeof *opened);
	if (!opened)
		return esk_status_fail(error, ESKEL_STORE_NO_MEMORY, "memory ran out");
	opened->lock = -1;
	opened->least_free_bytes = asked.least_free_bytes ? asked.least_free_bytes : default_least_free_bytes;
	pthread_mutex_init(&opened->writes_mutex, NULL);
	pthread_cond_init(&opened->writes_done, NULL);
	pthread_mutex_init(&opened->readers_mutex, NULL);
	eskel_store_status status = bring_up(opened, path, &asked, error);
	if (status == ESKEL_STORE_FOREIGN && opened->lock >= 0)
		esk_file_unlock_and_remove(opened->path, &opened->lock);
	if (status != ESKEL_STORE_OK) {
		eskel_store_close(opened);
		return status;
	}
	*store = opened;
	return ESKEL_STORE_OK;
}

void eskel_store_close(eskel_store *store)
{
	if (!store)
		return;
	esk_read_close_idle(store);
	esk_connection_close(store->writer);
	if (store->lock >= 0)
		close(store->lock);
	pthread_mutex_destroy(&store->readers_mutex);
	pthread_cond_destroy(&store->writes_done);
	pthread_mutex_destroy(&store->writes_mutex);
	esk_catalogue_free(store->catalogue);
	free(store->path);
	free(store);
}

eskel_store_status eskel_store_ready(eskel_store *store, eskel_store_error *error)
{
	sqlite3 *db = NULL;
	eskel_store_status status = esk_write_allowed(store, error);
	if (status == ESKEL_STORE_OK)
		status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	status = esk_statement_execute(db, "SELECT key FROM shape LIMIT 1", error);
	esk_read_end(store, db);
	return status;
}
