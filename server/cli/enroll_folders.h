/* Enrolls all files of folders: the common part of eskel enroll and eskel import. */
#ifndef ESK_ENROLL_FOLDERS_H
#define ESK_ENROLL_FOLDERS_H

#include "session.h"

/* The operands are folders and files; --manifest, or a folder's own manifest.csv, says which files and what they are. */
esk_outcome esk_enroll_folders(esk_session *session);

/* The folder's shapes.csv is the manifest, every word of it is posted as it stands, and the answers must say the same. */
esk_outcome esk_enroll_exported(esk_session *session, const char *folder);

#endif
