/* eskel check: each operand is a label map; what is wrong with its labels. */
#include "command.h"
#include "post_volume.h"

/* Exit code 1 is for findings, so that a pipeline can tell a bad map from one that was not checked. */
static esk_outcome refusal(esk_outcome outcome)
{
	return outcome == ESK_REFUSED ? ESK_MISUSED : outcome;
}

static esk_outcome check_all(esk_session *session, const esk_label_names *table)
{
	const esk_arguments *arguments = session->arguments;
	esk_outcome worst = ESK_DONE;
	for (size_t i = 0; i < arguments->operand_count && worst != ESK_UNREACHABLE; i++)
		worst = esk_outcome_worse(
			worst, refusal(esk_post_volume(session, "/check", arguments->operands[i], table)));
	if (eskel_report_findings(session->report) > 0)
		worst = esk_outcome_worse(worst, ESK_REFUSED);
	return worst;
}

esk_outcome esk_command_check(esk_session *session)
{
	esk_label_names table = {0};
	esk_outcome outcome = refusal(esk_session_open(session, ESKEL_REPORT_CHECK));
	if (!outcome)
		outcome = refusal(esk_post_read_labels(session, &table));
	if (!outcome)
		outcome = refusal(esk_session_connect(session));
	if (!outcome)
		outcome = check_all(session, &table);
	esk_label_names_clear(&table);
	return outcome;
}
