#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "label_name.h"

static void a_name_is_split_into_class_and_side(void **state)
{
	(void)state;
	static const struct {
		const char *name, *class;
		eskel_side side;
	} cases[] = {
		{"femur_left", "femur", ESKEL_SIDE_LEFT},
		{"Hippocampus_L", "hippocampus", ESKEL_SIDE_LEFT},
		{"left talus", "talus", ESKEL_SIDE_LEFT},
		{"Left-Hippocampus", "hippocampus", ESKEL_SIDE_LEFT},
		{"hamate bone (right)", "hamate_bone", ESKEL_SIDE_RIGHT},
		{"ctx-rh-precuneus", "ctx_precuneus", ESKEL_SIDE_RIGHT},
		{"R femur", "femur", ESKEL_SIDE_RIGHT},
		{"rib_left_1", "rib_1", ESKEL_SIDE_LEFT},
		{"LEFT  Os  Coxae", "os_coxae", ESKEL_SIDE_LEFT},
		{"Left_talus_L", "talus", ESKEL_SIDE_LEFT},
		{"  talus  ", "talus", ESKEL_SIDE_UNKNOWN},
		/* l and r inside a name mean something else */
		{"vertebra L 4", "vertebra_l_4", ESKEL_SIDE_UNKNOWN},
		{"vertebrae_L4", "vertebrae_l4", ESKEL_SIDE_UNKNOWN},
		/* whole words only */
		{"Leftover", "leftover", ESKEL_SIDE_UNKNOWN},
		{"brightness", "brightness", ESKEL_SIDE_UNKNOWN},
		/* both sides are none */
		{"left to right shunt", "left_to_right_shunt", ESKEL_SIDE_UNKNOWN},
		/* a side alone is no class */
		{"left", "left", ESKEL_SIDE_UNKNOWN},
		{"L", "l", ESKEL_SIDE_UNKNOWN},
		{"Fémur_G", "fémur_g", ESKEL_SIDE_UNKNOWN},
		{"", "", ESKEL_SIDE_UNKNOWN},
		{" - ()", "", ESKEL_SIDE_UNKNOWN},
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		char class[64];
		eskel_side side;
		esk_label_split(cases[i].name, class, &side);
		print_message("%s\n", cases[i].name);
		assert_string_equal(class, cases[i].class);
		assert_int_equal(side, cases[i].side);
	}
}

static void a_class_keeps_its_side_words(void **state)
{
	(void)state;
	char class[64];
	esk_label_class("Left Ventricle", class);
	assert_string_equal(class, "left_ventricle");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_name_is_split_into_class_and_side),
		cmocka_unit_test(a_class_keeps_its_side_words),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
