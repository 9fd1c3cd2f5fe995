/* Jobs and the thread that runs them, see job.h. */
#include "job.h"

#include "clock.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

typedef struct entry {
	esk_job job;
	double begun;             /* esk_clock_milliseconds */
	eskel_exchange *exchange; /* of the thread alone; NULL once it has ended */
	FILE *file;
	bool removed;
} entry;

struct esk_jobs {
	eskel_api *api;
	pthread_mutex_t lock;
	pthread_cond_t added;
	pthread_t thread;
	bool started, stopped;
	size_t count;
	entry *entries[ESK_JOBS_MOST]; /* oldest first */
};

static void free_entry(entry *e)
{
	if (!e)
		return;
	eskel_exchange_free(e->exchange);
	if (e->file)
		fclose(e->file);
	free(e);
}

/* ---- running; what others read is written under the lock */

static bool is_wanted(esk_jobs *jobs, const entry *e)
{
	pthread_mutex_lock(&jobs->lock);
	bool wanted = !e->removed && !jobs->stopped;
	pthread_mutex_unlock(&jobs->lock);
	return wanted;
}

static void note_progress(esk_jobs *jobs, entry *e, double progress, size_t written)
{
	pthread_mutex_lock(&jobs->lock);
	e->job.progress = progress;
	e->job.size += written;
	pthread_mutex_unlock(&jobs->lock);
}

/* NULL, or what went wrong. */
static const char *write_piece(esk_jobs *jobs, entry *e, const void *bytes, size_t size, double progress)
{
	if (size > 0 && fwrite(bytes, 1, size, e->file) != size)
		return strerror(errno);
	note_progress(jobs, e, progress, size);
	return NULL;
}

static const char *write_stream(esk_jobs *jobs, entry *e)
{
	const esk_stream *stream = &e->exchange->stream;
	const char *wrong = NULL;
	for (size_t size = 1; !wrong && size > 0;) {
		const void *bytes = NULL;
		if (!is_wanted(jobs, e))
			return "the job was cancelled";
		if (!eskel_exchange_next(e->exchange, &bytes, &size))
			return "memory ran out";
		wrong = write_piece(jobs, e, bytes, size, stream->progress ? stream->progress(stream->source) : 0);
	}
	return wrong;
}

static const char *answer(esk_jobs *jobs, entry *e)
{
	eskel_exchange_finish(e->exchange);
	const eskel_response *response = eskel_exchange_response(e->exchange);
	if (response->status != 200)
		return e->exchange->problem.text;
	const char *wrong =
		response->streamed ? write_stream(jobs, e) : write_piece(jobs, e, response->body, response->size, 1);
	return !wrong && fflush(e->file) ? strerror(errno) : wrong;
}

static void end(esk_jobs *jobs, entry *e, const char *wrong)
{
	const eskel_response *response = eskel_exchange_response(e->exchange);
	pthread_mutex_lock(&jobs->lock);
	e->job.state = wrong ? ESK_JOB_FAILED : ESK_JOB_DONE;
	e->job.seconds = (esk_clock_milliseconds() - e->begun) / 1e3;
	e->job.status = wrong && response->status == 200 ? 503 : response->status;
	e->job.content_type = response->content_type;
	if (!wrong)
		e->job.progress = 1;
	snprintf(e->job.problem, sizeof e->job.problem, "%s", wrong ? wrong : "");
	eskel_exchange *ended = e->exchange;
	e->exchange = NULL;
	const bool removed = e->removed;
	pthread_mutex_unlock(&jobs->lock);
	eskel_exchange_free(ended);
	if (removed)
		free_entry(e);
}

/* The next to run, NULL to stop. Under the lock. */
static entry *take_next(esk_jobs *jobs)
{
	while (!jobs->stopped) {
		for (size_t i = 0; i < jobs->count; i++)
			if (jobs->entries[i]->job.state == ESK_JOB_QUEUED)
				return jobs->entries[i];
		pthread_cond_wait(&jobs->added, &jobs->lock);
	}
	return NULL;
}

static void *run(void *context)
{
	esk_jobs *jobs = context;
	entry *e;
	pthread_mutex_lock(&jobs->lock);
	while ((e = take_next(jobs))) {
		e->job.state = ESK_JOB_RUNNING;
		e->begun = esk_clock_milliseconds();
		pthread_mutex_unlock(&jobs->lock);
		end(jobs, e, answer(jobs, e));
		pthread_mutex_lock(&jobs->lock);
	}
	pthread_mutex_unlock(&jobs->lock);
	return NULL;
}

/* ---- the list; under the lock */

static size_t place_of(const esk_jobs *jobs, const char *id)
{
	size_t i = 0;
	while (i < jobs->count && strcmp(jobs->entries[i]->job.id, id) != 0)
		i++;
	return i;
}

static esk_job copy(const entry *e)
{
	esk_job job = e->job;
	if (job.state == ESK_JOB_RUNNING)
		job.seconds = (esk_clock_milliseconds() - e->begun) / 1e3;
	return job;
}

