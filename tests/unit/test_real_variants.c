/* One left talus, stored in many ways: the same shape, whatever the file. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "real_data.h"
#include "skeletons.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VARIANT(name) REAL_DATA "io_variants/VHF_talus_L_" name ".nii.gz"
#define NRRD_VARIANT(name) REAL_DATA "io_variants/VHF_talus_L_" name ".nrrd"
#define METAIMAGE(name) REAL_DATA "io_variants/VHF_talus_L_" name ".mha"

static real_shape talus;

static double distance(const real_shape *a, const real_shape *b)
{
	double found;
	assert_int_equal(eskel_distance(a->signature, b->signature, NULL, &found, NULL, NULL), ESKEL_OK);
	return found;
}

static eskel_chirality compare(const real_shape *a, const real_shape *b)
{
	return skeletons_compare(a->skeleton, b->skeleton);
}

static void assert_same_cloud(const eskel_cloud *a, const eskel_cloud *b)
{
	uint8_t *a_bytes = NULL, *b_bytes = NULL;
	size_t a_size, b_size;
	assert_int_equal(eskel_cloud_encode(a, &a_bytes, &a_size), ESKEL_OK);
	assert_int_equal(eskel_cloud_encode(b, &b_bytes, &b_size), ESKEL_OK);
	assert_int_equal(a_size, b_size);
	assert_memory_equal(a_bytes, b_bytes, a_size);
	free(a_bytes);
	free(b_bytes);
}

static void every_axis_order_type_and_format_gives_the_same_cloud(void **state)
{
	(void)state;
	static const char *const paths[] = {VARIANT("LAS"), VARIANT("LPS"), VARIANT("ASL"), VARIANT("PIR"),
		VARIANT("label300_uint16"), NRRD_VARIANT("RAS"), NRRD_VARIANT("LAS"), NRRD_VARIANT("PIR"),
		NRRD_VARIANT("label300_uint16")};
	for (size_t p = 0; p < sizeof paths / sizeof paths[0]; p++) {
		real_shape variant = {0};
		real_shape_read(&variant, paths[p]);
		assert_same_cloud(variant.cloud, talus.cloud);
		real_shape_clear(&variant);
	}
}

static void an_oblique_nrrd_file_gives_the_cloud_of_its_nifti_twin(void **state)
{
	(void)state;
	real_shape nifti = {0}, nrrd = {0};
	real_shape_read(&nifti, VARIANT("oblique"));
	real_shape_read(&nrrd, NRRD_VARIANT("oblique"));
	assert_same_cloud(nifti.cloud, nrrd.cloud);
	real_shape_clear(&nifti);
	real_shape_clear(&nrrd);
}

static void as_a_metaimage_it_is_the_same_cloud(void **state)
{
	(void)state;
	static const char *const pairs[][2] = {{METAIMAGE("RAS"), VARIANT("RAS")}, {METAIMAGE("LAS"), VARIANT("LAS")},
		{METAIMAGE("PIR"), VARIANT("PIR")}, {METAIMAGE("oblique"), VARIANT("oblique")}};
	for (size_t p = 0; p < sizeof pairs / sizeof *pairs; p++) {
		real_shape metaimage = {0}, nifti = {0};
		real_shape_read(&metaimage, pairs[p][0]);
		real_shape_read(&nifti, pairs[p][1]);
		assert_same_cloud(metaimage.cloud, nifti.cloud);
		real_shape_clear(&metaimage);
		real_shape_clear(&nifti);
	}
}

static void resampled_the_talus_is_close_and_of_the_same_hand(void **state)
{
	(void)state;
	/* Measured: oblique 2e-7, anisotropic 0.036, the other talus of the same subject 0.198. */
	static const char *const paths[] = {VARIANT("oblique"), VARIANT("aniso_0.8x0.8x1.6")};
	real_shape twin = {0};
	real_shape_read(&twin, REAL_DATA "VisibleHuman_Denver/VHF_talus_R.nii.gz");
	print_message("    right talus of the same subject: distance %.3g\n", distance(&talus, &twin));
	for (size_t p = 0; p < sizeof paths / sizeof paths[0]; p++) {
		real_shape variant = {0};
		real_shape_read(&variant, paths[p]);
		eskel_chirality chirality = compare(&talus, &variant);
		print_message("    %s: distance %.3g, score %.3f\n", variant.name, distance(&talus, &variant),
			chirality.score);
		assert_true(distance(&talus, &variant) < distance(&talus, &twin) / 2);
		assert_int_equal(chirality.verdict, ESKEL_CHIRALITY_SAME);
		real_shape_clear(&variant);
	}
	real_shape_clear(&twin);
}

