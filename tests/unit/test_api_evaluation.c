#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Seven classes with a left and a right of two subjects each; of the last subject there is nothing else. */
enum { classes = 7, count = 4 * classes };

typedef struct {
	char ids[count][ESKEL_ID_SIZE];
	unsigned family[count], subject[count];
	bool right[count];
} collection;

static void enroll_collection(eskel_api *api, collection *c)
{
	for (unsigned i = 0; i < count; i++) {
		char query[100];
		c->family[i] = i / 4;
		c->subject[i] = i / 2 % 2;
		c->right[i] = i % 2;
		snprintf(query, sizeof query, "levels=8&name=class%c_%s&subject=S%u", 'a' + (int)c->family[i],
			c->right[i] ? "right" : "left", c->subject[i]);
		enroll_blob(api, 5 * c->family[i], i % 4, c->right[i], query, c->ids[i]);
	}
}

static double cell(const answer *matrix, size_t i, size_t j)
{
	char path[40];
	snprintf(path, sizeof path, "distances.%zu.%zu", i, j);
	return number_at(matrix, path);
}

/* By scanning a row; count if all are left out. */
static size_t nearest_of(const collection *c, const answer *matrix, size_t query, bool by_subject, bool of_class)
{
	size_t nearest = count;
	for (size_t i = 0; i < count; i++) {
		if (i == query || (by_subject && c->subject[i] == c->subject[query]) ||
			(of_class && c->family[i] != c->family[query]))
			continue;
		if (nearest == count || cell(matrix, query, i) < cell(matrix, query, nearest))
			nearest = i;
	}
	return nearest;
}

static void assert_near(double got, double expected)
{
	if (!(fabs(got - expected) < 1e-12))
		fail_msg("%.15g, expected %.15g", got, expected);
}

static size_t sum_of_confusion(const answer *a, const char *member)
{
	size_t i, sum = 0;
	json_t *row;
	json_array_foreach (at(a, "confusion"), i, row)
		sum += (size_t)json_integer_value(json_object_get(row, member));
	return sum;
}

static void an_evaluation_agrees_with_the_matrix_of_distances(void **state)
{
	api_fixture *f = *state;
	collection c;
	enroll_collection(f->api, &c);
	static const char *const distances[] = {
		"", "signature=paper", "distance=level&level=3&metric=euclidean", "size=free"};
	for (size_t d = 0; d < 8; d++) {
		bool by_subject = d % 2;
		answer matrix = get(f->api, "/distances?%s", distances[d / 2]);
		answer a =
			get(f->api, "/evaluation?leave_out=%s&%s", by_subject ? "subject" : "shape", distances[d / 2]);
		assert_status(&a, 200);
		size_t right = 0;
		for (size_t i = 0; i < count; i++)
			right += c.family[nearest_of(&c, &matrix, i, by_subject, false)] == c.family[i];
		assert_near(number_at(&a, "measures.nearest_neighbour"), (double)right / count);
		assert_int_equal(sum_of_confusion(&a, "right"), right);
		assert_int_equal(sum_of_confusion(&a, "queries"), count);
		assert_true(number_at(&a, "shapes") == count && number_at(&a, "queries") == count);
		assert_true(number_at(&a, "classes") == classes);
		assert_string_equal(text_at(&a, "leave_out"), by_subject ? "subject" : "shape");
		assert_int_equal(json_array_size(at(&a, "precision_recall")), 20);
		assert_true(number_at(&a, "measures.dcg") >= number_at(&a, "measures.first_tier"));
		answer_free(&a);
		answer_free(&matrix);
	}
}

static void the_distance_is_told_by_its_parameters(void **state)
{
	api_fixture *f = *state;
	answer a = get(f->api, "/evaluation?signature=paper&distance=level&metric=euclidean&size=free");
	assert_string_equal(text_at(&a, "distance.signature"), "paper");
	assert_string_equal(text_at(&a, "distance.distance"), "level");
	assert_string_equal(text_at(&a, "distance.metric"), "euclidean");
	assert_string_equal(text_at(&a, "distance.size"), "free");
	assert_true(number_at(&a, "distance.level") == 10);
	answer sum = get(f->api, "/evaluation");
	assert_string_equal(text_at(&sum, "distance.signature"), "log");
	assert_true(json_is_null(at(&sum, "distance.level")));
	answer_free(&a);
	answer_free(&sum);
}

/* Beside what recognitions say of the same pairs. */
static void sides_are_judged_beside_the_nearest_of_the_class(void **state)
{
	api_fixture *f = *state;
	collection c;
	enroll_collection(f->api, &c);
	size_t decided = 0, right = 0;
	for (size_t i = 0; i < count; i++) {
		answer r = get(f->api, "/recognize?shape=%s&class=class%c", c.ids[i], 'a' + (int)c.family[i]);
		const char *verdict = text_at(&r, "results.0.neighbours.0.chirality.verdict");
		bool other_is_right = strcmp(text_at(&r, "results.0.neighbours.0.side"), "right") == 0;
		const char *expected = other_is_right == c.right[i] ? "same" : "mirrored";
		decided += strcmp(verdict, "undecided") != 0;
		right += strcmp(verdict, expected) == 0;
		answer_free(&r);
	}
	answer a = get(f->api, "/evaluation");
	assert_true(number_at(&a, "side.compared") == count);
	assert_near(number_at(&a, "side.thresholds.2.threshold"), 0.05);
	assert_true(number_at(&a, "side.thresholds.2.decided") == (double)decided);
	assert_true(number_at(&a, "side.thresholds.2.right") == (double)right);
	assert_true(decided > count / 2);
	for (int t = 1; t < 8; t++) {
		char path[40], before[40];
		snprintf(path, sizeof path, "side.thresholds.%d.decided", t);
		snprintf(before, sizeof before, "side.thresholds.%d.decided", t - 1);
		assert_true(number_at(&a, path) <= number_at(&a, before));
	}
	answer_free(&a);
}

