/* POST /distances, /jobs, /jobs/{id} and /jobs/{id}/result. */
#include "file_body.h"
#include "job_json.h"
#include "resources.h"

#include <math.h>

bool esk_distances_post(eskel_exchange *exchange)
{
	esk_job job;
	return esk_jobs_add(exchange->api->jobs, exchange, "GET", "/distances", &job) &&
	       esk_exchange_add_header(exchange, "Location", "/jobs/%s", job.id) &&
	       esk_exchange_answer_json(exchange, 202, esk_job_json(&job));
}

bool esk_jobs_get(eskel_exchange *exchange)
{
	esk_job list[ESK_JOBS_MOST];
	const size_t count = esk_jobs_list(exchange->api->jobs, list);
	json_t *array = json_array();
	for (size_t i = 0; i < count; i++)
		if (json_array_append_new(array, esk_job_json(&list[i])) != 0) {
			json_decref(array);
			return esk_problem_no_memory(&exchange->problem);
		}
	return esk_exchange_answer_json(exchange, 200, json_pack("{s:o}", "jobs", array));
}

static bool find(eskel_exchange *exchange, esk_job *job)
{
	return esk_jobs_find(exchange->api->jobs, exchange->id, job) ||
	       esk_problem_no_job(&exchange->problem, exchange->id);
}

bool esk_job_get(eskel_exchange *exchange)
{
	esk_job job;
	return find(exchange, &job) && esk_exchange_answer_json(exchange, 200, esk_job_json(&job));
}

bool esk_job_delete(eskel_exchange *exchange)
{
	return esk_jobs_remove(exchange->api->jobs, exchange->id, &exchange->problem) &&
	       esk_exchange_answer_nothing(exchange, 204);
}

static bool check_done(eskel_exchange *exchange, const esk_job *job)
{
	if (job->state == ESK_JOB_FAILED)
		return esk_problem_set(&exchange->problem, job->status, "%s", job->problem);
	return job->state == ESK_JOB_DONE ||
	       esk_problem_set(&exchange->problem, 409,
		       "the job is %.0f %% done, expected a job that is done: ask for its state until then",
		       floor(100 * job->progress));
}

bool esk_job_get_result(eskel_exchange *exchange)
{
	esk_job job;
	int descriptor;
	return find(exchange, &job) && check_done(exchange, &job) &&
	       esk_jobs_result(exchange->api->jobs, job.id, &descriptor, &exchange->problem) &&
	       esk_exchange_answer_file(exchange, 200, job.content_type, descriptor, 0, job.size);
}
