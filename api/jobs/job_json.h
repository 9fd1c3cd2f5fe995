/* A job as JSON. */
#ifndef ESK_JOB_JSON_H
#define ESK_JOB_JSON_H

#include "job.h"

json_t *esk_job_json(const esk_job *job);

#endif
