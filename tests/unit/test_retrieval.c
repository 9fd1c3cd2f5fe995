#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"

#include <math.h>

/* retrieval_oracle.py has random sets; these are the cases that can be written down. */

static eskel_retrieval judge(
	size_t count, const uint32_t *classes, const uint32_t *subjects, const double *distances, size_t query)
{
	const eskel_evaluation evaluation = {count, classes, subjects};
	eskel_retrieval retrieval;
	assert_int_equal(eskel_evaluation_judge(&evaluation, query, distances, &retrieval), ESKEL_OK);
	return retrieval;
}

static void assert_near(double got, double expected)
{
	if (!(fabs(got - expected) < 1e-12))
		fail_msg("%.17g, expected %.17g", got, expected);
}

static void a_perfect_ranking_has_every_measure_at_its_most(void **state)
{
	(void)state;
	const uint32_t classes[] = {7, 7, 7, 7, 2, 2};
	const double distances[] = {0, 1, 2, 3, 4, 5};
	eskel_retrieval r = judge(6, classes, NULL, distances, 0);
	assert_int_equal(r.ranked, 5);
	assert_int_equal(r.relevant, 3);
	assert_near(r.nearest_neighbour, 1);
	assert_near(r.first_tier, 1);
	assert_near(r.second_tier, 1);
	assert_near(r.e_measure, 2. * 3 / (5 + 3));
	assert_near(r.dcg, 1);
	for (int i = 0; i < ESKEL_RECALL_STEPS; i++)
		assert_near(r.precision[i], 1);
}

/* Relevant at ranks 2 and 5 of 5. */
static void the_measures_of_a_ranking_are_those_of_the_princeton_benchmark(void **state)
{
	(void)state;
	const uint32_t classes[] = {1, 0, 1, 0, 0, 1};
	const double distances[] = {0, 1, 2, 3, 4, 5};
	eskel_retrieval r = judge(6, classes, NULL, distances, 0);
	assert_near(r.nearest_neighbour, 0);
	assert_near(r.first_tier, 0.5);
	assert_near(r.second_tier, 0.5);
	assert_near(r.e_measure, 2. * 2 / (5 + 2));
	assert_near(r.dcg, (1 + 1 / log2(5)) / 2);
	assert_near(r.precision[0], 0.5);
	assert_near(r.precision[9], 0.5);
	assert_near(r.precision[10], 0.4);
	assert_near(r.precision[19], 0.4);
}

static void the_e_measure_looks_at_the_first_32(void **state)
{
	(void)state;
	uint32_t classes[101];
	double distances[101];
	for (uint32_t i = 0; i < 101; i++) {
		classes[i] = i % 2;
		distances[i] = i;
	}
	eskel_retrieval r = judge(101, classes, NULL, distances, 0);
	assert_int_equal(r.relevant, 50);
	assert_near(r.e_measure, 2 / (50. / 16 + 2));
}

/* Of m shapes at one distance, r relevant: every rank holds one with probability r / m. */
static void equals_count_as_the_mean_of_their_orders(void **state)
{
	(void)state;
	const uint32_t classes[] = {1, 0, 1, 0, 1, 0};
	const double distances[] = {0, 5, 5, 5, 5, 5};
	eskel_retrieval r = judge(6, classes, NULL, distances, 0);
	assert_near(r.nearest_neighbour, 0.4);
	assert_near(r.first_tier, 0.4);
	assert_near(r.second_tier, 0.8);
	assert_near(r.dcg, 0.4 * (2 + 1 / log2(3) + 0.5 + 1 / log2(5)) / 2);
	assert_near(r.precision[0], 0.5); /* at mean ranks 2 and 4 */
	const uint32_t turned[] = {1, 1, 0, 0, 0, 1};
	eskel_retrieval other = judge(6, turned, NULL, distances, 0);
	assert_memory_equal(&other, &r, sizeof r);
}

static void a_query_leaves_out_its_subject(void **state)
{
	(void)state;
	const uint32_t classes[] = {1, 1, 1, 2, ESKEL_UNNUMBERED};
	const uint32_t subjects[] = {3, 3, 4, 5, ESKEL_UNNUMBERED};
	const double distances[] = {0, NAN, 2, 1, 3};
	eskel_retrieval r = judge(5, classes, subjects, distances, 0);
	assert_int_equal(r.ranked, 3);
	assert_int_equal(r.relevant, 1);
	assert_near(r.nearest_neighbour, 0);
	assert_near(r.second_tier, 1);
	assert_near(r.precision[19], 0.5);
}

static void without_a_relevant_shape_a_query_does_not_count(void **state)
{
	(void)state;
	const uint32_t classes[] = {1, 1, 2, ESKEL_UNNUMBERED, ESKEL_UNNUMBERED};
	const double distances[] = {1, 1, 1, 0, 0};
	eskel_retrieval all[5], mean;
	for (size_t i = 0; i < 5; i++)
		all[i] = judge(5, classes, NULL, distances, i);
	assert_int_equal(all[3].relevant, 0);
	assert_true(all[2].dcg == 0);
	assert_int_equal(eskel_retrieval_mean(all, 5, &mean), 2);
	assert_near(mean.nearest_neighbour, 0);
	assert_near(mean.second_tier, 0);
	assert_near(mean.dcg, (0.5 / log2(3) + 0.5 / 2));
	assert_int_equal(eskel_retrieval_mean(all + 2, 3, &mean), 0);
	assert_true(mean.dcg == 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_perfect_ranking_has_every_measure_at_its_most),
		cmocka_unit_test(the_measures_of_a_ranking_are_those_of_the_princeton_benchmark),
		cmocka_unit_test(the_e_measure_looks_at_the_first_32),
		cmocka_unit_test(equals_count_as_the_mean_of_their_orders),
		cmocka_unit_test(a_query_leaves_out_its_subject),
		cmocka_unit_test(without_a_relevant_shape_a_query_does_not_count),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
