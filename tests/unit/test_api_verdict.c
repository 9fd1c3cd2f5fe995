#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "verdict.h"

#include <math.h>

static const eskel_description unrecorded = {.age = NAN};
static const eskel_description femur_left = {.class = (char[]){"femur"}, .side = ESKEL_SIDE_LEFT, .age = NAN};
static const eskel_description femur_right = {.class = (char[]){"femur"}, .side = ESKEL_SIDE_RIGHT, .age = NAN};
static const eskel_description femur = {.class = (char[]){"femur"}, .age = NAN};
static const eskel_description talus_left = {.class = (char[]){"talus"}, .side = ESKEL_SIDE_LEFT, .age = NAN};
static const eskel_description sacrum = {.class = (char[]){"sacrum"}, .side = ESKEL_SIDE_NONE, .age = NAN};

/* What a library could have taught. */
static const esk_scores sure = {.class_score = 0.97, .side_score = 0.99, .distance_z = 0.5};
static const esk_scores unsure = {.class_score = 0.4, .side_score = 0.7, .distance_z = 1.5};
static const esk_scores far = {.class_score = 0.6, .side_score = 0.99, .distance_z = 4.5};
static const esk_scores untaught = {.class_score = 0.9, .side_score = 0.99, .distance_z = NAN};

/* cmocka compares floats only. */
#define assert_near(value, expected) \
	do { \
		if (!(fabs((value) - (expected)) <= 1e-12)) \
			fail_msg("%.17g, expected %.17g", (value), (double)(expected)); \
	} while (0)

#define EVIDENCE(votes, evidence) esk_evidence_of_votes(votes, sizeof votes / sizeof *votes, evidence)

static void the_nearest_tells_the_class_however_many_others_agree_on_another(void **state)
{
	(void)state;
	const esk_vote votes[] = {
		{0.1, &femur_left, 0.5},
		{0.4, &talus_left, 0.5},
		{0.4, &talus_left, 0.5},
		{0.4, &talus_left, 0.5},
	};
	esk_evidence evidence;
	EVIDENCE(votes, &evidence);
	assert_string_equal(evidence.class, "femur");
	assert_near(evidence.distance, 0.1);
	assert_near(evidence.share, 0x1p20 / (0x1p20 + 3)); /* 4^10 to 3 */
}

static void a_stored_copy_decides_alone(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0, &femur_left, 0.5}, {0.01, &talus_left, 0.5}, {0.01, &talus_left, 0.5}};
	esk_evidence evidence;
	EVIDENCE(votes, &evidence);
	assert_string_equal(evidence.class, "femur");
	assert_true(evidence.share > 0.99 && evidence.share <= 1);
}

static void neighbours_without_a_class_do_not_vote(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &unrecorded, 0.5}, {0.4, &talus_left, 0.5}};
	esk_evidence evidence;
	EVIDENCE(votes, &evidence);
	assert_string_equal(evidence.class, "talus");
	assert_near(evidence.distance, 0.4);
	assert_near(evidence.share, 1);
}

static void a_mirrored_neighbour_tells_the_other_side(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, -0.5}};
	esk_evidence evidence;
	esk_verdict verdict;
	EVIDENCE(votes, &evidence);
	assert_near(evidence.rightness, 0.5);
	esk_verdict_of_evidence(&evidence, &sure, &femur_left, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_RIGHT);
	assert_near(verdict.side_score, 0.99);
	assert_int_equal(verdict.agrees, ESK_DISAGREES);
}

static void left_and_right_neighbours_agree_through_their_handedness(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, 0.5}, {0.1, &femur_right, -0.3}, {0.2, &talus_left, -0.5}};
	esk_evidence evidence;
	EVIDENCE(votes, &evidence);
	assert_near(evidence.rightness, -0.4);
	assert_near(evidence.midline, 0);
}

static void contrary_neighbours_cancel_out(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, 0.5}, {0.1, &femur_right, 0.5}};
	esk_evidence evidence;
	esk_verdict verdict;
	EVIDENCE(votes, &evidence);
	assert_near(evidence.rightness, 0);
	esk_verdict_of_evidence(&evidence, &sure, &femur_left, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_UNKNOWN);
}

static void a_side_that_is_not_sure_is_undecided(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, 0.01}};
	esk_evidence evidence;
	esk_verdict verdict;
	EVIDENCE(votes, &evidence);
	esk_verdict_of_evidence(&evidence, &unsure, &femur_left, &verdict);
	assert_string_equal(verdict.class, "femur");
	assert_int_equal(verdict.side, ESKEL_SIDE_UNKNOWN);
	assert_true(isnan(verdict.side_score));
	/* the class agrees, the side was not told */
	assert_int_equal(verdict.agrees, ESK_AGREES_UNKNOWN);
}

