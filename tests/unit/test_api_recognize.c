#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api.h"
#include "api/client.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Two members of each of three families, all left; ids[family][member]. */
static void enroll_left_bones(eskel_api *api, char ids[3][2][ESKEL_ID_SIZE])
{
	static const char *const classes[] = {"femur", "talus", "hamate"};
	for (unsigned family = 0; family < 3; family++)
		for (unsigned member = 0; member < 2; member++) {
			char query[100];
			snprintf(query, sizeof query, "name=%s_left&subject=S%u", classes[family], member);
			enroll_blob(api, 5 * family + 3, member, 0, query, ids[family][member]);
		}
}

static void a_stored_shape_is_recognised_by_the_others(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	for (unsigned family = 0; family < 3; family++) {
		answer a = get(f->api, "/recognize?shape=%s", ids[family][0]);
		assert_status(&a, 200);
		assert_int_equal(json_array_size(at(&a, "results")), 1);
		assert_string_equal(text_at(&a, "results.0.query.id"), ids[family][0]);
		assert_int_equal(json_array_size(at(&a, "results.0.neighbours")), 5);
		assert_string_equal(text_at(&a, "results.0.neighbours.0.id"), ids[family][1]);
		assert_string_equal(text_at(&a, "results.0.neighbours.0.chirality.verdict"), "same");
		assert_string_equal(text_at(&a, "results.0.verdict.class"), text_at(&a, "results.0.query.class"));
		assert_string_equal(text_at(&a, "results.0.verdict.side"), "left");
		assert_true(json_is_true(at(&a, "results.0.verdict.agrees")));
		assert_true(number_at(&a, "results.0.search.library") == 5);
		assert_string_equal(text_at(&a, "results.0.search.mode"), "exact");
		double distance = number_at(&a, "results.0.neighbours.0.distance");
		double next = number_at(&a, "results.0.neighbours.1.distance");
		assert_true(distance > 0 && distance < next);
		assert_int_equal(json_array_size(at(&a, "results.0.neighbours.0.levels")), 16);
		answer_free(&a);
	}
}

static void a_wrong_side_is_told(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	/* the mirror image of a left femur is a right one; its label says left */
	volume_file file = volume_of_family(3, 3, 1);
	answer a = post_volume(f->api, &file, "/recognize?label.1.name=femur_left");
	assert_status(&a, 200);
	assert_string_equal(text_at(&a, "results.0.query.class"), "femur");
	assert_string_equal(text_at(&a, "results.0.query.side"), "left");
	assert_string_equal(text_at(&a, "results.0.verdict.class"), "femur");
	assert_string_equal(text_at(&a, "results.0.verdict.side"), "right");
	assert_true(json_is_false(at(&a, "results.0.verdict.agrees")));
	assert_string_equal(text_at(&a, "results.0.neighbours.0.chirality.verdict"), "mirrored");
	answer right = post_volume(f->api, &file, "/recognize?name=femur_right");
	assert_true(json_is_true(at(&right, "results.0.verdict.agrees")));
	answer unsaid = post_volume(f->api, &file, "/recognize");
	assert_true(json_is_null(at(&unsaid, "results.0.verdict.agrees")));
	answer_free(&a);
	answer_free(&right);
	answer_free(&unsaid);
	volume_free(&file);
}

static void nothing_of_a_posted_volume_is_stored(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	volume_file file = volume_of_family(3, 0, 0);
	answer empty = post_volume(f->api, &file, "/recognize?name=femur_left");
	assert_status(&empty, 200);
	assert_int_equal(json_array_size(at(&empty, "results.0.neighbours")), 0);
	assert_null(text_at(&empty, "results.0.verdict.class"));
	assert_true(json_is_null(at(&empty, "results.0.verdict.class_score")));
	assert_null(text_at(&empty, "results.0.query.url"));
	assert_null(text_at(&empty, "results.0.query.created"));
	assert_int_equal(eskel_api_shape_count(f->api), 0);
	answer list = get(f->api, "/shapes");
	assert_int_equal(json_array_size(at(&list, "shapes")), 0);
	/* Its id is the one that it gets when it is enrolled, and then it finds itself. */
	enroll_blob(f->api, 3, 0, 0, "name=femur_left", id);
	assert_string_equal(text_at(&empty, "results.0.query.id"), id);
	answer found = post_volume(f->api, &file, "/recognize");
	assert_string_equal(text_at(&found, "results.0.neighbours.0.id"), id);
	assert_true(number_at(&found, "results.0.neighbours.0.distance") < 1e-6);
	answer_free(&empty);
	answer_free(&list);
	answer_free(&found);
	volume_free(&file);
}

