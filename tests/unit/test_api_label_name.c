#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "label_name.h"

static const struct {
	const char *name, *class;
	eskel_side side;
} names[] = {
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
	/* TotalSegmentator */
	{"hip_left", "hip", ESKEL_SIDE_LEFT},
	{"scapula_right", "scapula", ESKEL_SIDE_RIGHT},
	{"rib_left_7", "rib_7", ESKEL_SIDE_LEFT},
	{"rib_right_12", "rib_12", ESKEL_SIDE_RIGHT},
	{"vertebrae_L1", "vertebrae_l1", ESKEL_SIDE_UNKNOWN},
	{"vertebrae_T12", "vertebrae_t12", ESKEL_SIDE_UNKNOWN},
	{"gluteus_maximus_right", "gluteus_maximus", ESKEL_SIDE_RIGHT},
	{"lung_upper_lobe_left", "lung_upper_lobe", ESKEL_SIDE_LEFT},
	{"iliac_artery_left", "iliac_artery", ESKEL_SIDE_LEFT},
	{"sacrum", "sacrum", ESKEL_SIDE_UNKNOWN},
	{"urinary_bladder", "urinary_bladder", ESKEL_SIDE_UNKNOWN},
	/* the halves of a heart are no mirror images */
	{"heart_atrium_left", "heart_atrium_left", ESKEL_SIDE_UNKNOWN},
	{"heart_ventricle_right", "heart_ventricle_right", ESKEL_SIDE_UNKNOWN},
	{"Left ventricle of heart", "left_ventricle_of_heart", ESKEL_SIDE_UNKNOWN},
	/* 3D Slicer */
	{"left femur", "femur", ESKEL_SIDE_LEFT},
	{"Left Femur", "femur", ESKEL_SIDE_LEFT},
	{"right rib 7", "rib_7", ESKEL_SIDE_RIGHT},
	{"Femur, Left", "femur", ESKEL_SIDE_LEFT},
	{"femur left_1", "femur_1", ESKEL_SIDE_LEFT},
	{"Segment_1", "segment_1", ESKEL_SIDE_UNKNOWN},
	{"L1 vertebra", "l1_vertebra", ESKEL_SIDE_UNKNOWN},
	/* FreeSurfer */
	{"Right-Cerebellum-Cortex", "cerebellum_cortex", ESKEL_SIDE_RIGHT},
	{"Left-Cerebral-White-Matter", "cerebral_white_matter", ESKEL_SIDE_LEFT},
	{"Left-Inf-Lat-Vent", "inf_lat_vent", ESKEL_SIDE_LEFT},
	{"Left-VentralDC", "ventraldc", ESKEL_SIDE_LEFT},
	{"Right-choroid-plexus", "choroid_plexus", ESKEL_SIDE_RIGHT},
	{"ctx-lh-precentral", "ctx_precentral", ESKEL_SIDE_LEFT},
	{"ctx_rh_G_and_S_frontomargin", "ctx_g_and_s_frontomargin", ESKEL_SIDE_RIGHT},
	{"wm-lh-insula", "wm_insula", ESKEL_SIDE_LEFT},
	{"lh.precentral", "precentral", ESKEL_SIDE_LEFT},
	{"Brain-Stem", "brain_stem", ESKEL_SIDE_UNKNOWN},
	{"3rd-Ventricle", "3rd_ventricle", ESKEL_SIDE_UNKNOWN},
	{"CC_Posterior", "cc_posterior", ESKEL_SIDE_UNKNOWN},
	/* ITK-SNAP, whose label files have names in quotes */
	{"\"Left Femur\"", "femur", ESKEL_SIDE_LEFT},
	{"\"Femur R\"", "femur", ESKEL_SIDE_RIGHT},
	{"\"Label 3\"", "label_3", ESKEL_SIDE_UNKNOWN},
	{"R. Hippocampus", "hippocampus", ESKEL_SIDE_RIGHT},
	/* atlases */
	{"Caudate_L", "caudate", ESKEL_SIDE_LEFT},
	{"Frontal_Sup_Orb_R", "frontal_sup_orb", ESKEL_SIDE_RIGHT},
	{"Cerebelum_Crus1_L", "cerebelum_crus1", ESKEL_SIDE_LEFT},
	{"Vermis_4_5", "vermis_4_5", ESKEL_SIDE_UNKNOWN},
	{"G_Frontal_Sup-1-L", "g_frontal_sup_1", ESKEL_SIDE_LEFT},
	{"Superior_frontal_gyrus_left", "superior_frontal_gyrus", ESKEL_SIDE_LEFT},
	{"L_V1_ROI", "v1_roi", ESKEL_SIDE_LEFT},
	/* people */
	{"talus sinister", "talus", ESKEL_SIDE_LEFT},
	{"Os naviculare dextrum", "os_naviculare", ESKEL_SIDE_RIGHT},
	{"fibula dextra", "fibula", ESKEL_SIDE_RIGHT},
	{"Patella sin.", "patella", ESKEL_SIDE_LEFT},
	{"dex tibia", "tibia", ESKEL_SIDE_RIGHT},
	{"Lt femur", "femur", ESKEL_SIDE_LEFT},
	{"Rt. Femur", "femur", ESKEL_SIDE_RIGHT},
	{"Oberschenkel links", "oberschenkel", ESKEL_SIDE_LEFT},
	{"femur [R]", "femur", ESKEL_SIDE_RIGHT},
	{"humerus/left", "humerus", ESKEL_SIDE_LEFT},
	{"metatarsal1_R", "metatarsal1", ESKEL_SIDE_RIGHT},
	{"LeftFemur", "femur", ESKEL_SIDE_LEFT},
	{"femurRight", "femur", ESKEL_SIDE_RIGHT},
	{"leftOsCoxae", "oscoxae", ESKEL_SIDE_LEFT},
	{"RightLeft", "rightleft", ESKEL_SIDE_UNKNOWN},
	{"cleft lip", "cleft_lip", ESKEL_SIDE_UNKNOWN},
	{"dextran", "dextran", ESKEL_SIDE_UNKNOWN},
	{"rt_lt", "rt_lt", ESKEL_SIDE_UNKNOWN},
	{"", "", ESKEL_SIDE_UNKNOWN},
	{" - ()", "", ESKEL_SIDE_UNKNOWN},
};

