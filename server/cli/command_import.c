/* eskel import: what eskel export wrote, into this server. */
#include "command.h"
#include "enroll_folders.h"

esk_outcome esk_command_import(esk_session *session)
{
	esk_outcome outcome = esk_session_open(session, ESKEL_REPORT_SHAPES);
	return outcome ? outcome : esk_enroll_exported(session, session->arguments->operands[0]);
}
