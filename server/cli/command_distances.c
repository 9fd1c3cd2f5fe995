/* eskel distances: the matrix of the shapes named by their ids, or of those that the filters let through. */
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

/* CSV is for other programs: it passes through. */
static esk_outcome pass_csv(esk_session *session, const esk_request *request)
{
	esk_answer answer = {0};
	esk_outcome outcome = esk_session_send(session, request, "distances", &answer);
	if (!outcome)
		fwrite(answer.body, 1, answer.size, stdout);
	free(answer.body);
	return outcome;
}

esk_outcome esk_command_distances(esk_session *session)
{
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_DISTANCES);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (outcome)
		return outcome;
	session->progress.items = 1;
	char *ids = ids_of(session->arguments), *query = ids ? esk_session_query(session, ids) : NULL;
	const esk_request request = {"/distances", query, NULL};
	if (!query)
		outcome = ESK_REFUSED;
	else if (esk_arguments_value(session->arguments, "csv"))
		outcome = pass_csv(session, &request);
	else
		outcome = esk_session_ask(session, &request, "distances");
	free(query);
	free(ids);
	return outcome;
}
