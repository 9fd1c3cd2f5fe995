#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "fit.h"

#include <math.h>
#include <string.h>

#define assert_near(value, expected, within) \
	do { \
		if (!(fabs((value) - (expected)) <= (within))) \
			fail_msg("%.17g, expected %.17g", (value), (double)(expected)); \
	} while (0)

/* A trial of a femur or talus that was told as one of the two. */
static esk_trial trial_of(char *class, char *told, double share, double distance, double fellow)
{
	return (esk_trial){
		.class = class,
		.told = told,
		.evidence = {.class = told, .distance = distance, .share = share, .midline = 0},
		.fellow = fellow,
	};
}

static char femur[] = "femur", talus[] = "talus", hamate[] = "hamate";

static esk_scores scores_of(const esk_fit *fit, const esk_evidence *evidence)
{
	esk_scores scores;
	esk_fit_scores(fit, evidence, &scores);
	return scores;
}

static void an_untaught_fit_gives_what_is_usual(void **state)
{
	(void)state;
	esk_fit fit;
	assert_true(esk_fit_make(NULL, 0, ESK_NO_FOLD, &fit));
	const esk_evidence clear = {.class = femur, .share = 1, .distance = 0.2, .rightness = 0.2};
	const esk_evidence vague = {.class = femur, .share = 0.3, .distance = 0.2, .rightness = 0.01};
	assert_true(scores_of(&fit, &clear).class_score > 0.9);
	assert_true(scores_of(&fit, &clear).side_score > 0.99);
	assert_true(scores_of(&fit, &vague).class_score < 0.7);
	assert_true(scores_of(&fit, &vague).side_score < 0.7);
	assert_true(isnan(scores_of(&fit, &clear).distance_z));
	const esk_evidence none = {.distance = NAN, .midline = NAN};
	assert_true(isnan(scores_of(&fit, &none).class_score));
	esk_fit_clear(&fit);
}

static void z_counts_deviations_from_the_drawn_mean_of_the_class(void **state)
{
	(void)state;
	esk_trial trials[6];
	for (int i = 0; i < 6; i++) /* ln fellow is 0 for femora, 3 for tali */
		trials[i] = trial_of(i % 2 ? talus : femur, femur, 1, 1, i % 2 ? exp(3) : 1);
	esk_fit fit;
	assert_true(esk_fit_make(trials, 6, ESK_NO_FOLD, &fit));
	/* the mean of all is 1.5; with 3 members and a pull of 2: 0.6 and 2.4; all deviate by 0.6 from those */
	const double deviation = sqrt((4 * 0.35 * 0.35 + 6 * 0.36) / 10);
	assert_near(fit.mean, 1.5, 1e-12);
	assert_near(esk_fit_z(&fit, femur, exp(2.0)), (2 - 0.6) / deviation, 1e-12);
	assert_near(esk_fit_z(&fit, talus, exp(2.0)), (2 - 2.4) / deviation, 1e-12);
	assert_near(esk_fit_z(&fit, hamate, exp(2.0)), 0.5 / deviation, 1e-12); /* of a class that is not there */
	esk_fit_clear(&fit);
	for (int i = 0; i < 6; i++) /* the tali are of one person */
		trials[i].twin = i % 2;
	assert_true(esk_fit_make(trials, 6, ESK_NO_FOLD, &fit));
	assert_near(esk_fit_z(&fit, femur, exp(2.0)), (2 - 0.6) / deviation, 1e-12);
	assert_near(esk_fit_z(&fit, talus, exp(2.0)), 0.5 / deviation, 1e-12);
	esk_fit_clear(&fit);
	assert_true(esk_fit_make(trials, 4, ESK_NO_FOLD, &fit)); /* too few to say */
	assert_true(isnan(esk_fit_z(&fit, femur, 1)));
	esk_fit_clear(&fit);
}

/* 400 trials of two kinds: those with a share of 1 are right in 9 of 10, those with a share of 0.5 in half. */
static void many_trials_teach_their_frequencies(void **state)
{
	(void)state;
	static esk_trial trials[400];
	for (int i = 0; i < 400; i++) {
		bool clear = i % 2, right = clear ? i % 20 != 1 : i % 4 == 0;
		trials[i] = trial_of(femur, right ? femur : talus, clear ? 1 : 0.5, 0.3, 0.3);
	}
	esk_fit fit;
	assert_true(esk_fit_make(trials, 400, ESK_NO_FOLD, &fit));
	assert_near(scores_of(&fit, &trials[1].evidence).class_score, 0.9, 0.02);
	assert_near(scores_of(&fit, &trials[0].evidence).class_score, 0.5, 0.04);
	esk_fit_clear(&fit);
}

static void a_side_is_learned_where_the_class_was_right(void **state)
{
	(void)state;
	esk_trial trial = trial_of(femur, femur, 1, 0.3, 0.3);
	trial.side = ESKEL_SIDE_LEFT;
	assert_false(esk_fit_learns_side(&trial)); /* nothing was told */
	trial.evidence.rightness = 0.1;
	assert_true(esk_fit_learns_side(&trial));
	assert_false(esk_fit_side_is_right(&trial));
	trial.evidence.rightness = -0.1;
	assert_true(esk_fit_side_is_right(&trial));
	trial.told = talus;
	assert_false(esk_fit_learns_side(&trial));
	trial.told = femur;
	trial.side = ESKEL_SIDE_NONE;
	assert_false(esk_fit_learns_side(&trial));
}

static void wrong_sides_make_a_library_cautious(void **state)
{
	(void)state;
	static esk_trial trials[100];
	for (int i = 0; i < 100; i++) {
		trials[i] = trial_of(femur, femur, 1, 0.3, 0.3);
		trials[i].side = ESKEL_SIDE_RIGHT;
		trials[i].evidence.rightness = i % 3 ? 0.1 : -0.1; /* a third is wrong */
	}
	esk_fit taught, untaught;
	assert_true(esk_fit_make(trials, 100, ESK_NO_FOLD, &taught));
	assert_true(esk_fit_make(NULL, 0, ESK_NO_FOLD, &untaught));
	assert_true(scores_of(&untaught, &trials[1].evidence).side_score > 0.98);
	assert_true(scores_of(&taught, &trials[1].evidence).side_score < ESK_LEAST_SIDE_SCORE);
	esk_fit_clear(&taught);
	esk_fit_clear(&untaught);
}

static void an_omitted_fold_teaches_nothing(void **state)
{
	(void)state;
	esk_trial trials[20];
	for (int i = 0; i < 20; i++)
		trials[i] = trial_of(femur, i % ESK_FOLDS == 2 ? talus : femur, 1, 0.3, 0.3);
	esk_fit all, omitted;
	assert_true(esk_fit_make(trials, 20, ESK_NO_FOLD, &all));
	assert_true(esk_fit_make(trials, 20, 2, &omitted));
	assert_int_equal(all.fellows, 20);
	assert_int_equal(omitted.fellows, 16);
	assert_true(scores_of(&omitted, &trials[0].evidence).class_score >
		    scores_of(&all, &trials[0].evidence).class_score);
	esk_fit_clear(&all);
	esk_fit_clear(&omitted);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_untaught_fit_gives_what_is_usual),
		cmocka_unit_test(z_counts_deviations_from_the_drawn_mean_of_the_class),
		cmocka_unit_test(many_trials_teach_their_frequencies),
		cmocka_unit_test(a_side_is_learned_where_the_class_was_right),
		cmocka_unit_test(wrong_sides_make_a_library_cautious),
		cmocka_unit_test(an_omitted_fold_teaches_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
