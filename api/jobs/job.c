/* What requests do with jobs, and the life of their list, see job.h. */
#include "job.h"

#include "job_list.h"

#include <stdlib.h>
#include <sys/random.h>

/* ---- what requests do */

static bool write_id(char id[ESKEL_ID_SIZE])
{
	unsigned char bytes[(ESKEL_ID_SIZE - 1) / 2];
	if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
		return false;
	for (size_t i = 0; i < sizeof bytes; i++)
		snprintf(id + 2 * i, 3, "%02x", bytes[i]);
	return true;
}

static esk_job_entry *make_entry(const eskel_exchange *exchange, const char *method, const char *path)
{
	esk_job_entry *e = calloc(1, sizeof *e);
	if (!e)
		return NULL;
	snprintf(e->path, sizeof e->path, "%s", path);
	e->row.request = esk_job_request_text(exchange, method, path);
	if (e->row.request && write_id(e->row.id))
		return e;
	esk_job_entry_free(e);
	return NULL;
}

/* Under the lock changing. */
static bool make_room(esk_jobs *jobs, esk_problem *problem)
{
	eskel_store_error error;
	const esk_job_entry *ended = jobs->count == ESK_JOBS_MOST ? esk_jobs_oldest_ended(jobs, 0) : NULL;
	if (ended)
		return esk_problem_store(problem, esk_jobs_forget(jobs, ended->row.id, &error), &error);
	return jobs->count < ESK_JOBS_MOST || esk_problem_set(problem, 503,
						      "%d jobs are waiting, expected fewer; try again later, or "
						      "delete one",
						      ESK_JOBS_MOST);
}

/* Takes the entry when it succeeds. Under the lock changing. */
static bool add(esk_jobs *jobs, esk_job_entry *e, esk_job *job, esk_problem *problem)
{
	eskel_store_error error;
	if (!make_room(jobs, problem))
		return false;
	if (!esk_jobs_start(jobs))
		return esk_problem_set(problem, 503, "there is no thread for the job; try again later");
	if (!esk_problem_store(problem, eskel_store_job_add(jobs->api->store, &e->row, &error), &error))
		return false;
	pthread_mutex_lock(&jobs->reading);
	jobs->entries[jobs->count++] = e;
	*job = esk_job_entry_copy(e);
	pthread_cond_signal(&jobs->added);
	pthread_mutex_unlock(&jobs->reading);
	return true;
}

bool esk_jobs_add(esk_jobs *jobs, eskel_exchange *exchange, const char *method, const char *path, esk_job *job)
{
	esk_job_entry *e = make_entry(exchange, method, path);
	if (!e)
		return esk_problem_no_memory(&exchange->problem);
	pthread_mutex_lock(&jobs->changing);
	const bool added = add(jobs, e, job, &exchange->problem);
	pthread_mutex_unlock(&jobs->changing);
	if (!added)
		esk_job_entry_free(e);
	return added;
}

size_t esk_jobs_list(esk_jobs *jobs, esk_job list[ESK_JOBS_MOST])
{
	pthread_mutex_lock(&jobs->reading);
	const size_t count = jobs->count;
	for (size_t i = 0; i < count; i++)
		list[i] = esk_job_entry_copy(jobs->entries[i]);
	pthread_mutex_unlock(&jobs->reading);
	return count;
}

bool esk_jobs_find(esk_jobs *jobs, const char *id, esk_job *job)
{
	pthread_mutex_lock(&jobs->reading);
	const size_t i = esk_jobs_place_of(jobs, id);
	const bool found = i < jobs->count;
	if (found)
		*job = esk_job_entry_copy(jobs->entries[i]);
	pthread_mutex_unlock(&jobs->reading);
	return found;
}

bool esk_jobs_remove(esk_jobs *jobs, const char *id, esk_problem *problem)
{
	eskel_store_error error;
	pthread_mutex_lock(&jobs->changing);
	const bool removed = esk_jobs_place_of(jobs, id) < jobs->count
				     ? esk_problem_store(problem, esk_jobs_forget(jobs, id, &error), &error)
				     : esk_problem_no_job(problem, id);
	pthread_mutex_unlock(&jobs->changing);
	return removed;
}

