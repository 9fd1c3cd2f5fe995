/* Waiting for a job with a progress bar. */
#ifndef ESK_WATCH_JOB_H
#define ESK_WATCH_JOB_H

#include "session.h"

/* Follows the events of the job at path, which people call source, to its end. */
esk_outcome esk_watch_job(esk_session *session, const char *path, const char *source, eskel_report_job *job);

#endif
