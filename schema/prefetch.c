#include "prefetch.h"

#include "read.h"
#include "statement.h"

#include <time.h>

/* Rows that a thread takes at a time, and rows that are read ahead at most: some 200 MB of pages. */
static const int64_t stride = 256, window = 65536;

static void touch(sqlite3 *db, int64_t first)
{
	esk_statement s = esk_statement_begin(db, "SELECT count(*) FROM signature WHERE shape >= ? AND shape < ?");
	esk_bind_int64(&s, first);
	esk_bind_int64(&s, first + stride);
	esk_statement_run(&s, NULL);
}

static void *read_ahead(void *context)
{
	const struct timespec pause = {.tv_nsec = 1000000};
	esk_prefetch *p = context;
	sqlite3 *db = NULL;
	if (esk_read_begin(p->store, &db, NULL) != ESKEL_STORE_OK)
		return NULL;
	int64_t first;
	while (!atomic_load(&p->stop) && (first = atomic_fetch_add(&p->next, stride)) <= p->last) {
		while (first > atomic_load(&p->scanned) + window && !atomic_load(&p->stop))
			nanosleep(&pause, NULL);
		touch(db, first);
	}
	esk_read_end(p->store, db);
	return NULL;
}

void esk_prefetch_start(esk_prefetch *prefetch, eskel_store *store, int64_t last)
{
	*prefetch = (esk_prefetch){.store = store, .last = last};
	if (last < ESK_PREFETCH_THREADS * stride)
		return;
	for (int i = 0; i < ESK_PREFETCH_THREADS; i++) {
		if (pthread_create(&prefetch->threads[i], NULL, read_ahead, prefetch) != 0)
			break;
		prefetch->thread_count++;
	}
}

void esk_prefetch_pass(esk_prefetch *prefetch, int64_t key)
{
	atomic_store_explicit(&prefetch->scanned, key, memory_order_relaxed);
}

void esk_prefetch_stop(esk_prefetch *prefetch)
{
	atomic_store(&prefetch->stop, true);
	for (int i = 0; i < prefetch->thread_count; i++)
		pthread_join(prefetch->threads[i], NULL);
}
