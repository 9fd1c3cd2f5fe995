/* The volumes in a folder and the folders in it, in the order of their names, byte by byte. */
#ifndef ESK_WALK_H
#define ESK_WALK_H

#include "postings.h"

#include <stdbool.h>

bool esk_walk_is_folder(const char *path);

/* Adds every file that is a volume, or is called like one, with a copy of the query. What is hidden (".git") is left out,
 * and so are symbolic links to folders and to files outside of this one. */
esk_outcome esk_walk_folder(const char *folder, const char *query, esk_postings *postings);

#endif
