/* Files of a bounded size together, see cache.h. The sum is kept in memory; which files there are is read from the folder when
 * room has to be made, and then for a tenth more than is needed, so that this is seldom. */
#include "cache.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct esk_cache {
	eskel_folder *folder;
	uint64_t most_bytes;
	pthread_mutex_t lock;
	uint64_t bytes; /* of all files, under the lock */
	pthread_mutex_t turns_lock;
	pthread_cond_t turn_ended;
	esk_cache_turn *turns; /* under way; this and the rest under their lock */
	uint64_t turn_count;   /* that were begun */
};

typedef struct {
	uint64_t size;
	int64_t used;
} file;

typedef struct {
	size_t count;
	file *files;
	bool failed;
} listing;

static bool add_size(void *context, const char *name, uint64_t size, int64_t used)
{
	(void)name;
	(void)used;
	*(uint64_t *)context += size;
	return true;
}

eskel_store_status esk_cache_open(
	eskel_store *store, const char *folder, uint64_t most_bytes, esk_cache **cache, eskel_store_error *error)
{
	esk_cache *made = calloc(1, sizeof *made);
	if (!made)
		return ESKEL_STORE_NO_MEMORY;
	made->most_bytes = most_bytes;
	pthread_mutex_init(&made->lock, NULL);
	pthread_mutex_init(&made->turns_lock, NULL);
	pthread_cond_init(&made->turn_ended, NULL);
	eskel_store_status status = eskel_folder_open(store, folder, &made->folder, error);
	if (status == ESKEL_STORE_OK)
		status = eskel_folder_each(made->folder, add_size, &made->bytes, error);
	if (status == ESKEL_STORE_OK)
		*cache = made;
	else
		esk_cache_close(made);
	return status;
}

void esk_cache_close(esk_cache *cache)
{
	if (!cache)
		return;
	eskel_folder_close(cache->folder);
	pthread_mutex_destroy(&cache->lock);
	pthread_mutex_destroy(&cache->turns_lock);
	pthread_cond_destroy(&cache->turn_ended);
	free(cache);
}

bool esk_cache_find(esk_cache *cache, const char *name, int *descriptor, uint64_t *size)
{
	const eskel_store_status status = eskel_file_open(cache->folder, name, true, descriptor, size, NULL);
	if (status == ESKEL_STORE_CORRUPT)
		eskel_folder_remove(cache->folder, name);
	if (status == ESKEL_STORE_OK)
		eskel_folder_touch(cache->folder, name);
	return status == ESKEL_STORE_OK;
}

typedef struct {
	const char *beginning;
	uint64_t bytes; /* of those that stay */
} drop;

static bool begins_otherwise(void *context, const char *name, uint64_t size, int64_t used)
{
	drop *d = context;
	const bool stays = strncmp(name, d->beginning, strlen(d->beginning)) != 0;
	(void)used;
	d->bytes += stays ? size : 0;
	return stays;
}

void esk_cache_drop(esk_cache *cache, const char *beginning)
{
	drop d = {.beginning = beginning};
	pthread_mutex_lock(&cache->lock);
	if (cache->bytes > 0)
		eskel_folder_each(cache->folder, begins_otherwise, &d, NULL);
	cache->bytes = d.bytes;
	pthread_mutex_unlock(&cache->lock);
}

/* ---- room */

static bool list(void *context, const char *name, uint64_t size, int64_t used)
{
	listing *l = context;
	(void)name;
	file *grown = realloc(l->files, (l->count + 1) * sizeof *grown);
	if (!grown) {
		l->failed = true;
		return true;
	}
	l->files = grown;
	l->files[l->count++] = (file){size, used};
	return true;
}

static int compare_use(const void *a, const void *b)
{
	const int64_t first = ((const file *)a)->used, second = ((const file *)b)->used;
	return (first > second) - (first < second);
}

