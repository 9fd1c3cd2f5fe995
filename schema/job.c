/* The rows of jobs: what has to be answered and how it ended. That one runs is not stored, only how often it was begun: a
 * job that runs when the server ends is a queued one. */
#include "array.h"
#include "read.h"
#include "statement.h"
#include "status.h"
#include "write.h"

#include <stdlib.h>
#include <string.h>

static const char *const states[] = {
	[ESKEL_JOB_QUEUED] = "queued",
	[ESKEL_JOB_DONE] = "done",
	[ESKEL_JOB_FAILED] = "failed",
};
#define CREATED "strftime('%Y-%m-%dT%H:%M:%SZ', created, 'unixepoch')"

enum { state_count = sizeof states / sizeof states[0] };

void eskel_jobs_free(eskel_job *jobs, size_t count)
{
	for (size_t i = 0; i < count; i++)
		free(jobs[i].request);
	free(jobs);
}

/* ---- changes */

static eskel_store_status insert(sqlite3 *writer, void *context, eskel_store_error *error)
{
	eskel_job *job = context;
	esk_statement s = esk_statement_begin(writer, "INSERT INTO job (id, request) VALUES (?, ?) RETURNING " CREATED);
	esk_bind_text(&s, job->id);
	esk_bind_text(&s, job->request);
	if (esk_statement_row(&s))
		esk_column_copy(&s, job->created, sizeof job->created);
	return esk_statement_run(&s, error);
}

eskel_store_status eskel_store_job_add(eskel_store *store, eskel_job *job, eskel_store_error *error)
{
	return esk_write(store, insert, job, error);
}

static eskel_store_status update(sqlite3 *writer, void *context, eskel_store_error *error)
{
	const eskel_job *job = context;
	esk_statement s = esk_statement_begin(writer,
		"UPDATE job SET (state, starts, status, content_type, size, seconds, problem) = (?, ?, ?, ?, ?, ?, ?)"
		" WHERE id = ?");
	esk_bind_text(&s, states[job->state]);
	esk_bind_int64(&s, job->starts);
	esk_bind_int64(&s, job->status);
	esk_bind_text(&s, job->content_type[0] ? job->content_type : NULL);
	esk_bind_int64(&s, (int64_t)job->size);
	esk_bind_double(&s, job->seconds);
	esk_bind_text(&s, job->problem[0] ? job->problem : NULL);
	esk_bind_text(&s, job->id);
	return esk_statement_run(&s, error);
}

eskel_store_status eskel_store_job_update(eskel_store *store, const eskel_job *job, eskel_store_error *error)
{
	return esk_write(store, update, (void *)job, error);
}

static eskel_store_status remove_row(sqlite3 *writer, void *context, eskel_store_error *error)
{
	esk_statement s = esk_statement_begin(writer, "DELETE FROM job WHERE id = ?");
	esk_bind_text(&s, context);
	return esk_statement_run(&s, error);
}

eskel_store_status eskel_store_job_remove(eskel_store *store, const char *id, eskel_store_error *error)
{
	return esk_write(store, remove_row, (void *)id, error);
}

/* ---- all of them */

static eskel_job read_row(esk_statement *s)
{
	eskel_job job = {0};
	esk_column_copy(s, job.id, sizeof job.id);
	esk_column_copy(s, job.created, sizeof job.created);
	job.request = esk_column_text(s);
	job.state = (eskel_job_state)esk_column_name(s, states, state_count);
	job.starts = (uint32_t)esk_column_int64(s);
	job.status = (int)esk_column_int64(s);
	esk_column_copy(s, job.content_type, sizeof job.content_type);
	job.size = (uint64_t)esk_column_int64(s);
	job.seconds = esk_column_double(s);
	esk_column_copy(s, job.problem, sizeof job.problem);
	return job;
}

eskel_store_status eskel_store_jobs(eskel_store *store, eskel_job **jobs, size_t *count, eskel_store_error *error)
{
	eskel_job *read = NULL;
	size_t read_count = 0;
	sqlite3 *db = NULL;
	eskel_store_status status = esk_read_begin(store, &db, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_statement s = esk_statement_begin(db,
		"SELECT id, " CREATED ", request, state, starts, status, content_type, size, seconds, problem"
		" FROM job ORDER BY number");
	while (esk_statement_row(&s)) {
		if (!esk_array_grow((void **)&read, read_count, sizeof read[0])) {
			esk_statement_fail(&s, SQLITE_NOMEM);
			break;
		}
		read[read_count++] = read_row(&s);
	}
	status = esk_statement_end(&s, error);
	esk_read_end(store, db);
	if (status != ESKEL_STORE_OK) {
		eskel_jobs_free(read, read_count);
		return status;
	}
	*jobs = read;
	*count = read_count;
	return ESKEL_STORE_OK;
}
