/* An open store: one writer connection, a pool of readers, the lock of the file. */
#ifndef ESK_STORE_H
#define ESK_STORE_H

#include "catalogue.h"

#include <pthread.h>
#include <sqlite3.h>
#include <stdatomic.h>

struct esk_write; /* write.c */

struct eskel_store {
	char *path;
	int lock;       /* the locked file's descriptor, -1: none */
	bool is_beside; /* another process has the lock: its shapes are not ours to change */
	uint64_t least_free_bytes;
	atomic_bool read_only; /* set for good when a write could not be made durable */

	pthread_mutex_t writes_mutex;
	pthread_cond_t writes_done;
	struct esk_write *waiting; /* in the order of arrival */
	bool writing;              /* one thread at a time uses the writer */
	sqlite3 *writer;
	int log_pages; /* in the write-ahead log after the last commit */

	esk_catalogue *catalogue; /* NULL: none is kept */

	pthread_mutex_t readers_mutex;
	size_t idle_count;
	sqlite3 **idle; /* readers */
};

#endif