static void each_label_has_a_result(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	blob blobs[2] = {blob_of_family(3, 0), blob_of_family(13, 0)};
	blobs[1].label = 7;
	blobs[1].centre[0] += 48;
	volume_file file = volume_of_blobs(blobs, 2, 96);
	answer a = post_volume(f->api, &file, "/recognize?limit=1");
	assert_status(&a, 200);
	assert_int_equal(json_array_size(at(&a, "results")), 2);
	assert_int_equal(json_array_size(at(&a, "results.0.neighbours")), 1);
	assert_string_equal(text_at(&a, "results.0.verdict.class"), "femur");
	assert_true(number_at(&a, "results.1.query.label") == 7);
	assert_string_equal(text_at(&a, "results.1.verdict.class"), "hamate");
	answer one = post_volume(f->api, &file, "/recognize?label=7&limit=1");
	assert_int_equal(json_array_size(at(&one, "results")), 1);
	assert_true(json_equal(at(&one, "results.0.neighbours"), at(&a, "results.1.neighbours")));
	answer_free(&a);
	answer_free(&one);
	volume_free(&file);
}

static void a_verdict_does_not_depend_on_the_limit(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	answer one = get(f->api, "/recognize?shape=%s&limit=1", ids[0][0]);
	answer many = get(f->api, "/recognize?shape=%s&limit=100", ids[0][0]);
	assert_int_equal(json_array_size(at(&one, "results.0.neighbours")), 1);
	assert_int_equal(json_array_size(at(&many, "results.0.neighbours")), 5);
	assert_true(json_equal(at(&one, "results.0.verdict"), at(&many, "results.0.verdict")));
	assert_true(json_equal(at(&one, "results.0.neighbours.0"), at(&many, "results.0.neighbours.0")));
	answer_free(&one);
	answer_free(&many);
}

static void a_filter_chooses_what_is_compared(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	static const struct {
		const char *query;
		size_t count;
	} cases[] = {
		{"class=femur", 1},
		{"class=talus", 2},
		{"not.subject=S1", 2},
		{"subject=S1&class=talus", 1},
		{"side=right", 0},
		{"q=hamate", 2},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = get(f->api, "/recognize?shape=%s&%s", ids[0][0], cases[i].query);
		assert_status(&a, 200);
		size_t count = json_array_size(at(&a, "results.0.neighbours"));
		if (count != cases[i].count)
			fail_msg("%s leaves %zu, expected %zu", cases[i].query, count, cases[i].count);
		answer_free(&a);
	}
}

static void a_filter_says_nothing_of_a_posted_label(void **state)
{
	api_fixture *f = *state;
	volume_file file = volume_of_family(3, 0, 0);
	answer a = post_volume(f->api, &file, "/recognize?class=femur&side=left&subject=S1&sex=F&attr.a=b");
	assert_status(&a, 200);
	static const char *const members[] = {"class", "side", "subject", "sex"};
	for (size_t i = 0; i < 4; i++) {
		char path[40];
		snprintf(path, sizeof path, "results.0.query.%s", members[i]);
		assert_null(text_at(&a, path));
	}
	assert_int_equal(json_object_size(at(&a, "results.0.query.attributes")), 0);
	answer_free(&a);
	volume_free(&file);
}

static void every_kind_of_distance_ranks_a_near_copy_first(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	static const char *const signatures[] = {"log", "paper"},
				 *const distances[] = {"sum", "level", "level&level=4"},
				 *const metrics[] = {"manhattan", "euclidean", "root"},
				 *const sizes[] = {"fixed", "free"}, *const modes[] = {"pruned", "exact"};
	for (unsigned i = 0; i < 72; i++) {
		answer a = get(f->api, "/recognize?shape=%s&signature=%s&distance=%s&metric=%s&size=%s&mode=%s",
			ids[1][0], signatures[i & 1], distances[i / 24], metrics[i / 8 % 3], sizes[i >> 1 & 1],
			modes[i >> 2 & 1]);
		assert_status(&a, 200);
		assert_string_equal(text_at(&a, "results.0.neighbours.0.id"), ids[1][1]);
		assert_string_equal(text_at(&a, "results.0.search.distance"), i / 24 ? "level" : "sum");
		if (i >> 2 & 1)
			assert_true(json_is_true(at(&a, "results.0.search.proven")));
		answer_free(&a);
	}
}

