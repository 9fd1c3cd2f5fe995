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

#define SAME ESKEL_CHIRALITY_SAME, 0.5
#define MIRRORED ESKEL_CHIRALITY_MIRRORED, -0.5
#define UNDECIDED ESKEL_CHIRALITY_UNDECIDED, 0.01

/* cmocka compares floats only. */
#define assert_near(value, expected) \
	do { \
		if (!(fabs((value) - (expected)) <= 1e-12)) \
			fail_msg("%.17g, expected %.17g", (value), (double)(expected)); \
	} while (0)

#define VERDICT(votes, recorded, verdict) esk_verdict_of_votes(votes, sizeof votes / sizeof *votes, recorded, verdict)

static void the_nearest_tells_the_class_however_many_others_agree_on_another(void **state)
{
	(void)state;
	const esk_vote votes[] = {
		{0.1, &femur_left, SAME},
		{0.4, &talus_left, SAME},
		{0.4, &talus_left, SAME},
		{0.4, &talus_left, SAME},
	};
	esk_verdict verdict;
	VERDICT(votes, &unrecorded, &verdict);
	assert_string_equal(verdict.class, "femur");
	assert_near(verdict.class_score, 0x1p20 / (0x1p20 + 3)); /* 4^10 to 3 */
}

static void a_stored_copy_decides_alone(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0, &femur_left, SAME}, {0.01, &talus_left, SAME}, {0.01, &talus_left, SAME}};
	esk_verdict verdict;
	VERDICT(votes, &unrecorded, &verdict);
	assert_string_equal(verdict.class, "femur");
	assert_true(verdict.class_score > 0.99 && verdict.class_score <= 1);
}

static void neighbours_without_a_class_do_not_vote(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &unrecorded, SAME}, {0.4, &talus_left, SAME}};
	esk_verdict verdict;
	VERDICT(votes, &unrecorded, &verdict);
	assert_string_equal(verdict.class, "talus");
	assert_near(verdict.class_score, 1);
}

static void a_mirrored_neighbour_tells_the_other_side(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, MIRRORED}};
	esk_verdict verdict;
	VERDICT(votes, &femur_left, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_RIGHT);
	assert_near(verdict.side_score, 1);
	assert_int_equal(verdict.agrees, ESK_DISAGREES);
}

static void left_and_right_neighbours_agree_through_their_handedness(void **state)
{
	(void)state;
	const esk_vote votes[] = {
		{0.1, &femur_left, SAME}, {0.1, &femur_right, MIRRORED}, {0.2, &talus_left, MIRRORED}};
	esk_verdict verdict;
	VERDICT(votes, &femur_left, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_LEFT);
	assert_near(verdict.side_score, 1);
	assert_int_equal(verdict.agrees, ESK_AGREES);
}

static void an_unsure_chirality_is_an_unsure_side(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, ESKEL_CHIRALITY_SAME, 0.06}};
	esk_verdict verdict;
	VERDICT(votes, &unrecorded, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_LEFT);
	assert_near(verdict.side_score, 0.3);
}

static void undecided_neighbours_tell_no_side(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, UNDECIDED}, {0.2, &femur, SAME}};
	esk_verdict verdict;
	VERDICT(votes, &femur_left, &verdict);
	assert_string_equal(verdict.class, "femur");
	assert_int_equal(verdict.side, ESKEL_SIDE_UNKNOWN);
	assert_true(isnan(verdict.side_score));
	/* the class agrees, the side was not told */
	assert_int_equal(verdict.agrees, ESK_AGREES_UNKNOWN);
}

static void contrary_neighbours_cancel_out(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &femur_left, SAME}, {0.1, &femur_right, SAME}};
	esk_verdict verdict;
	VERDICT(votes, &unrecorded, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_UNKNOWN);
}

static void a_class_of_the_midline_has_side_none(void **state)
{
	(void)state;
	const esk_vote votes[] = {{0.1, &sacrum, UNDECIDED}, {0.2, &sacrum, SAME}};
	esk_verdict verdict;
	VERDICT(votes, &sacrum, &verdict);
	assert_int_equal(verdict.side, ESKEL_SIDE_NONE);
	assert_near(verdict.side_score, 1);
	assert_int_equal(verdict.agrees, ESK_AGREES);
}

static void without_neighbours_nothing_is_told(void **state)
{
	(void)state;
	esk_verdict verdict;
	esk_verdict_of_votes(NULL, 0, &femur_left, &verdict);
	assert_null(verdict.class);
	assert_true(isnan(verdict.class_score) && isnan(verdict.side_score));
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
	const esk_vote votes[] = {{0.1, &femur_left, SAME}};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		esk_verdict verdict;
		VERDICT(votes, cases[i].recorded, &verdict);
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
		cmocka_unit_test(an_unsure_chirality_is_an_unsure_side),
		cmocka_unit_test(undecided_neighbours_tell_no_side),
		cmocka_unit_test(contrary_neighbours_cancel_out),
		cmocka_unit_test(a_class_of_the_midline_has_side_none),
		cmocka_unit_test(without_neighbours_nothing_is_told),
		cmocka_unit_test(agreement_is_about_what_is_recorded),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
