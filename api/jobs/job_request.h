/* The request that a job answers, as the text that is stored. */
#ifndef ESK_JOB_REQUEST_H
#define ESK_JOB_REQUEST_H

#include "exchange.h"

/* Of a method and a path with the exchange's query. free() it; NULL when memory ran out. */
char *esk_job_request_text(const eskel_exchange *exchange, const char *method, const char *path);

/* Its path, "" when the text is none of ours. */
#define ESK_JOB_PATH_SIZE 80
void esk_job_request_path(const char *text, char path[ESK_JOB_PATH_SIZE]);

/* The exchange of the request; what has become of it by now (its refusal, perhaps) is its response. NULL when memory ran
 * out or the text is none of ours.
 *
 * It may do what its route asks for and no more, whoever asked: who did was let do so when the job was accepted, and nobody's
 * token has to be kept for a restart. */
eskel_exchange *esk_job_request_begin(eskel_api *api, const char *text);

#endif
