/* eskel jobs: a row a job. eskel job: waits for one to end, with a bar from the server's events. Who interrupts that leaves
 * the job alone, for jobs are what nobody has to wait for; --cancel is what ends one. */
#include "command.h"
#include "watch_job.h"

#include <stdlib.h>

esk_outcome esk_command_jobs(esk_session *session)
{
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_JOBS);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (outcome)
		return outcome;
	const esk_request request = {.path = "/jobs", .query = ""};
	return esk_session_ask(session, &request, "jobs");
}

static esk_outcome cancel(esk_session *session, const char *path, const char *id)
{
	const esk_request request = {.path = path, .query = "", .method = "DELETE"};
	esk_answer answer = {0};
	esk_outcome outcome = esk_session_send(session, &request, id, &answer);
	free(answer.body);
	return outcome;
}

static esk_outcome download(esk_session *session, const char *path, const char *id, const char *output)
{
	char *result = NULL;
	if (asprintf(&result, "%s/result", path) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	const esk_request request = {.path = result, .query = ""};
	esk_outcome outcome = esk_session_download(session, &request, id, output);
	free(result);
	return outcome;
}

static esk_outcome wait_for(esk_session *session, const char *path, const char *id)
{
	eskel_report_job job = {0};
	const char *output = esk_arguments_value(session->arguments, "output");
	esk_outcome outcome = esk_watch_job(session, path, id, &job);
	if (!outcome && job.failed) /* its result is the refusal */
		return download(session, path, id, NULL);
	if (!outcome && output)
		return download(session, path, id, output);
	const esk_request request = {.path = path, .query = ""};
	return outcome ? outcome : esk_session_ask(session, &request, id);
}

esk_outcome esk_command_job(esk_session *session)
{
	const char *id = session->arguments->operands[0];
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_JOB);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (outcome)
		return outcome;
	char *path = esk_session_path("/jobs/", id);
	if (!path)
		return ESK_REFUSED;
	if (esk_arguments_value(session->arguments, "cancel"))
		outcome = cancel(session, path, id);
	else
		outcome = wait_for(session, path, id);
	free(path);
	return outcome;
}
