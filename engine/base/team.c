/* Loops follow each other closely, so a thread looks a while for the next one before it sleeps. A loop is open while
 * indices are left to take; a thread that comes late, because it slept or its processor was given to another, finds it
 * closed, and nobody waits for it. */
#include "team.h"

#include "eskel.h"
#include "memory.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <unistd.h>

enum {
	LOOKS = 1000,       /* before sleeping: some 20 us, about what waking up takes */
	MOST_THREADS = 256, /* beyond it they would only wait for memory */
};

struct esk_team {
	pthread_mutex_t lock;
	pthread_cond_t opened, left;
	bool open, ending;  /* change under the lock */
	atomic_uint loops;  /* opened so far; changes under the lock */
	atomic_int working; /* threads that take indices of the loop; grows under the lock, while it is open */
	atomic_size_t next;
	size_t count;
	void (*task)(void *context, size_t index);
	void *context;
	uint32_t thread_count; /* beside the caller */
	pthread_t threads[];
};

static inline void look_slowly(void)
{
#if defined(__x86_64__)
	__builtin_ia32_pause();
#endif
}

static void take_indices(esk_team *team)
{
	for (size_t i; (i = atomic_fetch_add(&team->next, 1)) < team->count;)
		team->task(team->context, i);
}

/* Takes part in every loop that it finds open. */
static void *follow(void *context)
{
	esk_team *team = context;
	unsigned seen = 0;
	for (;;) {
		for (int i = 0; i < LOOKS && atomic_load(&team->loops) == seen; i++)
			look_slowly();
		pthread_mutex_lock(&team->lock);
		while (atomic_load(&team->loops) == seen && !team->ending)
			pthread_cond_wait(&team->opened, &team->lock);
		const bool ending = team->ending, joins = team->open;
		seen = atomic_load(&team->loops);
		if (joins)
			atomic_fetch_add(&team->working, 1);
		pthread_mutex_unlock(&team->lock);
		if (ending)
			return NULL;
		if (!joins)
			continue;
		take_indices(team);
		pthread_mutex_lock(&team->lock);
		if (atomic_fetch_sub(&team->working, 1) == 1)
			pthread_cond_signal(&team->left);
		pthread_mutex_unlock(&team->lock);
	}
}

void esk_team_run(esk_team *team, size_t count, void (*task)(void *context, size_t index), void *context)
{
	if (!team || count < 2) {
		for (size_t i = 0; i < count; i++)
			task(context, i);
		return;
	}
	pthread_mutex_lock(&team->lock);
	team->task = task;
	team->context = context;
	team->count = count;
	atomic_store(&team->next, 0);
	team->open = true;
	atomic_fetch_add(&team->loops, 1);
	pthread_cond_broadcast(&team->opened);
	pthread_mutex_unlock(&team->lock);
	take_indices(team);
	pthread_mutex_lock(&team->lock);
	team->open = false;
	pthread_mutex_unlock(&team->lock);
	for (int i = 0; i < LOOKS && atomic_load(&team->working) > 0; i++)
		look_slowly();
	pthread_mutex_lock(&team->lock);
	while (atomic_load(&team->working) > 0)
		pthread_cond_wait(&team->left, &team->lock);
	pthread_mutex_unlock(&team->lock);
}

uint32_t esk_team_threads(uint32_t asked)
{
	const long online = sysconf(_SC_NPROCESSORS_ONLN);
	if (asked == ESKEL_THREADS_ONLINE)
		asked = online > 0 ? (uint32_t)online : 1;
	return asked < 1 ? 1 : asked < MOST_THREADS ? asked : MOST_THREADS;
}

esk_team *esk_team_new(uint32_t threads)
{
	if (threads < 2)
		return NULL;
	esk_team *team = esk_memory_zeroed_array(1, sizeof *team + (threads - 1) * sizeof *team->threads);
	if (!team)
		return NULL;
	pthread_mutex_init(&team->lock, NULL);
	pthread_cond_init(&team->opened, NULL);
	pthread_cond_init(&team->left, NULL);
	while (team->thread_count < threads - 1 &&
		!pthread_create(&team->threads[team->thread_count], NULL, follow, team))
		team->thread_count++;
	return team;
}

uint32_t esk_team_size(const esk_team *team)
{
	return team ? team->thread_count + 1 : 1;
}

void esk_team_free(esk_team *team)
{
	if (!team)
		return;
	pthread_mutex_lock(&team->lock);
	team->ending = true;
	pthread_cond_broadcast(&team->opened);
	pthread_mutex_unlock(&team->lock);
	for (uint32_t i = 0; i < team->thread_count; i++)
		pthread_join(team->threads[i], NULL);
	pthread_cond_destroy(&team->left);
	pthread_cond_destroy(&team->opened);
	pthread_mutex_destroy(&team->lock);
	free(team);
}
