#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "daemon/queue.h"

#include <pthread.h>
#include <stdatomic.h>

enum { JOBS = 2000 };

typedef struct {
	esk_job job;
	atomic_int done;
} task;

static task tasks[JOBS];
static pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;

static void work(esk_job *job)
{
	pthread_mutex_lock(&gate);
	pthread_mutex_unlock(&gate);
	atomic_fetch_add(&((task *)job)->done, 1);
}

static void places_are_bounded_and_come_back(void **state)
{
	(void)state;
	esk_queue *queue = esk_queue_start(1, 2, work);
	assert_true(esk_queue_take_place(queue));
	assert_true(esk_queue_take_place(queue));
	assert_false(esk_queue_take_place(queue));
	esk_queue_leave_place(queue);
	assert_true(esk_queue_take_place(queue));
	esk_queue_stop(queue);
}

static void every_job_is_done_once_also_when_the_queue_is_stopped(void **state)
{
	(void)state;
	esk_queue *queue = esk_queue_start(2, JOBS, work);
	pthread_mutex_lock(&gate);
	for (int i = 0; i < JOBS; i++) {
		atomic_store(&tasks[i].done, 0);
		esk_queue_submit(queue, &tasks[i].job);
	}
	esk_queue_state seen = esk_queue_look(queue);
	pthread_mutex_unlock(&gate);
	esk_queue_stop(queue);
	assert_int_equal(seen.waiting + seen.working, JOBS);
	for (int i = 0; i < JOBS; i++)
		assert_int_equal(atomic_load(&tasks[i].done), 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(places_are_bounded_and_come_back),
		cmocka_unit_test(every_job_is_done_once_also_when_the_queue_is_stopped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
