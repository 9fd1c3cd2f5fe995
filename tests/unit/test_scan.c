#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "scan.h"
#include "shelf.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>

/* Not a multiple of sixteen, the width of the loops. */
enum { shapes = 75, combinations = 12 };

static eskel_distance_options combination(int n)
{
	return (eskel_distance_options){.signature = n & 1 ? ESKEL_SIGNATURE_PAPER : ESKEL_SIGNATURE_LOG,
		.size = n & 2 ? ESKEL_SIZE_FREE : ESKEL_SIZE_FIXED,
		.metric = (eskel_metric)(n / 4)};
}

static void fill(shelf *s)
{
	shelf_init(s, shapes);
	for (uint32_t n = 0; n < shapes; n++) {
		eskel_signature *signature = synthetic_signature(n % 9, n, 0.2, 2 + n % 3);
		if (n == 5) /* longer than codes can say */
			signature->rows[1][0] = 1e5;
		shelf_put(s, signature);
	}
}

static void assert_between(
	const esk_scan *scan, const shelf *s, uint32_t level, uint32_t slot, float lower, double distance, int options)
{
	const float differences = (float)(level * esk_numbers(scan->signature));
	const float width = esk_scan_width(scan, differences, lower, s->columns.scales[slot]);
	if (!s->columns.odd[slot] && !((double)lower <= distance && distance <= (double)lower + (double)width))
		fail_msg("options %d: D_%u of shape %u is %.9g, scanned from %.9g to %.9g", options, level, slot,
			distance, (double)lower, (double)lower + (double)width);
}

static void check(const shelf *s, int options, const esk_shape *mine)
{
	const eskel_distance_options chosen = combination(options);
	esk_query query;
	uint16_t slots[shapes];
	float first[shapes], second[shapes];
	for (uint16_t n = 0; n < shapes; n++)
		slots[n] = (uint16_t)(shapes - 1 - n);
	assert_int_equal(esk_query_init(&query, mine, &chosen), ESKEL_OK);
	const esk_scan one = esk_scan_make(&query, 1);
	const esk_scan two = esk_scan_make(&query, chosen.signature == ESKEL_SIGNATURE_LOG ? 0.5f : 1);
	esk_scan_columns(
		&one, &s->columns, s->columns.first_level[chosen.signature], false, query.rows[0], shapes, first);
	esk_scan_pairs(&two, &s->columns, query.rows[1], slots, shapes, second);
	for (uint32_t n = 0; n < shapes; n++) {
		const esk_shape *theirs = s->shapes[slots[n]];
		const double size = esk_query_size_term(&query, theirs->log_volume);
		assert_between(
			&one, s, 1, slots[n], first[slots[n]], esk_query_level(&query, theirs, 1) + size, options);
		assert_between(&two, s, 2, slots[n], second[n], esk_query_level(&query, theirs, 2) + size, options);
	}
	esk_query_clear(&query);
}

static void distances_of_levels_1_and_2_lie_within_the_width_of_a_scan(void **state)
{
	(void)state;
	shelf s;
	fill(&s);
	for (int o = 0; o < combinations; o++)
		for (uint32_t n = 0; n < shapes; n++)
			if (n != 5)
				check(&s, o, s.shapes[n]);
	shelf_clear(&s);
}

static void only_a_shape_beyond_the_codes_is_odd(void **state)
{
	(void)state;
	shelf s;
	fill(&s);
	for (uint32_t n = 0; n < shapes; n++)
		assert_int_equal(s.columns.odd[n], n == 5);
	assert_false(esk_columns_are_plain(&s.columns, 1));
	shelf_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(distances_of_levels_1_and_2_lie_within_the_width_of_a_scan),
		cmocka_unit_test(only_a_shape_beyond_the_codes_is_odd),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
