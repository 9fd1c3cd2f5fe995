#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <stdio.h>
#include <string.h>

#define FAMILIES 5
#define MEMBERS 4

/* Members of families that are easily told apart, of as many subjects, all left. */
static void enroll_families(eskel_api *api, char ids[FAMILIES][MEMBERS][ESKEL_ID_SIZE])
{
	static const char *const classes[FAMILIES] = {"femur", "talus", "hamate", "rib", "hip"};
	for (unsigned family = 0; family < FAMILIES; family++)
		for (unsigned member = 0; member < MEMBERS; member++) {
			char query[100];
			snprintf(query, sizeof query, "name=%s_left&subject=S%u", classes[family], member);
			enroll_blob(api, 5 * family + 3, member, 0, query, ids[family][member]);
		}
}

static void a_library_that_is_told_apart_makes_sure(void **state)
{
	api_fixture *f = *state;
	char ids[FAMILIES][MEMBERS][ESKEL_ID_SIZE];
	answer untaught = get(f->api, "/calibration");
	assert_status(&untaught, 200);
	assert_true(number_at(&untaught, "trials") == 0);
	enroll_families(f->api, ids);
	answer a = get(f->api, "/calibration");
	assert_status(&a, 200);
	assert_true(number_at(&a, "trials") == FAMILIES * MEMBERS);
	assert_true(number_at(&a, "class.count") == FAMILIES * MEMBERS);
	assert_true(number_at(&a, "class.right") == 1);
	assert_true(number_at(&a, "side.right") == 1);
	assert_true(number_at(&a, "class.brier") < 0.02);
	assert_true(number_at(&a, "log_distance.fellows") == FAMILIES * MEMBERS);
	answer found = get(f->api, "/recognize?shape=%s&not.subject=S0", ids[1][0]);
	assert_string_equal(text_at(&found, "results.0.verdict.class"), "talus");
	assert_true(number_at(&found, "results.0.verdict.class_score") > 0.9);
	assert_true(number_at(&found, "results.0.verdict.side_score") > 0.9);
	assert_true(number_at(&found, "results.0.verdict.distance_z") < 3);
	answer_free(&untaught);
	answer_free(&a);
	answer_free(&found);
}

static void names_that_shapes_contradict_make_unsure(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	for (unsigned i = 0; i < 16; i++) { /* shapes of one family under two names */
		char query[100];
		snprintf(query, sizeof query, "class=%s&subject=S%u", i % 2 ? "femur" : "humerus", i);
		enroll_blob(f->api, 3, i, 0, query, id);
	}
	answer a = get(f->api, "/calibration"), found = get(f->api, "/recognize?shape=%s", id);
	assert_true(number_at(&a, "class.right") < 0.8);
	assert_true(number_at(&found, "results.0.verdict.class_score") < 0.9);
	answer_free(&a);
	answer_free(&found);
}

static void what_is_like_nothing_known_is_unknown(void **state)
{
	api_fixture *f = *state;
	char ids[FAMILIES][MEMBERS][ESKEL_ID_SIZE];
	const blob needle = {.label = 1, .length = 20, .width = 2, .knob = 2, .centre = {24, 24, 22}};
	volume_file file = volume_of_blobs(&needle, 1, 48);
	enroll_families(f->api, ids);
	answer a = post_volume(f->api, &file, "/recognize?name=hip_left");
	assert_status(&a, 200);
	assert_null(text_at(&a, "results.0.verdict.class"));
	assert_non_null(text_at(&a, "results.0.verdict.nearest_class"));
	assert_true(number_at(&a, "results.0.verdict.distance_z") > 3);
	assert_true(json_is_null(at(&a, "results.0.verdict.side")));
	assert_true(json_is_null(at(&a, "results.0.verdict.agrees")));
	answer_free(&a);
	volume_free(&file);
}

static json_t *calibration_of(eskel_api *api)
{
	answer a = get(api, "/calibration");
	assert_status(&a, 200);
	json_t *json = json_incref(a.json);
	answer_free(&a);
	return json;
}

/* What was kept up to date through changes is what a server finds that has just started. */
static void answers_depend_on_the_library_alone(void **state)
{
	api_fixture *f = *state;
	char ids[FAMILIES][MEMBERS][ESKEL_ID_SIZE], later[ESKEL_ID_SIZE];
	enroll_families(f->api, ids);
	json_decref(calibration_of(f->api));
	for (unsigned step = 0; step < 6; step++) {
		char target[64];
		snprintf(target, sizeof target, "/shapes/%s", ids[step % FAMILIES][step % MEMBERS]);
		answer a = {0};
		if (step % 3 == 0)
			enroll_blob(f->api, step + 1, 9, 0, step ? "class=femur&subject=S9" : "class=rib", later);
		else if (step % 3 == 1)
			a = ask(f->api, &(question){.method = "PATCH",
						.target = target,
						.body = "{\"class\":\"talus\"}",
						.size = 17,
						.headers = {{"Content-Type", "application/merge-patch+json"}}});
		else
			a = ask(f->api, &(question){.method = "DELETE", .target = target});
		if (a.body)
			assert_true(a.status == 200 || a.status == 204);
		answer_free(&a);
		json_t *followed = calibration_of(f->api);
		api_reopen(f);
		json_t *fresh = calibration_of(f->api);
		if (!json_equal(followed, fresh))
			fail_msg("step %u: %s is not %s", step, json_dumps(followed, 0), json_dumps(fresh, 0));
		json_decref(followed);
		json_decref(fresh);
	}
}

static void many_changes_at_once_are_followed(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	json_decref(calibration_of(f->api));
	for (unsigned i = 0; i < 300; i++) { /* more than are kept, and than are sampled */
		char query[100];
		snprintf(query, sizeof query, "levels=4&class=c%u", i % 20);
		enroll_blob(f->api, i % 20, i / 20, 0, query, id);
	}
	json_t *followed = calibration_of(f->api);
	assert_int_equal(json_integer_value(json_object_get(followed, "trials")), 256);
	api_reopen(f);
	json_t *fresh = calibration_of(f->api);
	assert_true(json_equal(followed, fresh));
	json_decref(followed);
	json_decref(fresh);
}

static void each_way_of_measuring_has_its_own(void **state)
{
	api_fixture *f = *state;
	char ids[FAMILIES][MEMBERS][ESKEL_ID_SIZE];
	enroll_families(f->api, ids);
	answer log = get(f->api, "/calibration"),
	       paper = get(f->api, "/calibration?signature=paper&distance=level&level=4");
	assert_status(&paper, 200);
	assert_true(number_at(&log, "log_distance.mean") != number_at(&paper, "log_distance.mean"));
	answer refused = get(f->api, "/calibration?level=4");
	assert_says(&refused, 400, "level is 4 without a use, expected distance=level beside it");
	answer_free(&log);
	answer_free(&paper);
	answer_free(&refused);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_library_that_is_told_apart_makes_sure),
		api_test(names_that_shapes_contradict_make_unsure),
		api_test(what_is_like_nothing_known_is_unknown),
		api_test(answers_depend_on_the_library_alone),
		api_test(many_changes_at_once_are_followed),
		api_test(each_way_of_measuring_has_its_own),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
