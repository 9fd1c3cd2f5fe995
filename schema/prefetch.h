/* Reading ahead of a scan of all signatures.
 *
 * Shapes are stored one after the other, so the pages of the signatures lie scattered among those of clouds and
 * skeletons, and a scan of a file that is not in memory waits for the disk at each of them. A few threads that touch
 * the rows ahead of the scan keep the disk busy with many pages at a time: at 100,000 shapes a cold scan took 0.7 s
 * instead of 2.4 s. They only fill caches. What goes wrong in them is left for the scan to find. */
#ifndef ESK_PREFETCH_H
#define ESK_PREFETCH_H

#include "store.h"

enum { ESK_PREFETCH_THREADS = 8 };

typedef struct {
	eskel_store *store;
	atomic_int_fast64_t next;    /* the first key that no thread has taken */
	atomic_int_fast64_t scanned; /* the last key that the scan has passed */
	int64_t last;                /* the last key that there is */
	atomic_bool stop;
	int thread_count;
	pthread_t threads[ESK_PREFETCH_THREADS];
} esk_prefetch;

/* Starts no thread when last is so small that the scan is done before they would be. */
void esk_prefetch_start(esk_prefetch *prefetch, eskel_store *store, int64_t last);
void esk_prefetch_pass(esk_prefetch *prefetch, int64_t key);
void esk_prefetch_stop(esk_prefetch *prefetch);

#endif
