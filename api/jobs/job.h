/* Long answers that nobody has to wait for: a job is a request that is answered into a file, in a thread of its own.
 *
 * Jobs run one after the other, oldest first, for each uses all processors. They are rows of the store, and their answers
 * files in a folder beside it, so they outlive the process: a job that was accepted and has not ended is begun anew after
 * a restart, however the server went. That is harmless: it answers a GET, or makes again what is stored in one place. One
 * that was begun ESK_JOB_STARTS times and each time was there when the server was killed or fell has failed, lest it bring
 * it down for ever.
 *
 * When there are ESK_JOBS_MOST, a new one takes the place of the one that ended first; when the answers together need more
 * than most_result_bytes, those that ended first are forgotten. An answer that is damaged or gone is made again. */
#ifndef ESK_JOB_H
#define ESK_JOB_H

#include "exchange.h"
#include "job_request.h"

#define ESK_JOBS_MOST 16
#define ESK_JOB_STARTS 3
#define ESK_JOB_WATCHERS_MOST 64

typedef enum { ESK_JOB_QUEUED, ESK_JOB_RUNNING, ESK_JOB_DONE, ESK_JOB_FAILED } esk_job_state;

/* A copy of what there is to say of one. */
typedef struct {
	char id[ESKEL_ID_SIZE];
	char created[25];             /* UTC, as a shape's */
	char path[ESK_JOB_PATH_SIZE]; /* of what it answers */
	esk_job_state state;
	double progress;       /* share that is done, 0 to 1 */
	double seconds;        /* since it began to run, or that it ran */
	uint64_t size;         /* bytes of the answer; those so far while it runs */
	int status;            /* of the answer; 0 before */
	char content_type[65]; /* of the answer; "" before */
	char problem[640];     /* why it failed, "" unless it did */
} esk_job;

typedef struct esk_jobs esk_jobs;

/* Takes up those that the store has; error is left alone when memory ran out. */
eskel_store_status esk_jobs_new(eskel_api *api, esk_jobs **jobs, eskel_store_error *error);
/* Begins those that have not ended, once the api is whole. */
void esk_jobs_begin(esk_jobs *jobs);
/* Breaks off the one that runs, which stays queued in the store. */
void esk_jobs_free(esk_jobs *jobs);

/* A job that answers a request of its own with the exchange's query; when it returns true, it is on disk. 503 when all
 * ESK_JOBS_MOST are still to run. */
bool esk_jobs_add(esk_jobs *jobs, eskel_exchange *exchange, const char *method, const char *path, esk_job *job);

/* Writes at most ESK_JOBS_MOST, oldest first; how many. */
size_t esk_jobs_list(esk_jobs *jobs, esk_job list[ESK_JOBS_MOST]);
/* False when there is no such job. */
bool esk_jobs_find(esk_jobs *jobs, const char *id, esk_job *job);
/* Cancels it if it is still to end, and forgets it; 404 when there is no such job. */
bool esk_jobs_remove(esk_jobs *jobs, const char *id, esk_problem *problem);
/* A descriptor of a done job's answer, to be closed. It is verified when it is asked for the first time since the start; one
 * that is damaged or gone is 409, and the job queued again. */
bool esk_jobs_result(esk_jobs *jobs, const char *id, int *descriptor, esk_problem *problem);

/* Who watches a job for long; 503 when there are ESK_JOB_WATCHERS_MOST. */
bool esk_jobs_watch(esk_jobs *jobs, esk_problem *problem);
void esk_jobs_unwatch(esk_jobs *jobs);

#endif