static void mirrored_the_talus_is_as_near_and_of_the_other_hand(void **state)
{
	(void)state;
	real_shape mirrored = {0};
	real_shape_read(&mirrored, VARIANT("MIRRORED_x"));
	eskel_chirality chirality = compare(&talus, &mirrored);
	double found = distance(&talus, &mirrored);
	print_message("    distance %.3g, score %.6f\n", found, chirality.score);
	assert_true(found < 1e-3);
	assert_int_equal(chirality.verdict, ESKEL_CHIRALITY_MIRRORED);
	assert_true(chirality.improper < 1e-6 && chirality.proper > 0.02); /* measured 0.034 */
	real_shape_clear(&mirrored);
}

/* a after b. */
static eskel_affine product(const double a[3][3], const eskel_affine *b)
{
	eskel_affine out;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 4; c++)
			out.m[r][c] = a[r][0] * b->m[0][c] + a[r][1] * b->m[1][c] + a[r][2] * b->m[2][c];
	return out;
}

/* How far two isometries send the centres of the deepest classes of the talus apart, at most, in mm. */
static double disagreement(const eskel_affine *p, const eskel_affine *q)
{
	double greatest = 0;
	for (uint32_t i = 0; i < talus.skeleton->level_count; i++) {
		const double *x = eskel_skeleton_node(talus.skeleton, talus.skeleton->level_count, i)->centre;
		double square = 0;
		for (int r = 0; r < 3; r++) {
			double d = p->m[r][3] - q->m[r][3];
			for (int c = 0; c < 3; c++)
				d += (p->m[r][c] - q->m[r][c]) * x[c];
			square += d * d;
		}
		greatest = fmax(greatest, sqrt(square));
	}
	return greatest;
}

static void isometries_of_the_talus_are_recovered(void **state)
{
	(void)state;
	static const eskel_affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
	uint64_t random = 2;
	double most = 0, rms = 0;
	for (int n = 0; n < 10; n++) {
		double linear[3][3];
		skeletons_rotation(&random, linear);
		for (int r = 0; r < 3 && n % 2; r++)
			linear[r][1] = -linear[r][1];
		const eskel_affine moved = product((const double(*)[3])linear, &talus.cloud->affine);
		const eskel_affine expected = product((const double(*)[3])linear, &identity);
		eskel_superposition found[2];
		eskel_cloud *cloud = NULL;
		assert_int_equal(eskel_cloud_new(talus.cloud->runs, NULL, talus.cloud->run_count, &moved, &cloud, NULL),
			ESKEL_OK);
		real_shape shape = {.name = "moved talus"};
		real_shape_compute(&shape, cloud);
		eskel_superposition_find(talus.skeleton, shape.skeleton, &found[0], &found[1]);
		most = fmax(most, disagreement(&found[n % 2].map, &expected));
		rms = fmax(rms, found[n % 2].rms);
		assert_true(found[1 - n % 2].rms > 0.5);
		real_shape_clear(&shape);
	}
	print_message("    off by %.3g mm at most, rms %.3g mm\n", most, rms);
	assert_true(most < 1e-3 && rms < 1e-3); /* measured 3.4e-4: clouds round the offset of their affine */
}

