/* eskel show: one shape by its id, or a list of those that the filters let through. */
#include "command.h"

#include <stdlib.h>

static esk_outcome show_one(esk_session *session, const char *id)
{
	char *path = esk_session_path("/shapes/", id);
	if (!path)
		return ESK_REFUSED;
	const esk_request request = {.path = path, .query = ""};
	esk_outcome outcome = esk_session_ask(session, &request, id);
	free(path);
	return outcome;
}

static esk_outcome show_list(esk_session *session)
{
	char *query = esk_session_query(session, "");
	if (!query)
		return ESK_REFUSED;
	const esk_request request = {.path = "/shapes", .query = query};
	esk_outcome outcome = esk_session_ask(session, &request, "shapes");
	free(query);
	return outcome;
}

esk_outcome esk_command_show(esk_session *session)
{
	const esk_arguments *arguments = session->arguments;
	bool one = arguments->operand_count == 1;
	esk_outcome outcome = esk_session_open(session, one ? ESKEL_REPORT_SHAPE : ESKEL_REPORT_SHAPES);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (outcome)
		return outcome;
	return one ? show_one(session, arguments->operands[0]) : show_list(session);
}
