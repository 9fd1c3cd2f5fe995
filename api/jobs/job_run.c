/* The thread that answers jobs into files, see job.h. */
#include "job_list.h"

#include "clock.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static bool is_wanted(esk_jobs *jobs, const esk_job_entry *e)
{
	pthread_mutex_lock(&jobs->reading);
	const bool wanted = !e->removed && !jobs->stopped;
	pthread_mutex_unlock(&jobs->reading);
	return wanted;
}

/* Counts bytes of the answer to come, in the place of answers that ended before if need be. */
static bool make_space(esk_jobs *jobs, esk_job_entry *e, size_t size, double progress)
{
	pthread_mutex_lock(&jobs->reading);
	e->row.size += size;
	e->progress = progress;
	bool room = esk_jobs_fit(jobs);
	pthread_mutex_unlock(&jobs->reading);
	if (room)
		return true;
	pthread_mutex_lock(&jobs->changing);
	for (const esk_job_entry *ended; !room && (ended = esk_jobs_oldest_ended(jobs, 1));) {
		if (esk_jobs_forget(jobs, ended->row.id, NULL) != ESKEL_STORE_OK)
			break;
		room = esk_jobs_fit(jobs);
	}
	pthread_mutex_unlock(&jobs->changing);
	return room;
}

static bool write_piece(esk_jobs *jobs, esk_job_entry *e, eskel_file *file, const void *bytes, size_t size,
	double progress, esk_problem *problem)
{
	eskel_store_error error;
	if (!make_space(jobs, e, size, progress))
		return esk_problem_set(problem, 413,
			"the result has at least %" PRIu64 " bytes, expected at most %" PRIu64, e->row.size,
			jobs->api->options.most_result_bytes);
	return size == 0 || esk_problem_store(problem, eskel_file_write(file, bytes, size, &error), &error);
}

static bool write_answer(
	esk_jobs *jobs, esk_job_entry *e, eskel_exchange *exchange, eskel_file *file, esk_problem *problem)
{
	const eskel_response *response = eskel_exchange_response(exchange);
	const esk_stream *stream = &exchange->stream;
	if (!response->streamed)
		return write_piece(jobs, e, file, response->body, response->size, 1, problem);
	for (size_t size = 1; size > 0;) {
		const void *bytes = NULL;
		if (!is_wanted(jobs, e))
			return esk_problem_set(problem, 503, "the job was broken off");
		if (!eskel_exchange_next(exchange, &bytes, &size))
			return esk_problem_no_memory(problem);
		const double progress = stream->progress ? stream->progress(stream->source) : 0;
		if (!write_piece(jobs, e, file, bytes, size, progress, problem))
			return false;
	}
	return true;
}

/* Leaves the whole answer on disk under the job's id. */
static bool store_answer(esk_jobs *jobs, esk_job_entry *e, eskel_exchange *exchange, esk_problem *problem)
{
	eskel_store_error error;
	eskel_file *file = NULL;
	eskel_store_status status = eskel_file_create(jobs->folder, e->row.id, &file, &error);
	if (status != ESKEL_STORE_OK)
		return esk_problem_store(problem, status, &error);
	if (!write_answer(jobs, e, exchange, file, problem)) {
		eskel_file_discard(file);
		return false;
	}
	return esk_problem_store(problem, eskel_file_keep(file, &error), &error);
}

typedef struct {
	esk_jobs *jobs;
	esk_job_entry *entry;
} watch;

/* An exchange's progress. */
static bool note_share(void *context, double share)
{
	watch *w = context;
	pthread_mutex_lock(&w->jobs->reading);
	w->entry->progress = share;
	pthread_mutex_unlock(&w->jobs->reading);
	return is_wanted(w->jobs, w->entry);
}

static void answer(esk_jobs *jobs, esk_job_entry *e, eskel_job *row)
{
	watch w = {jobs, e};
	esk_problem problem = {0};
	eskel_exchange *exchange = esk_job_request_begin(jobs->api, row->request);
	if (exchange) {
		exchange->progress = note_share;
		exchange->progress_context = &w;
		eskel_exchange_finish(exchange);
		const eskel_response *response = eskel_exchange_response(exchange);
		snprintf(row->content_type, sizeof row->content_type, "%s",
			response->content_type ? response->content_type : "");
		row->status = response->status;
		if (response->status != 200)
			problem = exchange->problem;
		else
			store_answer(jobs, e, exchange, &problem);
	} else {
		esk_problem_no_memory(&problem);
	}
	eskel_exchange_free(exchange);
	row->state = problem.status ? ESKEL_JOB_FAILED : ESKEL_JOB_DONE;
	row->size = problem.status ? 0 : e->row.size;
	row->starts = 0;
	if (problem.status)
		row->status = problem.status;
	memcpy(row->problem, problem.text, sizeof row->problem);
}

/* The end of a job that somebody still wants. */
static void end(esk_jobs *jobs, esk_job_entry *e, eskel_job *row)
{
	eskel_store_error error;
	if (esk_jobs_settle(jobs, e, row, &error) == ESKEL_STORE_OK)
		return;
	/* in memory alone: the next start takes it for one that is still to run */
	eskel_folder_remove(jobs->folder, row->id);
	*row = esk_job_queued_again(row);
	row->state = ESKEL_JOB_FAILED;
	row->status = 503;
	snprintf(row->problem, sizeof row->problem, "%s", error.text);
	esk_jobs_note(jobs, e, row);
}

static void run_job(esk_jobs *jobs, esk_job_entry *e)
{
	eskel_job row = esk_job_queued_again(&e->row);
	row.starts = e->row.starts + 1;
	eskel_store_job_update(jobs->api->store, &row, NULL); /* what cannot be written fails at its end */
	eskel_job ended = row;
	answer(jobs, e, &ended);
	ended.seconds = (esk_clock_milliseconds() - e->begun) / 1e3;
	if (ended.state == ESKEL_JOB_FAILED && !is_wanted(jobs, e)) {
		ended = row; /* it is still to be done, and an orderly stop is not its fault */
		ended.starts--;
	}
	pthread_mutex_lock(&jobs->changing);
	const bool removed = e->removed;
	if (removed)
		eskel_folder_remove(jobs->folder, row.id);
	else
		end(jobs, e, &ended);
	pthread_mutex_lock(&jobs->reading);
	e->running = false;
	pthread_mutex_unlock(&jobs->reading);
	pthread_mutex_unlock(&jobs->changing);
	if (removed)
		esk_job_entry_free(e);
}

/* The next to run, NULL to stop. Under the lock reading. */
static esk_job_entry *take_next(esk_jobs *jobs)
{
	while (!jobs->stopped) {
		for (size_t i = 0; i < jobs->count; i++)
			if (jobs->entries[i]->row.state == ESKEL_JOB_QUEUED)
				return jobs->entries[i];
		pthread_cond_wait(&jobs->added, &jobs->reading);
	}
	return NULL;
}

static void *run(void *context)
{
	esk_jobs *jobs = context;
	esk_job_entry *e;
	pthread_mutex_lock(&jobs->reading);
	while ((e = take_next(jobs))) {
		e->running = true;
		e->begun = esk_clock_milliseconds();
		pthread_mutex_unlock(&jobs->reading);
		run_job(jobs, e);
		pthread_mutex_lock(&jobs->reading);
	}
	pthread_mutex_unlock(&jobs->reading);
	return NULL;
}

bool esk_jobs_start(esk_jobs *jobs)
{
	if (!jobs->started)
		jobs->started = pthread_create(&jobs->thread, NULL, run, jobs) == 0;
	return jobs->started;
}
