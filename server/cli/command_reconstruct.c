/* eskel reconstruct: fits a surface to a stored shape. The server does it as a job, whose end is waited for with a bar; who
 * interrupts that leaves the job alone. */
#include "command.h"
#include "watch_job.h"

#include <stdlib.h>

static esk_outcome begin(esk_session *session, const char *shape, const char *id, char **job)
{
	esk_outcome outcome = ESK_REFUSED;
	esk_answer answer = {0};
	char *path = NULL, *query = esk_session_query(session, "");
	if (query && asprintf(&path, "%s/reconstruction", shape) >= 0) {
		const esk_request request = {.path = path, .query = query, .method = "POST"};
		outcome = esk_session_send(session, &request, id, &answer);
		free(path);
	}
	free(query);
	if (!outcome && !(*job = eskel_report_url(answer.body, answer.size)))
		outcome = esk_complain(ESK_UNREACHABLE, "%s: the answer is not one of eskeld's", id);
	free(answer.body);
	return outcome;
}

static esk_outcome show_result(esk_session *session, const char *job, const char *id)
{
	char *path = NULL;
	if (asprintf(&path, "%s/result", job) < 0)
		return esk_complain(ESK_REFUSED, "memory ran out");
	const esk_request request = {.path = path, .query = ""};
	esk_outcome outcome = esk_session_ask(session, &request, id);
	free(path);
	return outcome;
}

esk_outcome esk_command_reconstruct(esk_session *session)
{
	const char *id = session->arguments->operands[0];
	char *job = NULL;
	eskel_report_job ended = {0};
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_RECONSTRUCTION);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (outcome)
		return outcome;
	char *shape = esk_session_path("/shapes/", id);
	outcome = shape ? begin(session, shape, id, &job) : ESK_REFUSED;
	if (!outcome)
		outcome = esk_watch_job(session, job, id, &ended);
	if (!outcome) /* of a job that failed the result is the refusal */
		outcome = show_result(session, job, id);
	free(job);
	free(shape);
	return outcome;
}
