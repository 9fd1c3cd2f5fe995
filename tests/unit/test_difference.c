#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "difference.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEVEL = 5, NODES = ESKEL_NODES(LEVEL) };

/* A shape of 8000 mm^3, so that the side of its cube is 20 mm, whose classes are all alike but for what a test changes. */
typedef struct {
	double rows[NODES][ESKEL_SIGNATURE_NUMBERS];
	eskel_node nodes[NODES];
	eskel_signature signature;
	eskel_skeleton skeleton;
} shape;

static void init(shape *s)
{
	*s = (shape){.signature = {.level_count = LEVEL, .volume = 8000, .rows = s->rows},
		.skeleton = {.level_count = LEVEL, .weight = 1000, .volume = 8000, .nodes = s->nodes}};
	for (uint32_t k = 1, n = 0; k <= LEVEL; k++)
		for (uint32_t c = 0; c < k; c++, n++) {
			const double row[ESKEL_SIGNATURE_NUMBERS] = {8, 4, 2, 10, 0.9};
			memcpy(s->rows[n], row, sizeof row);
			s->nodes[n].weight = 1000.0 / k;
		}
}

static double *row_of(shape *s, uint32_t class_index)
{
	return s->rows[ESKEL_NODES(LEVEL - 1) + class_index];
}

static eskel_match rotated_match(void)
{
	eskel_match match = {.level = LEVEL};
	for (uint32_t i = 0; i < LEVEL; i++)
		match.other[i] = (i + 2) % LEVEL;
	return match;
}

static esk_whole_difference differ(shape *query, shape *neighbour, eskel_size size, esk_difference differences[LEVEL])
{
	const eskel_match match = rotated_match();
	const esk_compared a = {&query->signature, &query->skeleton}, b = {&neighbour->signature, &neighbour->skeleton};
	esk_whole_difference whole;
	esk_differences_of_classes(&a, &b, &match, size, differences);
	esk_difference_of_wholes(&a, &b, size, differences, LEVEL, &whole);
	return whole;
}

static void assert_near(double found, double expected)
{
	if (!(fabs(found - expected) <= 1e-12))
		fail_msg("%.17g, expected %.17g", found, expected);
}

static void equal_shapes_differ_in_nothing(void **state)
{
	(void)state;
	shape a, b;
	esk_difference differences[LEVEL];
	init(&a);
	init(&b);
	const esk_whole_difference whole = differ(&a, &b, ESKEL_SIZE_FIXED, differences);
	assert_string_equal(whole.text, "of the same size");
	for (uint32_t i = 0; i < LEVEL; i++) {
		assert_int_equal(differences[i].class_index, i);
		assert_int_equal(differences[i].other, (i + 2) % LEVEL);
		assert_near(differences[i].importance, 0);
		assert_near(differences[i].length_ratio[0], 1);
		assert_false(differences[i].remarkable);
		assert_string_equal(differences[i].text, "");
	}
}

/* Each number by itself, in class 3, which is matched with class 0. */
static void each_number_has_its_words(void **state)
{
	(void)state;
	static const struct {
		int number; /* of the row; 5: the weight */
		double value;
		const char *text;
		double importance;
	} cases[] = {
		{0, 8 * 1.12, "class 3: 12 % longer", 1.189},
		{0, 8 * 0.5, "class 3: 50 % shorter", 7.273},
		{1, 4 * 1.11, "class 3: 11 % wider", 1.095},
		{1, 4 * 0.9, "class 3: 10 % narrower", 1.105},
		{2, 2 * 1.3, "class 3: 30 % thicker", 2.753},
		{2, 2 * 0.8, "class 3: 20 % thinner", 2.341},
		{2, 2 * 1.05, "", 0.512},
		{3, 11, "class 3: 1.0 mm farther out", 1},
		{3, 6, "class 3: 4.0 mm nearer the centre", 4},
		{3, 10.9, "", 0.9},
		{4, 1, "class 3: more solid", 2},
		{4, 0.7, "class 3: less solid", 4},
		{5, 300, "class 3: 50 % more of the volume", 1.422},
		{5, 100, "class 3: 50 % less of the volume", 2.431},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		shape a, b;
		esk_difference differences[LEVEL];
		init(&a);
		init(&b);
		if (cases[i].number < 5)
			row_of(&a, 3)[cases[i].number] = cases[i].value;
		else
			a.nodes[ESKEL_NODES(LEVEL - 1) + 3].weight = cases[i].value;
		differ(&a, &b, ESKEL_SIZE_FIXED, differences);
		assert_int_equal(differences[0].class_index, 3);
		assert_int_equal(differences[0].other, 0);
		assert_string_equal(differences[0].text, cases[i].text);
		assert_int_equal(differences[0].remarkable, cases[i].text[0] != 0);
		if (fabs(differences[0].importance - cases[i].importance) > 1e-3)
			fail_msg("%s: importance %g, expected %g", cases[i].text, differences[0].importance,
				cases[i].importance);
	}
}

