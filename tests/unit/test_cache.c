/* A folder of files of a bounded size together. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "cache.h"
#include "store_fixture.h"
#include "store_sample.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { SIZE = 1000 };

static char bytes[SIZE];

static esk_cache *open_cache(store_fixture *f, uint64_t most)
{
	esk_cache *cache = NULL;
	assert_ok(esk_cache_open(f->store, "cache", most, &cache, &f->error), f);
	return cache;
}

static bool has(esk_cache *cache, const char *name)
{
	int descriptor;
	uint64_t size;
	if (!esk_cache_find(cache, name, &descriptor, &size))
		return false;
	assert_int_equal(size, SIZE);
	close(descriptor);
	return true;
}

/* Times of files have a resolution. */
static void let_time_pass(void)
{
	nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
}

static void what_was_not_used_for_longest_goes_first(void **state)
{
	store_fixture *f = *state;
	static const char *const names[] = {"a", "b", "c", "d", "e"};
	esk_cache *cache = open_cache(f, 5 * SIZE + SIZE / 2);
	for (size_t i = 0; i < 5; i++) {
		esk_cache_put(cache, names[i], bytes, SIZE);
		let_time_pass();
	}
	assert_true(has(cache, "a"));
	let_time_pass();
	esk_cache_close(cache);
	cache = open_cache(f, 5 * SIZE + SIZE / 2); /* uses outlive the process */
	esk_cache_put(cache, "f", bytes, SIZE);     /* of the others nine tenths of what is left stay */
	assert_true(has(cache, "a"));
	assert_false(has(cache, "b"));
	assert_true(has(cache, "c"));
	assert_true(has(cache, "e"));
	assert_true(has(cache, "f"));
	esk_cache_close(cache);
}

static void what_cannot_be_kept_is_not_there_and_harms_nothing(void **state)
{
	store_fixture *f = *state;
	esk_cache *cache = open_cache(f, 2 * SIZE);
	char *large = calloc(1, 2 * SIZE + 1);
	esk_cache_put(cache, "a", bytes, SIZE);
	esk_cache_put(cache, "large", large, 2 * SIZE + 1);
	assert_true(has(cache, "a"));
	assert_false(has(cache, "large"));
	esk_cache_close(cache);
	eskel_store_close(f->store);
	f->store = NULL;
	const eskel_store_options options = {.least_free_bytes = UINT64_MAX}; /* a full disk */
	assert_ok(eskel_store_open(f->path, &options, &f->store, &f->error), f);
	cache = open_cache(f, 2 * SIZE);
	esk_cache_put(cache, "b", bytes, SIZE);
	assert_false(has(cache, "b"));
	assert_true(has(cache, "a"));
	esk_cache_close(cache);
	free(large);
}

static void damage_is_dropped_and_names_go_together(void **state)
{
	store_fixture *f = *state;
	char relative[200];
	size_t size;
	esk_cache *cache = open_cache(f, 10 * SIZE);
	esk_cache_put(cache, "x-1", bytes, SIZE);
	esk_cache_put(cache, "x-2", bytes, SIZE);
	esk_cache_put(cache, "y-1", bytes, SIZE);
	snprintf(relative, sizeof relative, "%s-cache/y-1", strrchr(f->path, '/') + 1);
	char *path = scratch_path(f->folder, relative);
	uint8_t *file = file_read(path, &size);
	file[7] ^= 1;
	file_write(path, file, size);
	assert_false(has(cache, "y-1"));
	assert_int_equal(access(path, F_OK), -1);
	esk_cache_put(cache, "y-1", bytes, SIZE);
	assert_true(has(cache, "y-1"));
	esk_cache_drop(cache, "x-");
	assert_false(has(cache, "x-1"));
	assert_false(has(cache, "x-2"));
	assert_true(has(cache, "y-1"));
	esk_cache_close(cache);
	free(path);
	free(file);
}

enum { FILES = 60 };

typedef struct {
	esk_cache *cache;
	atomic_bool ended;
} writer;

static void *write_files(void *context)
{
	writer *w = context;
	char name[30];
	for (int i = 0; i < FILES; i++) {
		snprintf(name, sizeof name, "y-%d", i);
		esk_cache_put(w->cache, name, bytes, SIZE);
	}
	atomic_store(&w->ended, true);
	return NULL;
}