/* Queues a job again whose answer is not what it was. */
static bool repeat(esk_jobs *jobs, const char *id, esk_problem *problem)
{
	eskel_store_error error = {0};
	eskel_store_status status = ESKEL_STORE_OK;
	pthread_mutex_lock(&jobs->changing);
	const size_t i = esk_jobs_place_of(jobs, id);
	esk_job_entry *e = i < jobs->count ? jobs->entries[i] : NULL;
	if (e && e->row.state == ESKEL_JOB_DONE) {
		const eskel_job again = esk_job_queued_again(&e->row);
		status = esk_jobs_start(jobs) ? esk_jobs_settle(jobs, e, &again, &error) : ESKEL_STORE_NO_MEMORY;
	}
	pthread_mutex_unlock(&jobs->changing);
	if (!e)
		return esk_problem_no_job(problem, id);
	return esk_problem_store(problem, status, &error) &&
	       esk_problem_set(
		       problem, 409, "the result was damaged; the job is done again, ask for its state until then");
}

bool esk_jobs_result(esk_jobs *jobs, const char *id, int *descriptor, esk_problem *problem)
{
	eskel_store_error error;
	uint64_t size;
	pthread_mutex_lock(&jobs->reading);
	size_t i = esk_jobs_place_of(jobs, id);
	const bool verify = i == jobs->count || !jobs->entries[i]->verified;
	pthread_mutex_unlock(&jobs->reading);
	const eskel_store_status status = eskel_file_open(jobs->folder, id, verify, descriptor, &size, &error);
	if (status == ESKEL_STORE_CORRUPT || status == ESKEL_STORE_NOT_FOUND)
		return repeat(jobs, id, problem);
	if (status != ESKEL_STORE_OK)
		return esk_problem_store(problem, status, &error);
	pthread_mutex_lock(&jobs->reading);
	i = esk_jobs_place_of(jobs, id);
	if (i < jobs->count)
		jobs->entries[i]->verified = true;
	pthread_mutex_unlock(&jobs->reading);
	return true;
}

bool esk_jobs_watch(esk_jobs *jobs, esk_problem *problem)
{
	pthread_mutex_lock(&jobs->reading);
	const bool room = jobs->watchers < ESK_JOB_WATCHERS_MOST;
	jobs->watchers += room;
	pthread_mutex_unlock(&jobs->reading);
	return room || esk_problem_set(problem, 503,
			       "%d streams of events are open, expected fewer; try again later, or ask for the job's "
			       "state",
			       ESK_JOB_WATCHERS_MOST);
}

void esk_jobs_unwatch(esk_jobs *jobs)
{
	pthread_mutex_lock(&jobs->reading);
	jobs->watchers--;
	pthread_mutex_unlock(&jobs->reading);
}

/* ---- life */

eskel_store_status esk_jobs_new(eskel_api *api, esk_jobs **jobs, eskel_store_error *error)
{
	esk_jobs *made = calloc(1, sizeof *made);
	if (!made)
		return ESKEL_STORE_NO_MEMORY;
	made->api = api;
	pthread_mutex_init(&made->changing, NULL);
	pthread_mutex_init(&made->reading, NULL);
	pthread_cond_init(&made->added, NULL);
	eskel_store_status status = eskel_folder_open(api->store, "jobs", &made->folder, error);
	if (status == ESKEL_STORE_OK)
		status = esk_jobs_take_up(made, error);
	if (status != ESKEL_STORE_OK) {
		esk_jobs_free(made);
		return status;
	}
	*jobs = made;
	return ESKEL_STORE_OK;
}

void esk_jobs_begin(esk_jobs *jobs)
{
	pthread_mutex_lock(&jobs->changing);
	for (size_t i = 0; i < jobs->count && !jobs->started; i++)
		if (jobs->entries[i]->row.state == ESKEL_JOB_QUEUED)
			esk_jobs_start(jobs);
	pthread_mutex_unlock(&jobs->changing);
}

void esk_jobs_free(esk_jobs *jobs)
{
	if (!jobs)
		return;
	pthread_mutex_lock(&jobs->reading);
	jobs->stopped = true;
	pthread_cond_signal(&jobs->added);
	pthread_mutex_unlock(&jobs->reading);
	if (jobs->started)
		pthread_join(jobs->thread, NULL);
	while (jobs->count > 0)
		esk_job_entry_free(jobs->entries[--jobs->count]);
	eskel_folder_close(jobs->folder);
	pthread_cond_destroy(&jobs->added);
	pthread_mutex_destroy(&jobs->reading);
	pthread_mutex_destroy(&jobs->changing);
	free(jobs);
}