static void proportions_speak_where_no_axis_does(void **state)
{
	(void)state;
	shape a, b;
	esk_difference differences[LEVEL];
	init(&a);
	init(&b);
	row_of(&a, 1)[0] = 8 * 1.09;
	row_of(&a, 1)[1] = 4 / 1.09;
	row_of(&a, 1)[2] = 2 * 1.09;
	differ(&a, &b, ESKEL_SIZE_FIXED, differences);
	assert_string_equal(differences[0].text, "class 1: 19 % more elongated, 16 % less flat");
	assert_near(differences[0].elongation_ratio, 1.09 * 1.09);
	assert_near(differences[0].flatness_ratio, 1 / (1.09 * 1.09));
}

static void the_important_come_first_and_the_remarkable_are_named(void **state)
{
	(void)state;
	shape a, b;
	esk_difference differences[LEVEL];
	init(&a);
	init(&b);
	row_of(&a, 4)[3] = 20;
	row_of(&a, 1)[3] = 14;
	row_of(&a, 2)[3] = 11.2;
	a.signature.volume = a.skeleton.volume = 9000;
	a.rows[0][0] = 8.4;
	const esk_whole_difference whole = differ(&a, &b, ESKEL_SIZE_FIXED, differences);
	static const uint32_t order[LEVEL] = {4, 1, 2, 0, 3};
	for (int i = 0; i < LEVEL; i++)
		assert_int_equal(differences[i].class_index, order[i]);
	assert_true(differences[0].remarkable && differences[1].remarkable && !differences[2].remarkable);
	assert_near(whole.volume_ratio, 1.125);
	assert_string_equal(whole.text, "12 % larger, 5 % longer; classes 4, 1 stand out");
}

static void where_size_is_free_both_are_of_one_volume(void **state)
{
	(void)state;
	shape a, b;
	esk_difference differences[LEVEL];
	init(&a);
	init(&b);
	for (int n = 0; n < NODES; n++)
		for (int i = 0; i < 4; i++)
			b.rows[n][i] *= 2;
	b.signature.volume = b.skeleton.volume = 64000;
	esk_whole_difference whole = differ(&a, &b, ESKEL_SIZE_FREE, differences);
	assert_string_equal(whole.text, "88 % smaller");
	assert_near(differences[0].importance, 0);
	whole = differ(&a, &b, ESKEL_SIZE_FIXED, differences);
	assert_string_equal(whole.text, "88 % smaller, 50 % shorter, 50 % narrower, 50 % thinner");
	assert_string_equal(
		differences[0].text, "class 0: 50 % shorter, 50 % narrower, 50 % thinner, 10.0 mm nearer the centre");
}

static void a_flat_class_has_no_ratio_and_all_sentences_fit(void **state)
{
	(void)state;
	shape a, b;
	esk_difference differences[LEVEL];
	init(&a);
	init(&b);
	row_of(&b, 2)[2] = 0;
	for (uint32_t c = 1; c < LEVEL; c++) {
		const double huge[ESKEL_SIGNATURE_NUMBERS] = {1e10, 1e10, 1e10, 1e10, 1.25};
		memcpy(row_of(&a, c), huge, sizeof huge);
		a.nodes[ESKEL_NODES(LEVEL - 1) + c].weight = 1e9;
	}
	a.signature.volume = 1e25;
	const esk_whole_difference whole = differ(&a, &b, ESKEL_SIZE_FIXED, differences);
	assert_memory_equal(whole.text, "12499999", 8);
	for (int i = 0; i < LEVEL; i++) {
		assert_true(strlen(differences[i].text) < sizeof differences[i].text - 1);
		if (differences[i].class_index == 0) {
			assert_true(isnan(differences[i].length_ratio[2]) && isnan(differences[i].flatness_ratio));
			assert_string_equal(differences[i].text, "");
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(equal_shapes_differ_in_nothing),
		cmocka_unit_test(each_number_has_its_words),
		cmocka_unit_test(proportions_speak_where_no_axis_does),
		cmocka_unit_test(the_important_come_first_and_the_remarkable_are_named),
		cmocka_unit_test(where_size_is_free_both_are_of_one_volume),
		cmocka_unit_test(a_flat_class_has_no_ratio_and_all_sentences_fit),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