static void scaled_neighbours_come_in_the_order_of_their_scaled_distances(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	answer a = get(f->api, "/recognize?shape=%s", ids[1][0]);
	assert_status(&a, 200);
	assert_null(json_object_get(at(&a, "results.0.neighbours.0"), "scaled"));
	answer_free(&a);
	a = get(f->api, "/recognize?shape=%s&scale=neighbourhood", ids[1][0]);
	assert_status(&a, 200);
	assert_int_equal(json_array_size(at(&a, "results.0.neighbours")), 5);
	assert_true(json_is_true(at(&a, "results.0.search.proven")));
	double last = 0;
	for (unsigned i = 0; i < 5; i++) {
		json_t *neighbour = json_array_get(at(&a, "results.0.neighbours"), i);
		const double scaled = json_real_value(json_object_get(neighbour, "scaled"));
		assert_true(scaled >= last);
		last = scaled;
	}
	assert_true(last > 0);
	answer_free(&a);
}

static eskel_position_signature *positions_of(eskel_api *api, const char *id)
{
	eskel_shape shape;
	eskel_skeleton *skeleton = NULL;
	eskel_position_signature *positions = NULL;
	assert_int_equal(eskel_store_shape(api->store, id, &shape, NULL), ESKEL_STORE_OK);
	assert_int_equal(eskel_store_skeleton(api->store, shape.key, &skeleton, NULL), ESKEL_STORE_OK);
	assert_int_equal(eskel_position_signature_new(skeleton, &positions), ESKEL_OK);
	eskel_skeleton_free(skeleton);
	eskel_shape_clear(&shape);
	return positions;
}

/* Every neighbour's is the engine's, and they ascend. */
static void assert_order_by_position(eskel_api *api, const answer *a, const char *id, eskel_size size)
{
	size_t i;
	json_t *neighbour;
	double last = 0;
	eskel_position_signature *mine = positions_of(api, id);
	json_array_foreach (at(a, "results.0.neighbours"), i, neighbour) {
		eskel_position_signature *other =
			positions_of(api, json_string_value(json_object_get(neighbour, "id")));
		const double found = json_real_value(json_object_get(neighbour, "position_distance"));
		assert_true(fabs(found - eskel_position_distance(mine, other, size)) < 1e-12);
		assert_true(found >= last);
		last = found;
		eskel_position_signature_free(other);
	}
	assert_true(last > 0);
	eskel_position_signature_free(mine);
}

static void neighbours_can_come_in_the_order_of_their_positions(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	answer plain = get(f->api, "/recognize?shape=%s", ids[1][0]);
	assert_null(json_object_get(at(&plain, "results.0.neighbours.0"), "position_distance"));
	static const char *const sizes[] = {"fixed", "free"};
	for (unsigned size = 0; size < 2; size++) {
		answer a = get(f->api, "/recognize?shape=%s&order=position&size=%s", ids[1][0], sizes[size]);
		assert_status(&a, 200);
		assert_int_equal(json_array_size(at(&a, "results.0.neighbours")), 5);
		assert_order_by_position(f->api, &a, ids[1][0], (eskel_size)size);
		assert_true(json_is_true(at(&a, "results.0.search.proven")));
		if (size == ESKEL_SIZE_FIXED)
			assert_true(json_equal(at(&a, "results.0.verdict"), at(&plain, "results.0.verdict")));
		answer_free(&a);
	}
	volume_file file = volume_of_family(8, 0, 0);
	answer posted = post_volume(f->api, &file, "/recognize?order=position&limit=2&explain=true");
	assert_status(&posted, 200);
	assert_int_equal(json_array_size(at(&posted, "results.0.neighbours")), 2);
	assert_string_equal(text_at(&posted, "results.0.neighbours.0.id"), ids[1][0]);
	assert_true(number_at(&posted, "results.0.neighbours.0.position_distance") < 1e-6);
	assert_order_by_position(f->api, &posted, ids[1][0], ESKEL_SIZE_FIXED);
	answer_free(&plain);
	answer_free(&posted);
	volume_free(&file);
}

