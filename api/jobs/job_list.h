/* The list of jobs in memory, and its changes, which are those of the store.
 *
 * Whoever changes both holds the lock changing: first the store is changed, then the list. What others read is written
 * under the lock reading, which nobody holds while he waits for the disk. An answer is whole under its name before its row
 * says so: what a crash leaves between the two is swept at the start. */
#ifndef ESK_JOB_LIST_H
#define ESK_JOB_LIST_H

#include "job.h"

#include <pthread.h>

typedef struct {
	eskel_job row; /* as in the store, but for the size of an answer that grows */
	char path[ESK_JOB_PATH_SIZE];
	bool running, removed;  /* the thread frees what is removed while it runs */
	bool verified;          /* the answer, in this process */
	double progress, begun; /* esk_clock_milliseconds */
} esk_job_entry;

struct esk_jobs {
	eskel_api *api;
	eskel_folder *folder;
	pthread_mutex_t changing, reading;
	pthread_cond_t added;
	pthread_t thread;
	bool started, stopped;
	unsigned watchers;
	size_t count;
	esk_job_entry *entries[ESK_JOBS_MOST]; /* oldest first */
};

void esk_job_entry_free(esk_job_entry *e);
/* What there is to say of it. Under the lock reading. */
esk_job esk_job_entry_copy(const esk_job_entry *e);
/* The same job, all of it still to be done; refers to the row's request. */
eskel_job esk_job_queued_again(const eskel_job *row);

/* ---- under either lock */

/* count when there is none. */
size_t esk_jobs_place_of(const esk_jobs *jobs, const char *id);
/* The one that ended first and whose answer has at least so many bytes, NULL without one. */
const esk_job_entry *esk_jobs_oldest_ended(const esk_jobs *jobs, uint64_t least);
/* Whether the answers together have no more bytes than they may. */
bool esk_jobs_fit(const esk_jobs *jobs);

/* ---- under the lock changing */

/* Removes one that is there, with its answer. */
eskel_store_status esk_jobs_forget(esk_jobs *jobs, const char *id, eskel_store_error *error);
/* Says what has become of a job, and wakes the thread. */
void esk_jobs_note(esk_jobs *jobs, esk_job_entry *e, const eskel_job *row);
/* The same, once it is stored. */
eskel_store_status esk_jobs_settle(esk_jobs *jobs, esk_job_entry *e, const eskel_job *row, eskel_store_error *error);

/* ---- the other parts */

/* Reads the list from the store and sweeps the folder; before any thread knows of the list (job_load.c). */
eskel_store_status esk_jobs_take_up(esk_jobs *jobs, eskel_store_error *error);
/* Starts the thread that runs what is queued, unless it is there; false when there can be none (job_run.c). Under the lock
 * changing. */
bool esk_jobs_start(esk_jobs *jobs);

#endif
