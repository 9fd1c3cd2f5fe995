/* The database's file itself, before and beside SQLite: its name, its lock, its header, the room around it. */
#ifndef ESK_FILE_H
#define ESK_FILE_H

#include "eskel_store.h"

/* "ESKL": offset 68 of the file (https://www.sqlite.org/fileformat.html). */
#define ESK_APPLICATION_ID 0x45534b4c

/* The absolute path without links, free() it; the file is created empty (mode 0600) if there is none. */
eskel_store_status esk_file_resolve(const char *path, char **resolved, eskel_store_error *error);

/* One server a database: an flock on the file PATH-lock beside it, *lock to be closed. Not on the database: closing
 * any descriptor of that would drop SQLite's own POSIX locks in this process. LOCKED when somebody has it. */
eskel_store_status esk_file_lock(const char *path, int *lock, eskel_store_error *error);
void esk_file_unlock_and_remove(const char *path, int *lock);

/* FOREIGN unless the file is empty or begins as a database of ours of at most this version. Writes nothing. */
eskel_store_status esk_file_check(const char *path, int newest_version, eskel_store_error *error);

/* FULL unless the file's disk has this many bytes to give. */
eskel_store_status esk_file_check_room(const char *path, uint64_t bytes, eskel_store_error *error);

#endif
