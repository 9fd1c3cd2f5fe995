/* Progress of long work on standard error: a bar on a terminal, otherwise a line for each of
 * several items when it is done. */
#ifndef ESK_PROGRESS_H
#define ESK_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

typedef struct {
	bool quiet, terminal;
	size_t item, items;             /* 1-based, not past: how many there are */
	const char *name;               /* of the item */
	struct timespec started, drawn; /* the item; the bar */
} esk_progress;

void esk_progress_begin(esk_progress *progress, bool quiet, size_t items);

/* The next item. Borrows its name until esk_progress_end. */
void esk_progress_next(esk_progress *progress, const char *name);

/* Part of the item is sent; once all is (sent == total), the other side computes. 0 of 0 while
 * nothing is known. Cheap to call often. */
void esk_progress_sent(esk_progress *progress, uint64_t sent, uint64_t total);

/* So many rows of the item's answer came. */
void esk_progress_received(esk_progress *progress, uint64_t rows, uint64_t total);

/* So many of the item's steps are computed here. */
void esk_progress_computed(esk_progress *progress, uint32_t steps, uint32_t total);

/* So many of the items are done, which took the given share of the work. Away from a terminal a line every 10 seconds. */
void esk_progress_counted(esk_progress *progress, size_t done, double share);

/* The share of the item that the server has done, and for how long it works on it. */
void esk_progress_worked(esk_progress *progress, double share, double seconds);

/* The item has ended, done or given up: what is printed next starts on a clean line. */
void esk_progress_end(esk_progress *progress, bool done);

#endif