static void the_recall_of_pruned_is_that_of_the_searches(void **state)
{
	api_fixture *f = *state;
	collection c;
	enroll_collection(f->api, &c);
	static const char distance[] = "signature=paper&distance=level&level=8";
	answer matrix = get(f->api, "/distances?%s", distance);
	size_t found = 0;
	for (size_t i = 0; i < count; i++) {
		answer r = get(f->api, "/recognize?shape=%s&mode=pruned&%s", c.ids[i], distance);
		size_t nearest = nearest_of(&c, &matrix, i, false, false);
		found += strcmp(text_at(&r, "results.0.neighbours.0.id"), c.ids[nearest]) == 0;
		answer_free(&r);
	}
	answer a = get(f->api, "/evaluation?%s", distance);
	assert_true(number_at(&a, "pruned.searches") == count);
	assert_near(number_at(&a, "pruned.recall"), (double)found / count);
	assert_int_equal(json_array_size(at(&a, "pruned.steps")), 1);
	assert_near(number_at(&a, "pruned.steps.0.kept"), 10);
	assert_near(number_at(&a, "pruned.steps.0.recall"), (double)found / count);
	assert_true(number_at(&a, "milliseconds.exact.p95") >= number_at(&a, "milliseconds.exact.median"));
	answer_free(&a);
	answer_free(&matrix);
}

static void only_what_a_filter_leaves_is_evaluated(void **state)
{
	api_fixture *f = *state;
	collection c;
	enroll_collection(f->api, &c);
	answer one = get(f->api, "/evaluation?subject=S1");
	assert_true(number_at(&one, "shapes") == 2 * classes && number_at(&one, "queries") == 2 * classes);
	answer left_out = get(f->api, "/evaluation?subject=S1&leave_out=subject");
	assert_true(number_at(&left_out, "shapes") == 2 * classes && number_at(&left_out, "queries") == 0);
	assert_true(json_is_null(at(&left_out, "measures.dcg")));
	assert_true(json_is_null(at(&left_out, "pruned.recall")));
	assert_true(number_at(&left_out, "side.compared") == 0);
	answer none = get(f->api, "/evaluation?subject=S7");
	assert_status(&none, 200);
	assert_true(number_at(&none, "shapes") == 0);
	assert_int_equal(json_array_size(at(&none, "confusion")), 0);
	answer_free(&one);
	answer_free(&left_out);
	answer_free(&none);
}

/* A shape without a class is in the way of others, and no query itself. */
static void a_shape_without_a_class_is_no_query(void **state)
{
	api_fixture *f = *state;
	char id[ESKEL_ID_SIZE];
	enroll_blob(f->api, 3, 0, 0, "levels=4&name=femur_left", id);
	enroll_blob(f->api, 3, 5, 0, "levels=4&name=femur_left", id);
	enroll_blob(f->api, 3, 1, 0, "levels=4", id);
	answer a = get(f->api, "/evaluation");
	assert_true(number_at(&a, "shapes") == 3 && number_at(&a, "queries") == 2 && number_at(&a, "classes") == 1);
	assert_near(number_at(&a, "measures.nearest_neighbour"), 0);
	assert_true(json_is_null(at(&a, "confusion.0.nearest.0.class")));
	assert_true(number_at(&a, "confusion.0.nearest.0.queries") == 2);
	answer_free(&a);
}

static void an_evaluation_has_the_limit_of_a_matrix(void **state)
{
	api_fixture *f = *state;
	char path[300], id[ESKEL_ID_SIZE];
	snprintf(path, sizeof path, "%s/small", f->folder);
	eskel_api *small = NULL;
	const eskel_api_options options = {.most_distances = 10};
	assert_int_equal(eskel_api_open(path, &options, &small, NULL), ESKEL_STORE_OK);
	for (unsigned i = 0; i < 3; i++)
		enroll_blob(small, 3 * i, 0, 0, "levels=4", id);
	answer three = get(small, "/evaluation");
	assert_status(&three, 200);
	enroll_blob(small, 13, 0, 0, "levels=4", id);
	answer four = get(small, "/evaluation");
	assert_says(&four, 413, "more than 3 shapes");
	assert_says(&four, 413, "expected at most 10 distances");
	eskel_api_close(small);
	answer_free(&three);
	answer_free(&four);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(an_evaluation_agrees_with_the_matrix_of_distances),
		api_test(the_distance_is_told_by_its_parameters),
		api_test(sides_are_judged_beside_the_nearest_of_the_class),
		api_test(the_recall_of_pruned_is_that_of_the_searches),
		api_test(only_what_a_filter_leaves_is_evaluated),
		api_test(a_shape_without_a_class_is_no_query),
		api_test(an_evaluation_has_the_limit_of_a_matrix),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