/* The use up to which files have to go, so that those that stay have at most so many bytes. */
static int64_t find_oldest_use(listing *l, uint64_t bytes)
{
	uint64_t total = 0;
	size_t kept = l->count;
	qsort(l->files, l->count, sizeof *l->files, compare_use);
	while (kept > 0 && total + l->files[kept - 1].size <= bytes)
		total += l->files[--kept].size;
	return kept > 0 ? l->files[kept - 1].used : INT64_MIN;
}

typedef struct {
	int64_t use;
	uint64_t bytes; /* of those that stay */
} sweep;

static bool is_newer(void *context, const char *name, uint64_t size, int64_t used)
{
	sweep *s = context;
	const bool newer = used > s->use;
	(void)name;
	s->bytes += newer ? size : 0;
	return newer;
}

/* Leaves at most so many bytes; under the lock. */
static void make_room(esk_cache *cache, uint64_t bytes)
{
	listing l = {0};
	eskel_folder_each(cache->folder, list, &l, NULL);
	sweep s = {.use = l.failed ? INT64_MAX : find_oldest_use(&l, bytes)};
	eskel_folder_each(cache->folder, is_newer, &s, NULL);
	cache->bytes = s.bytes;
	free(l.files);
}

static bool is_there(const esk_cache *cache, const char *name)
{
	int descriptor;
	uint64_t size;
	if (eskel_file_open(cache->folder, name, false, &descriptor, &size, NULL) != ESKEL_STORE_OK)
		return false;
	close(descriptor);
	return true;
}

static bool write_file(const esk_cache *cache, const char *name, const void *bytes, size_t size)
{
	eskel_file *written = NULL;
	if (eskel_file_create(cache->folder, name, &written, NULL) != ESKEL_STORE_OK)
		return false;
	if (eskel_file_write(written, bytes, size, NULL) == ESKEL_STORE_OK)
		return eskel_file_keep(written, NULL) == ESKEL_STORE_OK;
	eskel_file_discard(written);
	return false;
}

/* Under the lock to the end: a listing takes a file that is half written for what a crash has left, and counts none that is
 * to come. */
void esk_cache_put(esk_cache *cache, const char *name, const void *bytes, size_t size)
{
	if (size > cache->most_bytes)
		return;
	pthread_mutex_lock(&cache->lock);
	if (!is_there(cache, name)) {
		if (cache->bytes + size > cache->most_bytes)
			make_room(cache, (cache->most_bytes - size) / 10 * 9);
		if (write_file(cache, name, bytes, size))
			cache->bytes += size;
	}
	pthread_mutex_unlock(&cache->lock);
}

/* ---- turns */

static bool is_under_way(const esk_cache *cache, uint64_t number)
{
	const esk_cache_turn *turn = cache->turns;
	while (turn && turn->number != number)
		turn = turn->next;
	return turn != NULL;
}

bool esk_cache_begin(esk_cache *cache, const char *name, esk_cache_turn *turn)
{
	pthread_mutex_lock(&cache->turns_lock);
	const esk_cache_turn *other = cache->turns;
	while (other && strcmp(other->name, name) != 0)
		other = other->next;
	if (other) {
		const uint64_t number = other->number;
		while (is_under_way(cache, number))
			pthread_cond_wait(&cache->turn_ended, &cache->turns_lock);
	} else {
		*turn = (esk_cache_turn){name, cache->turn_count++, cache->turns};
		cache->turns = turn;
	}
	pthread_mutex_unlock(&cache->turns_lock);
	return !other;
}

void esk_cache_end(esk_cache *cache, const esk_cache_turn *turn)
{
	pthread_mutex_lock(&cache->turns_lock);
	esk_cache_turn **link = &cache->turns;
	while (*link != turn)
		link = &(*link)->next;
	*link = turn->next;
	pthread_cond_broadcast(&cache->turn_ended);
	pthread_mutex_unlock(&cache->turns_lock);
}
