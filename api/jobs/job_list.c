/* The list of jobs, see job_list.h. */
#include "job_list.h"

#include "clock.h"

#include <stdlib.h>
#include <string.h>

void esk_job_entry_free(esk_job_entry *e)
{
	if (!e)
		return;
	free(e->row.request);
	free(e);
}

size_t esk_jobs_place_of(const esk_jobs *jobs, const char *id)
{
	size_t i = 0;
	while (i < jobs->count && strcmp(jobs->entries[i]->row.id, id) != 0)
		i++;
	return i;
}

esk_job esk_job_entry_copy(const esk_job_entry *e)
{
	static const esk_job_state states[] = {
		[ESKEL_JOB_QUEUED] = ESK_JOB_QUEUED,
		[ESKEL_JOB_DONE] = ESK_JOB_DONE,
		[ESKEL_JOB_FAILED] = ESK_JOB_FAILED,
	};
	const eskel_job *row = &e->row;
	esk_job job = {
		.state = e->running ? ESK_JOB_RUNNING : states[row->state],
		.progress = row->state == ESKEL_JOB_DONE ? 1 : e->progress,
		.seconds = e->running ? (esk_clock_milliseconds() - e->begun) / 1e3 : row->seconds,
		.size = row->size,
		.status = row->status,
	};
	memcpy(job.id, row->id, sizeof job.id);
	memcpy(job.created, row->created, sizeof job.created);
	memcpy(job.path, e->path, sizeof job.path);
	memcpy(job.content_type, row->content_type, sizeof job.content_type);
	memcpy(job.problem, row->problem, sizeof job.problem);
	return job;
}

const esk_job_entry *esk_jobs_oldest_ended(const esk_jobs *jobs, uint64_t least)
{
	for (size_t i = 0; i < jobs->count; i++)
		if (jobs->entries[i]->row.state != ESKEL_JOB_QUEUED && jobs->entries[i]->row.size >= least)
			return jobs->entries[i];
	return NULL;
}

bool esk_jobs_fit(const esk_jobs *jobs)
{
	uint64_t size = 0;
	for (size_t i = 0; i < jobs->count; i++)
		size += jobs->entries[i]->row.size;
	return size <= jobs->api->options.most_result_bytes;
}

/* The thread frees what it is running. */
static void unlist(esk_jobs *jobs, const char *id)
{
	pthread_mutex_lock(&jobs->reading);
	const size_t i = esk_jobs_place_of(jobs, id);
	esk_job_entry *e = jobs->entries[i];
	jobs->count--;
	memmove(&jobs->entries[i], &jobs->entries[i + 1], (jobs->count - i) * sizeof *jobs->entries);
	e->removed = true;
	const bool running = e->running;
	pthread_mutex_unlock(&jobs->reading);
	if (!running)
		esk_job_entry_free(e);
}

eskel_store_status esk_jobs_forget(esk_jobs *jobs, const char *id, eskel_store_error *error)
{
	char name[ESKEL_ID_SIZE]; /* id may be the entry's */
	memcpy(name, id, sizeof name);
	const eskel_store_status status = eskel_store_job_remove(jobs->api->store, name, error);
	if (status != ESKEL_STORE_OK)
		return status;
	unlist(jobs, name);
	eskel_folder_remove(jobs->folder, name);
	return ESKEL_STORE_OK;
}

void esk_jobs_note(esk_jobs *jobs, esk_job_entry *e, const eskel_job *row)
{
	pthread_mutex_lock(&jobs->reading);
	e->row = *row;
	e->verified = false;
	if (row->state == ESKEL_JOB_QUEUED)
		e->progress = 0;
	pthread_cond_signal(&jobs->added);
	pthread_mutex_unlock(&jobs->reading);
}

eskel_store_status esk_jobs_settle(esk_jobs *jobs, esk_job_entry *e, const eskel_job *row, eskel_store_error *error)
{
	const eskel_store_status status = eskel_store_job_update(jobs->api->store, row, error);
	if (status != ESKEL_STORE_OK)
		return status;
	esk_jobs_note(jobs, e, row);
	return ESKEL_STORE_OK;
}

eskel_job esk_job_queued_again(const eskel_job *row)
{
	eskel_job again = {.request = row->request};
	memcpy(again.id, row->id, sizeof again.id);
	memcpy(again.created, row->created, sizeof again.created);
	return again;
}