/* Files that hold the talus in its own place, or its mirror image. */
static void the_talus_is_laid_on_its_resampled_and_mirrored_copies(void **state)
{
	(void)state;
	static const struct {
		const char *path;
		bool mirrored;
		double most_off, most_rms; /* mm */
	} cases[] = {{VARIANT("aniso_0.8x0.8x1.6"), false, 1, 1}, {VARIANT("MIRRORED_x"), true, 1e-3, 1e-3}};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		real_shape variant = {0};
		eskel_superposition found[2];
		real_shape_read(&variant, cases[i].path);
		eskel_superposition_find(talus.skeleton, variant.skeleton, &found[0], &found[1]);
		const eskel_superposition *right = &found[cases[i].mirrored];
		eskel_affine expected = {{{cases[i].mirrored ? -1 : 1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
		expected.m[0][3] = cases[i].mirrored ? right->map.m[0][3] : 0; /* the mirror's place is the file's */
		double off = disagreement(&right->map, &expected);
		print_message("    %s: off by %.3g mm, rms %.3g mm\n", variant.name, off, right->rms);
		assert_true(off < cases[i].most_off && right->rms < cases[i].most_rms);
		real_shape_clear(&variant);
	}
}

/* The same voxels under a turned affine: only its rounding to float, and exact ties of the clustering, may tell. */
static void turning_the_affine_changes_no_distance(void **state)
{
	(void)state;
	uint64_t random = 1;
	double most = 0, most_apart = 0, least_score = 1;
	for (int n = 0; n < 10; n++) {
		double rotation[3][3];
		eskel_affine turned = talus.cloud->affine;
		skeletons_rotation(&random, rotation);
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 4; c++)
				turned.m[r][c] = rotation[r][0] * talus.cloud->affine.m[0][c] +
						 rotation[r][1] * talus.cloud->affine.m[1][c] +
						 rotation[r][2] * talus.cloud->affine.m[2][c];
		eskel_cloud *cloud = NULL;
		assert_int_equal(
			eskel_cloud_new(talus.cloud->runs, NULL, talus.cloud->run_count, &turned, &cloud, NULL),
			ESKEL_OK);
		real_shape shape = {.name = "turned talus"};
		real_shape_compute(&shape, cloud);
		most = fmax(most, distance(&talus, &shape));
		eskel_chirality chirality = compare(&talus, &shape);
		most_apart = fmax(most_apart, chirality.proper);
		least_score = fmin(least_score, chirality.score);
		real_shape_clear(&shape);
	}
	print_message("    greatest distance %.3g, left apart %.3g, least score %.6f\n", most, most_apart, least_score);
	assert_true(most < 1e-6); /* measured 1.4e-7 */
	assert_true(most_apart < 1e-6);
	assert_true(least_score > 0.7); /* measured 0.770 */
}

static int read_talus(void **state)
{
	(void)state;
	real_shape_read(&talus, VARIANT("RAS"));
	return 0;
}

static int free_talus(void **state)
{
	(void)state;
	real_shape_clear(&talus);
	return 0;
}

int main(void)
{
	if (!real_file_exists(VARIANT("RAS"))) {
		printf("skipped: there is no " VARIANT("RAS") "\n");
		return 77;
	}
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_axis_order_type_and_format_gives_the_same_cloud),
		cmocka_unit_test(an_oblique_nrrd_file_gives_the_cloud_of_its_nifti_twin),
		cmocka_unit_test(as_a_metaimage_it_is_the_same_cloud),
		cmocka_unit_test(resampled_the_talus_is_close_and_of_the_same_hand),
		cmocka_unit_test(mirrored_the_talus_is_as_near_and_of_the_other_hand),
		cmocka_unit_test(isometries_of_the_talus_are_recovered),
		cmocka_unit_test(the_talus_is_laid_on_its_resampled_and_mirrored_copies),
		cmocka_unit_test(turning_the_affine_changes_no_distance),
	};
	return cmocka_run_group_tests(tests, read_talus, free_talus);
}