static void neighbours_without_a_side_tell_none(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.2, &femur, 0.5}};
	esk_evidence evidence;
	esk_verdict verdict;
	EVIDENCE(votes, &evidence);
	assert_true(isnan(evidence.midline));
	esk_verdict_of_evidence(&evidence, &sure, &unrecorded, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_UNKNOWN);
}

static void a_class_of_the_midline_has_side_none(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &sacrum, 0.01}, {0.2, &sacrum, 0.5}};
	esk_evidence evidence;
	esk_verdict verdict;
	EVIDENCE(votes, &evidence);
	esk_verdict_of_evidence(&evidence, &sure, &sacrum, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_NONE);
	assert_near(verdict.side_score, 1);
	assert_int_equal(verdict.agrees, ESK_AGREES);
}

static void a_shape_too_far_for_its_class_is_unknown(void **state)
{
	(void)state;
	const esk_vote votes[] = {{1.2, &femur_left, 0.5}};
	esk_evidence evidence;
	esk_verdict verdict;
	EVIDENCE(votes, &evidence);
	esk_verdict_of_evidence(&evidence, &far, &femur_left, &verdict);
	assert_null(verdict.class);
	assert_string_equal(verdict.nearest_class, "femur");
	assert_near(verdict.class_score, 0.6);
	assert_near(verdict.distance_z, 4.5);
	assert_int_equal(verdict.side, ESKEL_SIDE_UNKNOWN);
	assert_int_equal(verdict.agrees, ESK_AGREES_UNKNOWN);
	/* how far is too far is not known */
	esk_verdict_of_evidence(&evidence, &untaught, &femur_left, &verdict);
	assert_string_equal(verdict.class, "femur");
	assert_true(isnan(verdict.distance_z));
}

static void without_neighbours_nothing_is_told(void **state)
{
	(void)state;
	esk_evidence evidence;
	esk_verdict verdict;
	esk_evidence_of_votes(NULL, 0, &evidence);
	esk_verdict_of_evidence(&evidence, &untaught, &femur_left, &verdict);
	assert_null(verdict.class);
	assert_null(verdict.nearest_class);
	assert_true(isnan(verdict.class_score) && isnan(verdict.side_score) && isnan(verdict.distance_z));
	assert_int_equal(verdict.side, ESKEL_SIDE_UNKNOWN);
	assert_int_equal(verdict.agrees, ESK_AGREES_UNKNOWN);
}

static void agreement_is_about_what_is_recorded(void **state)
{
	(void)state;
	const eskel_description left_only = {.side = ESKEL_SIDE_LEFT, .age = NAN};
	const struct {
		const eskel_description *recorded;
		esk_agreement agrees;
	} cases[] = {
		{&unrecorded, ESK_AGREES_UNKNOWN},
		{&femur, ESK_AGREES},
		{&femur_left, ESK_AGREES},
		{&femur_right, ESK_DISAGREES},
		{&talus_left, ESK_DISAGREES},
		{&left_only, ESK_AGREES},
	};
	const esk_vote votes[] = {{0.1, &femur_left, 0.5}};
	esk_evidence evidence;
	EVIDENCE(votes, &evidence);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		esk_verdict verdict;
		esk_verdict_of_evidence(&evidence, &sure, cases[i].recorded, &verdict);
		if (verdict.agrees != cases[i].agrees)
			fail_msg("case %zu: %d, expected %d", i, verdict.agrees, cases[i].agrees);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_nearest_tells_the_class_however_many_others_agree_on_another),
		cmocka_unit_test(a_stored_copy_decides_alone),
		cmocka_unit_test(neighbours_without_a_class_do_not_vote),
		cmocka_unit_test(a_mirrored_neighbour_tells_the_other_side),
		cmocka_unit_test(left_and_right_neighbours_agree_through_their_handedness),
		cmocka_unit_test(contrary_neighbours_cancel_out),
		cmocka_unit_test(a_side_that_is_not_sure_is_undecided),
		cmocka_unit_test(neighbours_without_a_side_tell_none),
		cmocka_unit_test(a_class_of_the_midline_has_side_none),
		cmocka_unit_test(a_shape_too_far_for_its_class_is_unknown),
		cmocka_unit_test(without_neighbours_nothing_is_told),
		cmocka_unit_test(agreement_is_about_what_is_recorded),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
