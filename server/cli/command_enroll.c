/* eskel enroll: posts volumes, with what is known of their labels; or whole folders of them. */
#include "command.h"
#include "enroll_folders.h"
#include "post_volume.h"
#include "walk.h"

static esk_outcome enroll_all(esk_session *session, const esk_label_names *table)
{
	const esk_arguments *arguments = session->arguments;
	esk_outcome worst = ESK_DONE;
	for (size_t i = 0; i < arguments->operand_count && worst != ESK_UNREACHABLE; i++)
		worst = esk_outcome_worse(worst, esk_post_volume(session, "/shapes", arguments->operands[i], table));
	return worst;
}

static bool wants_folders(const esk_arguments *arguments)
{
	bool wants = esk_arguments_value(arguments, "manifest") || esk_arguments_value(arguments, "parallel") ||
		     esk_arguments_value(arguments, "refused");
	for (size_t i = 0; i < arguments->operand_count; i++)
		wants |= esk_walk_is_folder(arguments->operands[i]);
	return wants;
}

esk_outcome esk_command_enroll(esk_session *session)
{
	esk_label_names table = {0};
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_SHAPES);
	if (!outcome && wants_folders(session->arguments))
		return esk_enroll_folders(session);
	if (!outcome)
		outcome = esk_post_read_labels(session, &table);
	if (!outcome)
		outcome = esk_session_connect(session);
	if (!outcome)
		outcome = enroll_all(session, &table);
	esk_label_names_clear(&table);
	return outcome;
}
