/* eskel distances: the matrix of the shapes named by their ids, or of those that the filters let through. A format that is
 * asked for is for other programs, or for the eye: it passes through. */
#include "command.h"

#include <stdlib.h>

static char *ids_of(const esk_arguments *arguments)
{
	char *ids = NULL;
	size_t size;
	FILE *out = open_memstream(&ids, &size);
	for (size_t i = 0; i < arguments->operand_count && out; i++) {
		fputs(i > 0 ? "," : "&id=", out);
		esk_arguments_write_escaped(arguments->operands[i], out);
	}
	return esk_session_close_text(out, &ids);
}

esk_outcome esk_command_distances(esk_session *session)
{
	const bool job = esk_arguments_value(session->arguments, "job");
	esk_outcome outcome = esk_session_open(session, job ? ESKEL_REPORT_JOB : ESKEL_REPORT_DISTANCES);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (outcome)
		return outcome;
	session->progress.items = 1;
	const char *output = esk_arguments_value(session->arguments, "output");
	char *ids = ids_of(session->arguments), *query = ids ? esk_session_query(session, ids) : NULL;
	const esk_request request = {.path = "/distances", .query = query, .method = job ? "POST" : NULL};
	if (!query)
		outcome = ESK_REFUSED;
	else if (!job && (esk_arguments_value(session->arguments, "format") || output))
		outcome = esk_session_download(session, &request, "distances", output);
	else
		outcome = esk_session_ask(session, &request, "distances");
	free(query);
	free(ids);
	return outcome;
}