static void an_order_of_some_is_not_proven(void **state)
{
	api_fixture *f = *state;
	char ids[44][ESKEL_ID_SIZE];
	for (unsigned i = 0; i < 44; i++)
		enroll_blob(f->api, i % 36, i / 36, 0, "levels=3", ids[i]);
	answer some = get(f->api, "/recognize?shape=%s&order=position", ids[7]);
	assert_int_equal(json_array_size(at(&some, "results.0.neighbours")), 5);
	assert_true(json_is_false(at(&some, "results.0.search.proven")));
	assert_true(json_is_null(at(&some, "results.0.search.risk")));
	assert_order_by_position(f->api, &some, ids[7], ESKEL_SIZE_FIXED);
	answer all = get(f->api, "/recognize?shape=%s&order=position&limit=8", ids[7]);
	assert_int_equal(json_array_size(at(&all, "results.0.neighbours")), 8);
	assert_true(json_is_true(at(&all, "results.0.search.proven")));
	answer_free(&some);
	answer_free(&all);
}

static void an_explanation_matches_classes_and_names_differences(void **state)
{
	api_fixture *f = *state;
	char thin[ESKEL_ID_SIZE], thick[ESKEL_ID_SIZE];
	enroll_blob(f->api, 3, 0, 0, "name=thin", thin);
	enroll_blob(f->api, 11, 0, 0, "name=thick", thick);
	answer a = get(f->api, "/recognize?shape=%s&explain=true", thick);
	assert_status(&a, 200);
	assert_true(number_at(&a, "results.0.neighbours.0.match.level") == 10);
	json_t *pairs = at(&a, "results.0.neighbours.0.match.pairs"),
	       *differences = at(&a, "results.0.neighbours.0.differences");
	assert_int_equal(json_array_size(pairs), 10);
	assert_int_equal(json_array_size(differences), 10);
	unsigned matched = 0, differing = 0;
	double last = INFINITY;
	for (size_t i = 0; i < 10; i++) {
		const json_t *difference = json_array_get(differences, i);
		const size_t class_index = (size_t)json_integer_value(json_object_get(difference, "class"));
		const json_t *pair = json_array_get(pairs, class_index);
		const double importance = json_number_value(json_object_get(difference, "importance"));
		assert_int_equal(json_integer_value(json_array_get(pair, 0)), class_index);
		matched |= 1u << json_integer_value(json_array_get(pair, 1));
		differing |= 1u << class_index;
		assert_true(json_equal(json_object_get(difference, "other"), json_array_get(pair, 1)));
		assert_true(importance <= last);
		assert_int_equal(importance >= 1, json_is_string(json_object_get(difference, "text")));
		last = importance;
	}
	assert_int_equal(matched, 0x3ff);
	assert_int_equal(differing, 0x3ff);
	assert_non_null(strstr(text_at(&a, "results.0.neighbours.0.summary.text"), " % larger, "));
	answer whole = get(f->api, "/recognize?shape=%s&explain=true&level=1", thick);
	const char *text = text_at(&whole, "results.0.neighbours.0.differences.0.text");
	assert_non_null(text);
	assert_memory_equal(text, "class 0: ", 9);
	assert_non_null(strstr(text, " % wider"));
	assert_true(number_at(&whole, "results.0.neighbours.0.match.level") == 1);
	answer plain = get(f->api, "/recognize?shape=%s", thick);
	static const char *const members[] = {
		"classes", "match", "summary", "differences", "isomorphism", "partition", "superposition"};
	for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
		assert_non_null(json_object_get(at(&a, "results.0.neighbours.0"), members[i]));
		assert_null(json_object_get(at(&plain, "results.0.neighbours.0"), members[i]));
	}
	assert_null(json_object_get(at(&plain, "results.0"), "classes"));
	answer_free(&a);
	answer_free(&whole);
	answer_free(&plain);
}

/* Where a matrix sends a centre, less another one. */
static double off(const json_t *matrix, const json_t *centre, const json_t *other)
{
	double square = 0;
	for (size_t r = 0; r < 3; r++) {
		const json_t *row = json_array_get(matrix, r);
		double d = json_number_value(json_array_get(row, 3)) - json_number_value(json_array_get(other, r));
		for (size_t c = 0; c < 3; c++)
			d += json_number_value(json_array_get(row, c)) * json_number_value(json_array_get(centre, c));
		square += d * d;
	}
	return sqrt(square);
}

