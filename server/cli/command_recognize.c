/* eskel recognize: each operand is a volume to post, or the id of a stored shape. */
#include "command.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* 32 hexadecimal digits, and no file is called so. */
static bool is_id(const char *operand)
{
	return strlen(operand) == 32 && strspn(operand, "0123456789abcdef") == 32 && access(operand, F_OK);
}

static esk_outcome recognize(esk_session *session, const char *operand)
{
	char shape[64] = "";
	bool id = is_id(operand);
	if (id)
		snprintf(shape, sizeof shape, "&shape=%s", operand);
	char *query = esk_session_query(session, shape);
	if (!query)
		return ESK_REFUSED;
	const esk_request request = {"/recognize", query, id ? NULL : operand};
	esk_outcome outcome = esk_session_ask(session, &request, operand);
	free(query);
	return outcome;
}

esk_outcome esk_command_recognize(esk_session *session)
{
	const esk_arguments *arguments = session->arguments;
	esk_outcome worst = esk_session_open(session, ESKEL_REPORT_RECOGNITION);
	if (!worst)
		worst = esk_session_connect(session);
	if (worst)
		return worst;
	for (size_t i = 0; i < arguments->operand_count && worst != ESK_UNREACHABLE; i++)
		worst = esk_outcome_worse(worst, recognize(session, arguments->operands[i]));
	if (eskel_report_unrecognized(session->report) > 0)
		worst = esk_outcome_worse(worst, ESK_REFUSED);
	return worst;
}
