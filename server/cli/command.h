/* The commands of eskel, one a file (those of jobs together). */
#ifndef ESK_COMMAND_H
#define ESK_COMMAND_H

#include "session.h"

esk_outcome esk_command_enroll(esk_session *session);
esk_outcome esk_command_recognize(esk_session *session);
esk_outcome esk_command_check(esk_session *session);
esk_outcome esk_command_distances(esk_session *session);
esk_outcome esk_command_evaluate(esk_session *session);
esk_outcome esk_command_jobs(esk_session *session);
esk_outcome esk_command_job(esk_session *session);
esk_outcome esk_command_mesh(esk_session *session);
esk_outcome esk_command_reconstruct(esk_session *session);
esk_outcome esk_command_show(esk_session *session);
esk_outcome esk_command_export(esk_session *session);
esk_outcome esk_command_import(esk_session *session);
esk_outcome esk_command_skeleton(esk_session *session);

#endif