/* The thread frees what it is running. */
static void remove_at(esk_jobs *jobs, size_t i)
{
	entry *e = jobs->entries[i];
	jobs->count--;
	memmove(&jobs->entries[i], &jobs->entries[i + 1], (jobs->count - i) * sizeof *jobs->entries);
	e->removed = true;
	if (e->job.state != ESK_JOB_RUNNING)
		free_entry(e);
}

static bool make_room(esk_jobs *jobs)
{
	for (size_t i = 0; jobs->count == ESK_JOBS_MOST && i < jobs->count; i++)
		if (jobs->entries[i]->job.state >= ESK_JOB_DONE)
			remove_at(jobs, i);
	return jobs->count < ESK_JOBS_MOST;
}

static bool start(esk_jobs *jobs)
{
	if (!jobs->started)
		jobs->started = pthread_create(&jobs->thread, NULL, run, jobs) == 0;
	return jobs->started;
}

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

static entry *make_entry(const eskel_exchange *exchange, const char *path)
{
	const eskel_request request = {
		.method = "GET",
		.path = path,
		.query_count = exchange->query_count,
		.query = exchange->query_fields,
		.header_count = exchange->header_count,
		.headers = exchange->headers,
		.role = exchange->role,
		.actor = exchange->actor,
	};
	entry *e = calloc(1, sizeof *e);
	if (!e)
		return NULL;
	e->exchange = eskel_api_begin(exchange->api, &request);
	e->file = tmpfile();
	if (e->exchange && e->file && write_id(e->job.id))
		return e;
	free_entry(e);
	return NULL;
}

bool esk_jobs_add(esk_jobs *jobs, eskel_exchange *exchange, const char *path, esk_job *job)
{
	entry *e = make_entry(exchange, path);
	if (!e)
		return esk_problem_set(&exchange->problem, 503, "there is no memory or no temporary file for the job");
	pthread_mutex_lock(&jobs->lock);
	const bool taken = make_room(jobs) && start(jobs);
	if (taken) {
		jobs->entries[jobs->count++] = e;
		*job = copy(e);
		pthread_cond_signal(&jobs->added);
	}
	pthread_mutex_unlock(&jobs->lock);
	if (taken)
		return true;
	free_entry(e);
	return esk_problem_set(&exchange->problem, 503,
		"%d jobs are waiting, expected fewer; try again later, or "
		"delete one",
		ESK_JOBS_MOST);
}

size_t esk_jobs_list(esk_jobs *jobs, esk_job list[ESK_JOBS_MOST])
{
	pthread_mutex_lock(&jobs->lock);
	const size_t count = jobs->count;
	for (size_t i = 0; i < count; i++)
		list[i] = copy(jobs->entries[i]);
	pthread_mutex_unlock(&jobs->lock);
	return count;
}

bool esk_jobs_find(esk_jobs *jobs, const char *id, esk_job *job)
{
	pthread_mutex_lock(&jobs->lock);
	const size_t i = place_of(jobs, id);
	const bool found = i < jobs->count;
	if (found)
		*job = copy(jobs->entries[i]);
	pthread_mutex_unlock(&jobs->lock);
	return found;
}

bool esk_jobs_remove(esk_jobs *jobs, const char *id)
{
	pthread_mutex_lock(&jobs->lock);
	const size_t i = place_of(jobs, id);
	const bool found = i < jobs->count;
	if (found)
		remove_at(jobs, i);
	pthread_mutex_unlock(&jobs->lock);
	return found;
}

int esk_jobs_open(esk_jobs *jobs, const char *id)
{
	pthread_mutex_lock(&jobs->lock);
	const size_t i = place_of(jobs, id);
	const bool done = i < jobs->count && jobs->entries[i]->job.state == ESK_JOB_DONE;
	const int file = done ? dup(fileno(jobs->entries[i]->file)) : -1;
	pthread_mutex_unlock(&jobs->lock);
	return file;
}

/* ---- life */

esk_jobs *esk_jobs_new(eskel_api *api)
{
	esk_jobs *made = calloc(1, sizeof *made);
	if (!made)
		return NULL;
	made->api = api;
	pthread_mutex_init(&made->lock, NULL);
	pthread_cond_init(&made->added, NULL);
	return made;
}

void esk_jobs_free(esk_jobs *jobs)
{
	if (!jobs)
		return;
	pthread_mutex_lock(&jobs->lock);
	jobs->stopped = true;
	pthread_cond_signal(&jobs->added);
	pthread_mutex_unlock(&jobs->lock);
	if (jobs->started)
		pthread_join(jobs->thread, NULL);
	while (jobs->count > 0)
		remove_at(jobs, jobs->count - 1);
	pthread_cond_destroy(&jobs->added);
	pthread_mutex_destroy(&jobs->lock);
	free(jobs);
}