static void a_name_is_split_into_class_and_side(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		char class[64];
		eskel_side side;
		esk_label_split(names[i].name, class, &side);
		print_message("%s\n", names[i].name);
		assert_string_equal(class, names[i].class);
		assert_int_equal(side, names[i].side);
	}
}

static void a_class_keeps_its_side_words(void **state)
{
	(void)state;
	char class[64];
	esk_label_class("Left Ventricle", class);
	assert_string_equal(class, "left_ventricle");
}

/* In each row the names mean one class, whose name in the first column no other row means. */
static void names_that_differ_by_their_vocabulary_are_of_one_class(void **state)
{
	(void)state;
	static const char *const rows[][6] = {
		{"femur_left", "left femur", "Left-Femur", "\"Femur R\"", "femur, right", "LeftFemur"},
		{"vertebrae_L1", "L1 vertebra", "Vertebra L1", "vertebra_l_1", "vertebrae l1", "VERTEBRA-L1"},
		{"vertebrae_L2", "L2 vertebra", "Vertebra L2", "vertebra_l_2", "vertebrae l2", "VERTEBRA-L2"},
		{"hamate bone (right)", "hamate_L", "Hamate", "os hamate", "Left-Hamate", "hamate bones"},
		{"rib_left_7", "left rib 7", "Rib 7 R", "7th rib (left)", "rib7_L", "rib 7"},
		{"rib_left_17", "left rib 17", "Rib 17 R", "17th rib (left)", "rib17_L", "rib 17"},
		{"metatarsal1_R", "1st metatarsal (right)", "metatarsal 1", "Metatarsal bone 1 L", "metatarsal-1",
			"metatarsal_1"},
		{"Right-Cerebellum-Cortex", "cerebellum cortex", "Cerebellum_Cortex_L", "cortex cerebellum",
			"left cerebellum cortex", "cerebellum.cortex"},
		{"ctx-lh-precentral", "ctx_rh_precentral", "ctx precentral", "precentral ctx", "ctx-precentral",
			"lh.ctx.precentral"},
		{"talus sinister", "talus", "Talus_L", "left talus bone", "TALUS", "talus dexter"},
		{"tarsus", "tarsus L", "tarsus R", "tarsus-left", "lt tarsus", "rt tarsus"},
	};
	enum { ROWS = sizeof rows / sizeof *rows };
	for (size_t i = 0; i < ROWS; i++)
		for (size_t j = 0; j < ROWS; j++)
			for (size_t n = 0; n < 6; n++) {
				char a[64], b[64];
				eskel_side side;
				esk_label_split(rows[i][0], a, &side);
				esk_label_split(rows[j][n], b, &side);
				if (esk_label_same_class(a, b) != (i == j) || esk_label_same_class(b, a) != (i == j))
					fail_msg("%s and %s", rows[i][0], rows[j][n]);
			}
	assert_false(esk_label_same_class("bone", "os"));
	assert_false(esk_label_same_class("", "femur"));
	assert_false(esk_label_same_class("metatarsal_12", "metatarsal_1_2"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_name_is_split_into_class_and_side),
		cmocka_unit_test(a_class_keeps_its_side_words),
		cmocka_unit_test(names_that_differ_by_their_vocabulary_are_of_one_class),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
