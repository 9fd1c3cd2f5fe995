/* Skeletons of many clouds at once: threads take clouds, the largest first, so that none is left with a large one while
 * the others have ended. */
#include "error.h"
#include "memory.h"
#include "team.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
	size_t index, runs;
	uint32_t levels; /* so far */
} entry;

typedef struct {
	const eskel_cloud *const *clouds;
	size_t count;
	const eskel_skeleton_options *asked;
	eskel_skeleton_options each; /* of one cloud */
	entry *entries;
	eskel_skeleton **made;
	pthread_mutex_t lock; /* of what follows, and of entries[].levels */
	uint64_t levels_done;
	bool cancelled;
	size_t failed; /* the first cloud that did, or count */
	eskel_error error;
} work;

/* What the progress of one cloud is told. */
typedef struct {
	work *work;
	entry *entry;
} item;

/* The largest first, of equal ones the one of lower index. */
static int compare_entries(const void *a, const void *b)
{
	const entry *p = a, *q = b;
	return p->runs != q->runs ? (p->runs < q->runs) - (p->runs > q->runs)
				  : (p->index > q->index) - (p->index < q->index);
}

/* Under the lock. Nobody will see what comes after a cancellation, or behind a cloud that failed. */
static bool is_wanted(const work *w, const entry *e)
{
	return !w->cancelled && e->index < w->failed;
}

static bool report(void *context, uint32_t level, uint32_t levels)
{
	const item *i = context;
	work *w = i->work;
	pthread_mutex_lock(&w->lock);
	w->levels_done += level - i->entry->levels;
	i->entry->levels = level;
	if (w->asked->progress && !w->cancelled)
		w->cancelled =
			!w->asked->progress(w->asked->context, (uint32_t)w->levels_done, (uint32_t)(w->count * levels));
	const bool wanted = is_wanted(w, i->entry);
	pthread_mutex_unlock(&w->lock);
	return wanted;
}

static void make_one(void *context, size_t place)
{
	work *w = context;
	entry *e = &w->entries[place];
	item i = {w, e};
	eskel_skeleton_options options = w->each;
	eskel_error error = {0};
	options.progress = report;
	options.context = &i;
	pthread_mutex_lock(&w->lock);
	const bool wanted = is_wanted(w, e);
	pthread_mutex_unlock(&w->lock);
	if (!wanted)
		return;
	const eskel_status status = eskel_skeleton_new(w->clouds[e->index], &options, &w->made[e->index], &error);
	pthread_mutex_lock(&w->lock);
	if (status && is_wanted(w, e)) {
		w->failed = e->index;
		w->error = error;
	}
	if (!status) { /* perhaps with fewer levels than were asked for */
		w->levels_done += options.levels - e->levels;
		e->levels = options.levels;
	}
	pthread_mutex_unlock(&w->lock);
}

/* Threads that are more than clouds help within each. */
static void make_all(work *w)
{
	const uint32_t threads = esk_team_threads(w->asked->threads);
	const uint32_t together = w->count < threads ? (uint32_t)w->count : threads;
	w->each.threads = together > 0 ? threads / together : 1;
	esk_team *team = esk_team_new(together);
	esk_team_run(team, w->count, make_one, w);
	esk_team_free(team);
}

static eskel_status outcome(const work *w, eskel_error *error)
{
	if (w->cancelled)
		return esk_error_set(
			error, ESKEL_CANCELLED, "no skeletons were made: %s", eskel_status_text(ESKEL_CANCELLED));
	if (w->failed < w->count && error)
		*error = w->error;
	return w->failed < w->count ? w->error.status : ESKEL_OK;
}

eskel_status eskel_skeletons_new(const eskel_cloud *const *clouds, size_t count, const eskel_skeleton_options *options,
	eskel_skeleton **skeletons, eskel_error *error)
{
	const eskel_skeleton_options asked = options ? *options : (eskel_skeleton_options){0};
	work w = {.clouds = clouds, .count = count, .asked = &asked, .each = asked, .failed = count};
	if (!w.each.levels)
		w.each.levels = ESKEL_LEVELS_DEFAULT;
	w.entries = esk_memory_array(count, sizeof *w.entries);
	w.made = esk_memory_zeroed_array(count, sizeof *w.made);
	eskel_status status = ESKEL_OK;
	if (!w.entries || !w.made) {
		status = esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out before %zu skeletons", count);
		goto end;
	}
	for (size_t i = 0; i < count; i++)
		w.entries[i] = (entry){i, clouds[i]->run_count, 0};
	qsort(w.entries, count, sizeof *w.entries, compare_entries);
	pthread_mutex_init(&w.lock, NULL);
	make_all(&w);
	pthread_mutex_destroy(&w.lock);
	status = outcome(&w, error);
	for (size_t i = 0; i < count; i++)
		if (status)
			eskel_skeleton_free(w.made[i]);
		else
			skeletons[i] = w.made[i];
end:
	free(w.entries);
	free(w.made);
	return status;
}
