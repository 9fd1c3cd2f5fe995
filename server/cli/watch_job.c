/* A bar from the events of a job, see watch_job.h. */
#include "watch_job.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	esk_progress *progress;
	eskel_report_job job; /* as the last event told it */
	bool told;            /* anything, by the stream at hand */
} watcher;

static void take_line(void *context, const char *line)
{
	static const char data[] = "data: ";
	const size_t size = strlen(data);
	watcher *w = context;
	if (strncmp(line, data, size))
		return;
	w->told = true;
	if (eskel_report_job_read(line + size, strlen(line + size), &w->job))
		esk_progress_worked(w->progress, w->job.progress, w->job.seconds);
}

/* A stream may end before its job; one of a job that is gone is refused. Each begins with the job's state, or that
 * it is gone, so one that tells nothing is none of eskeld's. */
esk_outcome esk_watch_job(esk_session *session, const char *path, const char *source, eskel_report_job *job)
{
	watcher w = {.progress = &session->progress};
	esk_outcome outcome = ESK_DONE;
	char *events = NULL;
	if (asprintf(&events, "%s/events", path) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	const esk_request request = {.path = events, .query = ""};
	while (!outcome && !w.job.ended) {
		w.told = false;
		outcome = esk_session_listen(session, &request, source, take_line, &w);
		if (!outcome && !w.told)
			outcome = esk_complain(ESK_UNREACHABLE, "%s: the answer is not one of eskeld's", source);
	}
	*job = w.job;
	free(events);
	return outcome;
}