static void what_is_being_written_is_not_swept(void **state)
{
	store_fixture *f = *state;
	pthread_t thread;
	char name[30];
	writer w = {.cache = open_cache(f, FILES * SIZE)};
	esk_cache_put(w.cache, "y-0", bytes, SIZE);
	assert_int_equal(pthread_create(&thread, NULL, write_files, &w), 0);
	while (!atomic_load(&w.ended))
		esk_cache_drop(w.cache, "x-");
	assert_int_equal(pthread_join(thread, NULL), 0);
	for (int i = 0; i < FILES; i++) {
		snprintf(name, sizeof name, "y-%d", i);
		assert_true(has(w.cache, name));
	}
	esk_cache_put(w.cache, "y-0", bytes, SIZE); /* is there, and needs no room */
	assert_true(has(w.cache, "y-1"));
	esk_cache_close(w.cache);
}

typedef struct {
	esk_cache *cache;
	atomic_bool waits, ended;
	bool begun;
} waiter;

static void *wait_for_turn(void *context)
{
	waiter *w = context;
	esk_cache_turn turn;
	atomic_store(&w->waits, true);
	w->begun = esk_cache_begin(w->cache, "x", &turn);
	atomic_store(&w->ended, true);
	return NULL;
}

static void who_finds_a_file_being_made_waits_for_its_end(void **state)
{
	enum { WAITERS = 3 };
	store_fixture *f = *state;
	esk_cache *cache = open_cache(f, 5 * SIZE);
	waiter waiters[WAITERS] = {0};
	pthread_t threads[WAITERS];
	esk_cache_turn first, other;
	assert_true(esk_cache_begin(cache, "x", &first));
	for (int i = 0; i < WAITERS; i++) {
		waiters[i].cache = cache;
		assert_int_equal(pthread_create(&threads[i], NULL, wait_for_turn, &waiters[i]), 0);
	}
	assert_true(esk_cache_begin(cache, "y", &other)); /* which is nobody's business */
	esk_cache_end(cache, &other);
	for (int i = 0; i < WAITERS; i++)
		while (!atomic_load(&waiters[i].waits))
			let_time_pass();
	let_time_pass();
	for (int i = 0; i < WAITERS; i++)
		assert_false(atomic_load(&waiters[i].ended));
	esk_cache_end(cache, &first); /* without a file: it failed */
	for (int i = 0; i < WAITERS; i++) {
		assert_int_equal(pthread_join(threads[i], NULL), 0);
		assert_false(waiters[i].begun);
	}
	assert_true(esk_cache_begin(cache, "x", &first));
	esk_cache_end(cache, &first);
	esk_cache_close(cache);
}

enum { TAKERS = 4, TURNS = 2000, NAMES = 3 };

typedef struct {
	esk_cache *cache;
	atomic_int at_once[NAMES], begun;
	atomic_bool wrong;
} contest;

static void *take_turns(void *context)
{
	static const char *const names[NAMES] = {"a", "b", "c"};
	contest *c = context;
	for (int i = 0; i < TURNS; i++) {
		const int n = i % NAMES;
		esk_cache_turn turn;
		if (!esk_cache_begin(c->cache, names[n], &turn))
			continue;
		if (atomic_fetch_add(&c->at_once[n], 1) > 0)
			atomic_store(&c->wrong, true);
		atomic_fetch_add(&c->begun, 1);
		atomic_fetch_sub(&c->at_once[n], 1);
		esk_cache_end(c->cache, &turn);
	}
	return NULL;
}

static void a_file_is_made_by_one_at_a_time(void **state)
{
	store_fixture *f = *state;
	contest c = {.cache = open_cache(f, 5 * SIZE)};
	pthread_t threads[TAKERS];
	for (int i = 0; i < TAKERS; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, take_turns, &c), 0);
	for (int i = 0; i < TAKERS; i++)
		assert_int_equal(pthread_join(threads[i], NULL), 0);
	assert_false(atomic_load(&c.wrong));
	assert_true(atomic_load(&c.begun) >= TURNS);
	esk_cache_close(c.cache);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		store_test(what_was_not_used_for_longest_goes_first),
		store_test(what_cannot_be_kept_is_not_there_and_harms_nothing),
		store_test(damage_is_dropped_and_names_go_together),
		store_test(what_is_being_written_is_not_swept),
		store_test(who_finds_a_file_being_made_waits_for_its_end),
		store_test(a_file_is_made_by_one_at_a_time),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
