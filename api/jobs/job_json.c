/* A job as JSON, see job_json.h. */
#include "job_json.h"

#include <math.h>

json_t *esk_job_json(const esk_job *job)
{
	static const char *const states[] = {"queued", "running", "done", "failed"};
	const bool done = job->state == ESK_JOB_DONE;
	char url[64], result[80];
	snprintf(url, sizeof url, "/jobs/%s", job->id);
	snprintf(result, sizeof result, "%s/result", url);
	return json_pack("{s:s, s:s, s:s, s:s, s:s, s:f, s:o, s:I, s:s?, s:s?, s:s?}", "id", job->id, "url", url,
		"created", job->created, "path", job->path, "state", states[job->state], "progress", job->progress,
		"seconds", esk_json_real(round(1e3 * job->seconds) / 1e3), "size", (json_int_t)job->size,
		"content_type", done ? job->content_type : NULL, "result", done ? result : NULL, "problem",
		job->problem[0] ? job->problem : NULL);
}
