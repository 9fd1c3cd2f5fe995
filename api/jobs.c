/* POST /distances, /jobs, /jobs/{id} and /jobs/{id}/result. */
#include "job_json.h"
#include "resources.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

bool esk_distances_post(eskel_exchange *exchange)
{
	esk_job job;
	return esk_jobs_add(exchange->api->jobs, exchange, "/distances", &job) &&
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

/* ---- the result */

enum { PIECE = 1 << 16 };

typedef struct {
	esk_job job; /* done */
	int descriptor;
	uint64_t sent;
	char bytes[PIECE];
} reader;

/* An esk_stream's; false when the file has become shorter, too. */
static bool read_piece(void *context, esk_text *piece)
{
	reader *r = context;
	const uint64_t left = r->job.size - r->sent;
	const size_t wanted = left < PIECE ? (size_t)left : PIECE;
	const ssize_t size = wanted > 0 ? pread(r->descriptor, r->bytes, wanted, (off_t)r->sent) : 0;
	if (size < 0 || (size == 0 && wanted > 0))
		return false;
	esk_text_append(piece, r->bytes, (size_t)size);
	r->sent += (uint64_t)size;
	return true;
}

static void free_reader(void *context)
{
	reader *r = context;
	if (r->descriptor >= 0)
		close(r->descriptor);
	free(r);
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
	reader *r = calloc(1, sizeof *r);
	if (!r)
		return esk_problem_no_memory(&exchange->problem);
	r->descriptor = -1;
	if (!find(exchange, &r->job) || !check_done(exchange, &r->job) ||
		!esk_jobs_result(exchange->api->jobs, r->job.id, &r->descriptor, &exchange->problem)) {
		free_reader(r);
		return false;
	}
	const esk_stream stream = {.next = read_piece, .free = free_reader, .source = r};
	return esk_exchange_answer_stream(exchange, 200, r->job.content_type, r->job.size, &stream);
}
