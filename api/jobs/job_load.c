/* Jobs that an earlier process left, see job.h. */
#include "job_list.h"

#include <stdlib.h>
#include <unistd.h>

/* What a row of the store means to this process: an answer that is gone is made again, a job that brought the server down
 * too often is not. */
static void judge(esk_jobs *jobs, eskel_job *row)
{
	int descriptor = -1;
	uint64_t size = 0;
	if (row->state == ESKEL_JOB_DONE) {
		eskel_file_open(jobs->folder, row->id, false, &descriptor, &size, NULL);
		if (descriptor < 0 || size != row->size)
			*row = esk_job_queued_again(row);
		if (descriptor >= 0)
			close(descriptor);
	} else if (row->state == ESKEL_JOB_QUEUED && row->starts >= ESK_JOB_STARTS) {
		row->state = ESKEL_JOB_FAILED;
		row->status = 500;
		snprintf(row->problem, sizeof row->problem,
			"the server ended %u times while it ran, expected fewer than %d times: it is not begun again",
			row->starts, ESK_JOB_STARTS);
	}
}

/* Takes the row when it succeeds. */
static eskel_store_status take_up(esk_jobs *jobs, eskel_job *row, eskel_store_error *error)
{
	const eskel_job_state state = row->state;
	esk_job_entry *e = calloc(1, sizeof *e);
	if (!e)
		return ESKEL_STORE_NO_MEMORY;
	judge(jobs, row);
	const eskel_store_status status =
		row->state == state ? ESKEL_STORE_OK : eskel_store_job_update(jobs->api->store, row, error);
	if (status != ESKEL_STORE_OK) {
		free(e);
		return status;
	}
	e->row = *row;
	row->request = NULL;
	esk_job_request_path(e->row.request, e->path);
	jobs->entries[jobs->count++] = e;
	return ESKEL_STORE_OK;
}

static bool is_answer(void *context, const char *name, uint64_t size, int64_t used)
{
	const esk_jobs *jobs = context;
	const size_t i = esk_jobs_place_of(jobs, name);
	(void)size;
	(void)used;
	return i < jobs->count && jobs->entries[i]->row.state == ESKEL_JOB_DONE;
}

eskel_store_status esk_jobs_take_up(esk_jobs *jobs, eskel_store_error *error)
{
	eskel_job *rows = NULL;
	size_t count = 0;
	eskel_store_status status = eskel_store_jobs(jobs->api->store, &rows, &count, error);
	for (size_t i = 0; i < count && jobs->count < ESK_JOBS_MOST && status == ESKEL_STORE_OK; i++)
		status = take_up(jobs, &rows[i], error);
	eskel_jobs_free(rows, count);
	if (status == ESKEL_STORE_OK)
		status = eskel_folder_each(jobs->folder, is_answer, jobs, error);
	return status;
}