/* The mirror image of a shape has its classes, so the matrix sends each on its own. */
static void an_explanation_lays_a_shape_on_its_mirror_image(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 3, 0, 0, "name=femur_left", id);
	volume_file file = volume_of_family(3, 0, 1);
	answer a = post_volume(f->api, &file, "/recognize?explain=true");
	assert_status(&a, 200);
	assert_true(json_is_true(at(&a, "results.0.neighbours.0.superposition.mirrored")));
	assert_true(number_at(&a, "results.0.neighbours.0.superposition.rms_mm") < 1e-6);
	assert_true(number_at(&a, "results.0.neighbours.0.isomorphism.depth") == 16);
	assert_true(json_is_true(at(&a, "results.0.neighbours.0.isomorphism.complete")));
	assert_true(number_at(&a, "results.0.neighbours.0.partition.distances_mm") < 1e-6);
	assert_true(number_at(&a, "results.0.neighbours.0.partition.mirrored_tetrahedra_mm3") < 1e-4);
	assert_true(number_at(&a, "results.0.neighbours.0.partition.same_tetrahedra_mm3") > 1);
	assert_string_equal(text_at(&a, "results.0.neighbours.0.summary.text"), "of the same size");
	const json_t *classes = at(&a, "results.0.classes"), *others = at(&a, "results.0.neighbours.0.classes");
	assert_int_equal(json_array_size(classes), 10);
	for (size_t i = 0; i < 10; i++) {
		double distance = off(at(&a, "results.0.neighbours.0.superposition.matrix"),
			json_object_get(json_array_get(classes, i), "centre_mm"),
			json_object_get(json_array_get(others, i), "centre_mm"));
		if (!(distance < 1e-6))
			fail_msg("class %zu lies %g mm off", i, distance);
	}
	answer_free(&a);
	volume_free(&file);
}

static void only_the_neighbours_that_are_answered_are_explained(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE];
	enroll_left_bones(f->api, ids);
	answer one = get(f->api, "/recognize?shape=%s&limit=1&explain=true", ids[0][0]);
	answer plain = get(f->api, "/recognize?shape=%s&limit=1", ids[0][0]);
	assert_status(&one, 200);
	assert_int_equal(json_array_size(at(&one, "results.0.neighbours")), 1);
	assert_true(json_equal(at(&one, "results.0.verdict"), at(&plain, "results.0.verdict")));
	answer_free(&one);
	answer_free(&plain);
}

static void a_deleted_shape_is_no_neighbour(void **state)
{
	api_fixture *f = *state;
	char ids[3][2][ESKEL_ID_SIZE], target[64];
	enroll_left_bones(f->api, ids);
	snprintf(target, sizeof target, "/shapes/%s", ids[0][1]);
	answer gone = ask(f->api, &(question){.method = "DELETE", .target = target});
	assert_status(&gone, 204);
	answer a = get(f->api, "/recognize?shape=%s&mode=exact", ids[0][0]);
	assert_status(&a, 200);
	assert_null(strstr(a.body, ids[0][1]));
	assert_int_equal(json_array_size(at(&a, "results.0.neighbours")), 4);
	answer_free(&gone);
	answer_free(&a);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(a_stored_shape_is_recognised_by_the_others),
		api_test(a_wrong_side_is_told),
		api_test(nothing_of_a_posted_volume_is_stored),
		api_test(each_label_has_a_result),
		api_test(a_verdict_does_not_depend_on_the_limit),
		api_test(a_filter_chooses_what_is_compared),
		api_test(a_filter_says_nothing_of_a_posted_label),
		api_test(every_kind_of_distance_ranks_a_near_copy_first),
		api_test(scaled_neighbours_come_in_the_order_of_their_scaled_distances),
		api_test(neighbours_can_come_in_the_order_of_their_positions),
		api_test(an_order_of_some_is_not_proven),
		api_test(an_explanation_matches_classes_and_names_differences),
		api_test(an_explanation_lays_a_shape_on_its_mirror_image),
		api_test(only_the_neighbours_that_are_answered_are_explained),
		api_test(a_deleted_shape_is_no_neighbour),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
