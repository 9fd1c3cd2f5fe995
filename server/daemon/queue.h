/* Work that does not belong into a network thread: a bounded queue and the threads that empty it.
 *
 * A place is taken when a request's head is accepted, before its body, and kept while the body arrives, waits and is
 * worked on. So a full queue refuses at once instead of after an upload of a gigabyte, what was accepted is always
 * finished, and the places bound the memory of uploads too.
 */
#ifndef ESK_QUEUE_H
#define ESK_QUEUE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct esk_queue esk_queue;

/* Embedded in what is to be worked on. */
typedef struct esk_job {
	struct esk_job *next;
} esk_job;

/* work runs in one of the threads, once for each submitted job, in the order of submission. NULL when threads or
 * memory ran out. */
esk_queue *esk_queue_start(size_t threads, size_t places, void (*work)(esk_job *job));
/* Finishes what was submitted, then ends the threads. NULL is fine. */
void esk_queue_stop(esk_queue *queue);

bool esk_queue_take_place(esk_queue *queue);
void esk_queue_leave_place(esk_queue *queue);
/* The caller holds a place, so there is always room. */
void esk_queue_submit(esk_queue *queue, esk_job *job);

typedef struct {
	size_t taken, waiting, working;
} esk_queue_state;

esk_queue_state esk_queue_look(esk_queue *queue);

#endif
