/* eskel recognize: each operand is a volume to post, or the id of a stored shape. */
#include "command.h"
#include "post_volume.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* 32 hexadecimal digits, and no file is called so. */
static bool is_id(const char *operand)
{
	return strlen(operand) == 32 && strspn(operand, "0123456789abcdef") == 32 && access(operand, F_OK);
}

static esk_outcome recognize_stored(esk_session *session, const char *id)
{
	char shape[64];
	snprintf(shape, sizeof shape, "&shape=%s", id);
	char *query = esk_session_query(session, shape);
	const esk_request request = {.path = "/recognize", .query = query};
	esk_outcome outcome = query ? esk_session_ask(session, &request, id) : ESK_REFUSED;
	free(query);
	return outcome;
}

static esk_outcome recognize_all(esk_session *session, const esk_label_names *table)
{
	const esk_arguments *arguments = session->arguments;
	esk_outcome worst = ESK_DONE;
	for (size_t i = 0; i < arguments->operand_count && worst != ESK_UNREACHABLE; i++) {
		const char *operand = arguments->operands[i];
		esk_outcome outcome = is_id(operand) ? recognize_stored(session, operand)
						     : esk_post_volume(session, "/recognize", operand, table);
		worst = esk_outcome_worse(worst, outcome);
	}
	if (eskel_report_unrecognized(session->report) > 0)
		worst = esk_outcome_worse(worst, ESK_REFUSED);
	return worst;
}

esk_outcome esk_command_recognize(esk_session *session)
{
	esk_label_names table = {0};
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_RECOGNITION);
	if (!outcome)
		outcome = esk_post_read_labels(session, &table);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (!outcome)
		outcome = recognize_all(session, &table);
	esk_label_names_clear(&table);
	return outcome;
}
