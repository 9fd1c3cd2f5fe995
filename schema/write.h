/* Write transactions, many changes to a commit.
 *
 * A commit waits for the disk; whoever comes meanwhile queues up, and the first of them takes all that wait into the
 * next transaction, each change in a savepoint of its own. So a change that is refused leaves nothing, the others stay,
 * and eight clients cost about one fsync. */
#ifndef ESK_WRITE_H
#define ESK_WRITE_H

#include "store.h"

/* Changes the database through the writer, or returns why not and fills error. */
typedef eskel_store_status (*esk_change)(sqlite3 *writer, void *context, eskel_store_error *error);

/* Told, by one thread at a time and in the order of commits, that a change is on disk. */
typedef void (*esk_committed)(eskel_store *store, void *context);

/* Runs the change and returns when it is on disk. After a failure nothing of it is there, except that a commit which
 * failed for the disk (IO) may have landed: the store is then read-only, and the change must be harmless to repeat. */
eskel_store_status esk_write(eskel_store *store, esk_change change, void *context, eskel_store_error *error);

/* The same for a change of shapes: LOCKED beside a server, which would not learn of it. committed is called, with the
 * same context, when there is a catalogue to be kept. */
eskel_store_status esk_write_shapes(
	eskel_store *store, esk_change change, esk_committed committed, void *context, eskel_store_error *error);

/* READ_ONLY after a write that could not be made durable. */
eskel_store_status esk_write_allowed(eskel_store *store, eskel_store_error *error);

/* Takes over the checkpoints of the writer, once, before the first write. */
void esk_write_prepare(eskel_store *store);

#endif
