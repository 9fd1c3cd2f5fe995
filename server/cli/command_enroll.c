/* eskel enroll: posts volumes, with what is known of their labels. */
#include "command.h"
#include "post_volume.h"

static esk_outcome enroll_all(esk_session *session, const esk_label_names *table)
{
	const esk_arguments *arguments = session->arguments;
	esk_outcome worst = ESK_DONE;
	for (size_t i = 0; i < arguments->operand_count && worst != ESK_UNREACHABLE; i++)
		worst = esk_outcome_worse(worst, esk_post_volume(session, "/shapes", arguments->operands[i], table));
	return worst;
}

esk_outcome esk_command_enroll(esk_session *session)
{
	esk_label_names table = {0};
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_SHAPES);
	if (!outcome)
		outcome = esk_post_read_labels(session, &table);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (!outcome)
		outcome = enroll_all(session, &table);
	esk_label_names_clear(&table);
	return outcome;
}
