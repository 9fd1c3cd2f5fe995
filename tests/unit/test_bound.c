#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "bound.h"
#include "shelf.h"
#include "synthetic.h"

#include <math.h>

enum { combinations = 24, shapes = 60 };

static eskel_distance_options combination(int n)
{
	return (eskel_distance_options){.signature = n & 1 ? ESKEL_SIGNATURE_PAPER : ESKEL_SIGNATURE_LOG,
		.distance = n & 2 ? ESKEL_DISTANCE_LEVEL : ESKEL_DISTANCE_SUM,
		.size = n & 4 ? ESKEL_SIZE_FREE : ESKEL_SIZE_FIXED,
		.metric = (eskel_metric)(n / 8)};
}

static void assert_no_more(double bound, double distance, const char *name, int options, uint32_t a, uint32_t b)
{
	if (!(bound <= distance))
		fail_msg("options %d, shapes %u and %u: bound by %s %.17g, distance %.17g", options, a, b, name, bound,
			distance);
}

/* By sorted numbers, four levels at a time as a search does; every step is a bound. */
static double check_sorting(
	const shelf *s, const esk_bound *bound, int options, uint32_t a, uint32_t b, double distance)
{
	double sorted = 0, lower = 0;
	for (uint32_t first = 1; first <= 20; first += 4) {
		lower = esk_bound_by_sorting(bound, &s->columns, b, s->shapes[b], first, first + 3, &sorted);
		assert_no_more(lower, distance, "sorting", options, a, b);
	}
	return lower;
}

/* Every bound of every pair; returns the mean of the bounds by sorted numbers over the distances. */
static double check_pairs(shelf *s, int options)
{
	const eskel_distance_options chosen = combination(options);
	double tightness = 0;
	for (uint32_t a = 0; a < shapes; a++) {
		esk_query query;
		esk_bound bound;
		float scanned[shapes], halves[shapes];
		uint16_t slots[shapes];
		for (uint16_t b = 0; b < shapes; b++)
			slots[b] = b;
		assert_int_equal(esk_query_init(&query, s->shapes[a], &chosen), ESKEL_OK);
		esk_bound_init(&bound, &query);
		esk_bound_scan(&bound, &s->columns, shapes, scanned);
		esk_bound_by_halves(&bound, &s->columns, slots, shapes, halves);
		for (uint32_t b = 0; b < shapes; b++) {
			double levels[ESKEL_LEVELS_MAX], bounds[ESKEL_LEVELS_MAX];
			double distance = esk_query_distance(&query, s->shapes[b], levels);
			double sorted = check_sorting(s, &bound, options, a, b, distance);
			assert_no_more((double)scanned[b], distance, "scan", options, a, b);
			assert_no_more((double)halves[b], distance, "halves", options, a, b);
			assert_no_more(
				esk_bound_of_levels(&query, s->shapes[b], levels), distance, "levels", options, a, b);
			esk_bound_levels(&bound, s->shapes[b], bounds);
			const uint32_t depth = esk_query_depth(&query, s->shapes[b]);
			for (uint32_t k = query.summed ? 1 : depth; k <= depth; k++)
				assert_no_more(bounds[k - 1], levels[k - 1], "sorting a level", options, a, b);
			tightness += a == b ? 0 : sorted / distance;
		}
		esk_query_clear(&query);
	}
	return tightness / (shapes * (shapes - 1));
}

static void bounds_of_unlike_shapes_are_never_above_the_distance(void **state)
{
	(void)state;
	shelf s;
	shelf_init(&s, shapes);
	for (uint32_t n = 0; n < shapes; n++)
		shelf_put(&s, synthetic_signature(n % 12, n, 0.2, n % 3 ? 16 : 1 + n % 20));
	for (int o = 0; o < combinations; o++) {
		double tightness = check_pairs(&s, o);
		if (tightness < 0.5)
			fail_msg("options %d: bounds are %g of the distances", o, tightness);
	}
	shelf_clear(&s);
}

/* Lengths that grow in steps about as small as the rounding of a feature: all differences have one sign, so a bound would
 * equal the distance but for rounding. */
static void bounds_of_nearly_equal_shapes_are_never_above_the_distance(void **state)
{
	(void)state;
	shelf s;
	shelf_init(&s, shapes);
	for (uint32_t n = 0; n < shapes; n++) {
		eskel_signature *signature = synthetic_signature(2, 1, 0, 16);
		for (size_t row = 0; row < ESKEL_NODES(16); row++)
			for (int i = 0; i < ESKEL_SIGNATURE_NUMBERS; i++)
				signature->rows[row][i] *= 1 + 3e-8 * n;
		signature->volume *= 1 + 1e-7 * (n % 5);
		shelf_put(&s, signature);
	}
	for (int o = 0; o < combinations; o++)
		check_pairs(&s, o);
	shelf_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bounds_of_unlike_shapes_are_never_above_the_distance),
		cmocka_unit_test(bounds_of_nearly_equal_shapes_are_never_above_the_distance),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
