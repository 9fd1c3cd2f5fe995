#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "shapes.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { CLOUDS = 13, LEVELS = 9 };
static const uint32_t thread_counts[] = {1, 2, 3, 8, ESKEL_THREADS_ONLINE};
enum { THREAD_COUNTS = sizeof thread_counts / sizeof *thread_counts };

static eskel_cloud *hamate(double factor)
{
	shapes_solid solid = shapes_hamate;
	solid.scale *= factor;
	return shapes_cloud(&solid, &shapes_identity);
}

/* From small to large, so that the order of work is not that of the clouds. */
static void make_clouds(eskel_cloud *clouds[CLOUDS])
{
	for (int i = 0; i < CLOUDS; i++)
		clouds[i] = hamate(0.2 + 0.02 * i);
}

static void free_clouds(eskel_cloud *clouds[CLOUDS])
{
	for (int i = 0; i < CLOUDS; i++)
		eskel_cloud_free(clouds[i]);
}

static const eskel_cloud *const *as_const(eskel_cloud *clouds[CLOUDS])
{
	return (const eskel_cloud *const *)clouds;
}

/* The same bytes. */
static void assert_same(const eskel_skeleton *a, const eskel_skeleton *b)
{
	uint8_t *bytes[2] = {NULL, NULL};
	size_t sizes[2];
	assert_int_equal(eskel_skeleton_encode(a, &bytes[0], &sizes[0]), ESKEL_OK);
	assert_int_equal(eskel_skeleton_encode(b, &bytes[1], &sizes[1]), ESKEL_OK);
	assert_int_equal(sizes[0], sizes[1]);
	assert_memory_equal(bytes[0], bytes[1], sizes[0]);
	free(bytes[0]);
	free(bytes[1]);
}

static void many_skeletons_are_those_of_each_for_any_number_of_threads(void **state)
{
	(void)state;
	eskel_cloud *clouds[CLOUDS];
	eskel_skeleton *alone[CLOUDS] = {0}, *together[CLOUDS] = {0};
	make_clouds(clouds);
	for (int i = 0; i < CLOUDS; i++)
		assert_int_equal(
			eskel_skeleton_new(clouds[i], &(eskel_skeleton_options){.levels = LEVELS}, &alone[i], NULL),
			ESKEL_OK);
	for (int t = 0; t < THREAD_COUNTS; t++) {
		const eskel_skeleton_options options = {.levels = LEVELS, .threads = thread_counts[t]};
		assert_int_equal(eskel_skeletons_new(as_const(clouds), CLOUDS, &options, together, NULL), ESKEL_OK);
		for (int i = 0; i < CLOUDS; i++) {
			assert_same(together[i], alone[i]);
			eskel_skeleton_free(together[i]);
		}
	}
	for (int i = 0; i < CLOUDS; i++)
		eskel_skeleton_free(alone[i]);
	free_clouds(clouds);
}

static void no_clouds_have_no_skeletons(void **state)
{
	(void)state;
	assert_int_equal(eskel_skeletons_new(NULL, 0, NULL, NULL, NULL), ESKEL_OK);
}

/* Large enough that threads share its runs. */
static void one_large_skeleton_is_the_same_for_any_number_of_threads(void **state)
{
	(void)state;
	eskel_cloud *cloud = hamate(2.7);
	assert_true(cloud->run_count > 10000);
	for (int coarse = 0; coarse < 2; coarse++) {
		eskel_skeleton *one = NULL;
		for (int t = 0; t < THREAD_COUNTS; t++) {
			eskel_skeleton *made = NULL;
			const eskel_skeleton_options options = {
				.levels = LEVELS, .coarse_start = coarse, .threads = thread_counts[t]};
			assert_int_equal(eskel_skeleton_new(cloud, &options, &made, NULL), ESKEL_OK);
			if (one) {
				assert_same(made, one);
				eskel_skeleton_free(made);
			} else
				one = made;
		}
		eskel_skeleton_free(one);
	}
	eskel_cloud_free(cloud);
}

typedef struct {
	atomic_int inside;
	int overlaps, calls;
	uint32_t last, total, stop_at;
} progress;

static bool follow(void *context, uint32_t level, uint32_t levels)
{
	progress *p = context;
	p->overlaps += atomic_fetch_add(&p->inside, 1) != 0;
	p->calls++;
	p->overlaps += level <= p->last;
	p->last = level;
	p->total = levels;
	atomic_fetch_sub(&p->inside, 1);
	return level < p->stop_at;
}

static void progress_counts_the_levels_of_all_and_can_cancel_them(void **state)
{
	(void)state;
	eskel_cloud *clouds[CLOUDS];
	make_clouds(clouds);
	for (int t = 0; t < THREAD_COUNTS; t++)
		for (uint32_t stop_at = 30; stop_at <= 1000; stop_at += 970) {
			eskel_skeleton *made[CLOUDS] = {0};
			progress p = {.stop_at = stop_at};
			eskel_error error = {0};
			const eskel_skeleton_options options = {
				.levels = LEVELS, .threads = thread_counts[t], .progress = follow, .context = &p};
			eskel_status status = eskel_skeletons_new(as_const(clouds), CLOUDS, &options, made, &error);
			assert_int_equal(status, stop_at == 30 ? ESKEL_CANCELLED : ESKEL_OK);
			assert_int_equal(p.overlaps, 0);
			assert_int_equal(p.total, CLOUDS * LEVELS);
			assert_int_equal(p.last, stop_at == 30 ? 30 : CLOUDS * LEVELS);
			for (int i = 0; i < CLOUDS; i++) {
				assert_int_equal(made[i] != NULL, !status);
				eskel_skeleton_free(made[i]);
			}
		}
	free_clouds(clouds);
}

static void a_failure_leaves_no_skeleton_and_says_why(void **state)
{
	(void)state;
	eskel_cloud *clouds[CLOUDS];
	make_clouds(clouds);
	for (int t = 0; t < THREAD_COUNTS; t++) {
		eskel_skeleton *made[CLOUDS] = {0};
		eskel_error error = {0};
		const eskel_skeleton_options options = {.levels = 65, .threads = thread_counts[t]};
		assert_int_equal(eskel_skeletons_new(as_const(clouds), CLOUDS, &options, made, &error), ESKEL_INVALID);
		assert_int_equal(error.status, ESKEL_INVALID);
		assert_string_equal(error.text, "65 levels were asked for, expected 1 to 64");
		for (int i = 0; i < CLOUDS; i++)
			assert_null(made[i]);
	}
	free_clouds(clouds);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(many_skeletons_are_those_of_each_for_any_number_of_threads),
		cmocka_unit_test(no_clouds_have_no_skeletons),
		cmocka_unit_test(one_large_skeleton_is_the_same_for_any_number_of_threads),
		cmocka_unit_test(progress_counts_the_levels_of_all_and_can_cancel_them),
		cmocka_unit_test(a_failure_leaves_no_skeleton_and_says_why),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
