#include "queue.h"

#include <pthread.h>
#include <stdlib.h>

struct esk_queue {
	pthread_mutex_t lock;
	pthread_cond_t arrived;
	esk_job *first, **end; /* *end is the NULL after the last job */
	size_t places;
	esk_queue_state state;
	bool stopping;
	void (*work)(esk_job *job);
	size_t thread_count;
	pthread_t threads[];
};

/* The next job, NULL when there will be none. */
static esk_job *next(esk_queue *queue)
{
	pthread_mutex_lock(&queue->lock);
	while (!queue->first && !queue->stopping)
		pthread_cond_wait(&queue->arrived, &queue->lock);
	esk_job *job = queue->first;
	if (job) {
		queue->first = job->next;
		if (!queue->first)
			queue->end = &queue->first;
		queue->state.waiting--;
		queue->state.working++;
	}
	pthread_mutex_unlock(&queue->lock);
	return job;
}

static void *run(void *context)
{
	esk_queue *queue = context;
	esk_job *job;
	while ((job = next(queue))) {
		queue->work(job);
		pthread_mutex_lock(&queue->lock);
		queue->state.working--;
		pthread_mutex_unlock(&queue->lock);
	}
	return NULL;
}

esk_queue *esk_queue_start(size_t threads, size_t places, void (*work)(esk_job *job))
{
	esk_queue *queue = calloc(1, sizeof *queue + threads * sizeof *queue->threads);
	if (!queue)
		return NULL;
	queue->places = places;
	queue->work = work;
	queue->end = &queue->first;
	pthread_mutex_init(&queue->lock, NULL);
	pthread_cond_init(&queue->arrived, NULL);
	while (queue->thread_count < threads) {
		if (pthread_create(&queue->threads[queue->thread_count], NULL, run, queue) != 0) {
			esk_queue_stop(queue);
			return NULL;
		}
		queue->thread_count++;
	}
	return queue;
}

void esk_queue_stop(esk_queue *queue)
{
	if (!queue)
		return;
	pthread_mutex_lock(&queue->lock);
	queue->stopping = true;
	pthread_cond_broadcast(&queue->arrived);
	pthread_mutex_unlock(&queue->lock);
	for (size_t t = 0; t < queue->thread_count; t++)
		pthread_join(queue->threads[t], NULL);
	pthread_cond_destroy(&queue->arrived);
	pthread_mutex_destroy(&queue->lock);
	free(queue);
}

bool esk_queue_take_place(esk_queue *queue)
{
	pthread_mutex_lock(&queue->lock);
	bool free_place = queue->state.taken < queue->places;
	queue->state.taken += free_place;
	pthread_mutex_unlock(&queue->lock);
	return free_place;
}

void esk_queue_leave_place(esk_queue *queue)
{
	pthread_mutex_lock(&queue->lock);
	queue->state.taken--;
	pthread_mutex_unlock(&queue->lock);
}

void esk_queue_submit(esk_queue *queue, esk_job *job)
{
	pthread_mutex_lock(&queue->lock);
	job->next = NULL;
	*queue->end = job;
	queue->end = &job->next;
	queue->state.waiting++;
	pthread_cond_signal(&queue->arrived);
	pthread_mutex_unlock(&queue->lock);
}

esk_queue_state esk_queue_look(esk_queue *queue)
{
	pthread_mutex_lock(&queue->lock);
	esk_queue_state state = queue->state;
	pthread_mutex_unlock(&queue->lock);
	return state;
}
