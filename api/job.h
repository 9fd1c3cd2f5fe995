/* Long answers that nobody has to wait for: a job is a request that is answered into a file, in a thread of its own.
 *
 * Jobs run one after the other, oldest first, for each uses all processors. What they have answered is in temporary
 * files without a name, which go with the process: a restart forgets all jobs. When there are ESK_JOBS_MOST, a new one
 * takes the place of the one that ended first. */
#ifndef ESK_JOB_H
#define ESK_JOB_H

#include "exchange.h"

#define ESK_JOBS_MOST 16

typedef enum { ESK_JOB_QUEUED, ESK_JOB_RUNNING, ESK_JOB_DONE, ESK_JOB_FAILED } esk_job_state;

/* A copy of what there is to say of one. */
typedef struct {
	char id[ESKEL_ID_SIZE];
	esk_job_state state;
	double progress;          /* share that is done, 0 to 1 */
	double seconds;           /* since it began to run, or that it ran */
	uint64_t size;            /* bytes of the answer; those so far while it runs */
	int status;               /* of the answer; 0 before */
	const char *content_type; /* of the answer, static; NULL before */
	char problem[640];        /* why it failed, "" unless it did */
} esk_job;

typedef struct esk_jobs esk_jobs;

/* NULL when memory ran out. */
esk_jobs *esk_jobs_new(eskel_api *api);
/* Cancels all and waits for the one that runs to notice. */
void esk_jobs_free(esk_jobs *jobs);

/* A job that answers GET path with the exchange's query and headers. 503 when all ESK_JOBS_MOST are still to run. */
bool esk_jobs_add(esk_jobs *jobs, eskel_exchange *exchange, const char *path, esk_job *job);

/* Writes at most ESK_JOBS_MOST, oldest first; how many. */
size_t esk_jobs_list(esk_jobs *jobs, esk_job list[ESK_JOBS_MOST]);
/* False when there is no such job. */
bool esk_jobs_find(esk_jobs *jobs, const char *id, esk_job *job);
/* Cancels it if it is still to end, and forgets it. */
bool esk_jobs_remove(esk_jobs *jobs, const char *id);
/* The file of a job that is done, to be closed; -1 when there is none or memory or files ran out. */
int esk_jobs_open(esk_jobs *jobs, const char *id);

#endif
