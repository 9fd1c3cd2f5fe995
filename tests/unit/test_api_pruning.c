#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "api/client.h"

#include <math.h>

enum { SHAPES = 60 }; /* few enough that all are tried */

static void enroll_many(eskel_api *api, char ids[SHAPES][ESKEL_ID_SIZE])
{
	for (unsigned i = 0; i < SHAPES; i++)
		enroll_blob(api, i % 36, i / 36, 0, "levels=8", ids[i]);
}

static double nearest(eskel_api *api, const char *id, const char *query)
{
	answer a = get(api, "/recognize?shape=%s%s", id, query);
	assert_status(&a, 200);
	double distance = number_at(&a, "results.0.neighbours.0.distance");
	answer_free(&a);
	return distance;
}

static void the_risk_is_how_often_stored_shapes_lose_their_nearest(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE];
	static const char *const ways[] = {"&mode=pruned", "&mode=pruned&keep=0.01&minimum=1&signature=paper"};
	enroll_many(f->api, ids);
	for (size_t w = 0; w < 2; w++) {
		size_t lost = 0;
		const char *exact = w == 0 ? "" : "&signature=paper";
		for (size_t i = 0; i < SHAPES; i++)
			lost += nearest(f->api, ids[i], ways[w]) > nearest(f->api, ids[i], exact);
		answer a = get(f->api, "/recognize?shape=%s%s", ids[0], ways[w]);
		assert_false(json_is_true(at(&a, "results.0.search.proven")));
		assert_true(number_at(&a, "results.0.search.risk.trials") == SHAPES);
		assert_true(number_at(&a, "results.0.search.risk.library") == SHAPES);
		double risk = number_at(&a, "results.0.search.risk.dropped_nearest");
		if (fabs(risk - ((double)lost + 0.5) / (SHAPES + 1)) > 1e-12)
			fail_msg("risk %g, expected %zu of %d", risk, lost, SHAPES);
		print_message("%zu of %d lost their nearest\n", lost, SHAPES);
		answer_free(&a);
	}
}

static void an_order_risks_nothing(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE];
	enroll_many(f->api, ids);
	answer a = get(f->api, "/recognize?shape=%s&scale=neighbourhood", ids[0]);
	assert_false(json_is_true(at(&a, "results.0.search.proven")));
	assert_true(json_is_null(at(&a, "results.0.search.risk")));
	answer_free(&a);
}

static void keeping_all_risks_nothing(void **state)
{
	api_fixture *f = *state;
	char ids[SHAPES][ESKEL_ID_SIZE];
	enroll_many(f->api, ids);
	answer a = get(f->api, "/recognize?shape=%s&mode=pruned&minimum=60", ids[0]);
	assert_true(json_is_true(at(&a, "results.0.search.proven")));
	assert_true(json_is_null(at(&a, "results.0.search.risk")));
	answer_free(&a);
}

static void what_only_pruning_uses_is_refused_elsewhere(void **state)
{
	api_fixture *f = *state;
	static const struct {
		const char *query, *said;
	} cases[] = {
		{"keep=0.2", "keep is given without a use, expected mode=pruned beside it"},
		{"minimum=20", "minimum is given without a use, expected mode=pruned beside it"},
		{"mode=pruned&keep=0", "keep is \\\"0\\\", expected a number above 0, at most 1"},
		{"mode=pruned&keep=1.5", "keep is \\\"1.5\\\", expected a number above 0, at most 1"},
		{"mode=pruned&keep=x", "keep is \\\"x\\\", expected a number above 0, at most 1"},
		{"mode=pruned&minimum=0", "minimum is \\\"0\\\", expected a whole number from 1 to"},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		answer a = get(f->api, "/recognize?shape=%032d&%s", 1, cases[i].query);
		assert_says(&a, 400, cases[i].said);
		answer_free(&a);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		api_test(the_risk_is_how_often_stored_shapes_lose_their_nearest),
		api_test(an_order_risks_nothing),
		api_test(keeping_all_risks_nothing),
		api_test(what_only_pruning_uses_is_refused_elsewhere),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
