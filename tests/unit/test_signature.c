#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "eskel.h"
#include "synthetic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void assert_near(double found, double expected, double tolerance)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%.17g, expected %.17g within %g", found, expected, tolerance);
}

/* The moments of a solid ellipsoid with semi-axes a, b, c: variances a^2 / 5, b^2 / 5, c^2 / 5. */
static eskel_node solid_ellipsoid(double a, double b, double c, double weight)
{
	return (eskel_node){.weight = weight, .eigenvalues = {a * a / 5, b * b / 5, c * c / 5}};
}

static double ellipsoid_volume(double a, double b, double c)
{
	return 4.0 / 3 * acos(-1) * a * b * c;
}

static void a_solid_ellipsoid_has_solidity_one(void **state)
{
	(void)state;
	eskel_node node = solid_ellipsoid(31, 17, 5, 1000);
	eskel_skeleton skeleton = {
		.level_count = 1, .weight = 1000, .volume = ellipsoid_volume(31, 17, 5), .nodes = &node};
	eskel_signature *signature = NULL;
	assert_int_equal(eskel_signature_new(&skeleton, &signature), ESKEL_OK);
	assert_int_equal(signature->level_count, 1);
	assert_true(signature->volume == skeleton.volume);
	assert_near(signature->rows[0][0], 31 / sqrt(5), 1e-6);
	assert_near(signature->rows[0][1], 17 / sqrt(5), 1e-6);
	assert_near(signature->rows[0][2], 5 / sqrt(5), 1e-6);
	assert_near(signature->rows[0][3], 0, 0);
	assert_near(signature->rows[0][4], 1, 1e-6);
	eskel_signature_free(signature);
}

static void a_class_has_the_solidity_of_its_share_of_the_volume(void **state)
{
	(void)state;
	/* Two distant ellipsoids of which the second is half empty: weights go with the voxels that are there. */
	double first = ellipsoid_volume(4, 3, 2), second = ellipsoid_volume(6, 5, 1) / 2;
	eskel_node nodes[3] = {solid_ellipsoid(50, 4, 3, first + second), solid_ellipsoid(4, 3, 2, first),
		solid_ellipsoid(6, 5, 1, second)};
	nodes[1].rho = 20;
	nodes[2].rho = 28;
	eskel_skeleton skeleton = {
		.level_count = 2, .weight = first + second, .volume = first + second, .nodes = nodes};
	eskel_signature *signature = NULL;
	assert_int_equal(eskel_signature_new(&skeleton, &signature), ESKEL_OK);
	assert_near(signature->rows[1][3], 20, 0);
	assert_near(signature->rows[1][4], 1, 1e-6);
	assert_near(signature->rows[2][3], 28, 0);
	assert_near(signature->rows[2][4], 0.5, 1e-6);
	eskel_signature_free(signature);
}

static void flat_and_single_voxel_classes_have_the_greatest_solidity(void **state)
{
	(void)state;
	eskel_node nodes[3] = {
		{.weight = 7, .eigenvalues = {2, 1, 0}}, {.weight = 1}, {.weight = 6, .eigenvalues = {3, 0, 0}}};
	eskel_skeleton skeleton = {.level_count = 2, .weight = 7, .volume = 7, .nodes = nodes};
	eskel_signature *signature = NULL;
	assert_int_equal(eskel_signature_new(&skeleton, &signature), ESKEL_OK);
	for (int n = 0; n < 3; n++)
		assert_near(signature->rows[n][4], 1.25, 0);
	eskel_signature_free(signature);
}

static void the_numbers_of_a_signature_are_floats(void **state)
{
	(void)state;
	eskel_node nodes[3];
	for (int n = 0; n < 3; n++) {
		nodes[n] = solid_ellipsoid(5.1 + n, 4.3 + n, 3.7 + n, n ? 0.5 : 1);
		nodes[n].rho = 0.1 + n;
	}
	eskel_skeleton skeleton = {.level_count = 2, .weight = 1, .volume = 300.7, .nodes = nodes};
	eskel_signature *signature = NULL;
	assert_int_equal(eskel_signature_new(&skeleton, &signature), ESKEL_OK);
	for (int n = 0; n < 3; n++)
		for (int i = 0; i < ESKEL_SIGNATURE_NUMBERS; i++) {
			volatile float rounded = (float)signature->rows[n][i];
			if ((double)rounded != signature->rows[n][i])
				fail_msg("number %d of class %d is %.17g, not a float", i, n, signature->rows[n][i]);
		}
	eskel_signature_free(signature);
}

static void an_encoded_signature_decodes_to_the_same_numbers(void **state)
{
	(void)state;
	const uint32_t levels[] = {1, 2, 16, 64};
	for (int n = 0; n < 4; n++) {
		eskel_signature *signature = synthetic_signature(1, (uint64_t)n, 0.1, levels[n]), *decoded = NULL;
		uint8_t *bytes = NULL;
		size_t size = 0;
		assert_int_equal(eskel_signature_encode(signature, &bytes, &size), ESKEL_OK);
		assert_int_equal(size, 10 + 20 * ESKEL_NODES(levels[n]));
		assert_int_equal(eskel_signature_decode(bytes, size, &decoded, NULL), ESKEL_OK);
		assert_int_equal(decoded->level_count, levels[n]);
		assert_true(decoded->volume == signature->volume);
		assert_memory_equal(decoded->rows, signature->rows, ESKEL_NODES(levels[n]) * sizeof *signature->rows);
		free(bytes);
		eskel_signature_free(decoded);
		eskel_signature_free(signature);
	}
}

static void bytes_that_no_encode_made_are_refused(void **state)
{
	(void)state;
	static const double broken_numbers[] = {-1, NAN, INFINITY, 1e11};
	eskel_signature *signature = synthetic_signature(1, 2, 0.1, 3), *decoded = NULL;
	uint8_t *bytes = NULL;
	size_t size = 0;
	eskel_error error;
	assert_int_equal(eskel_signature_encode(signature, &bytes, &size), ESKEL_OK);
	for (size_t shorter = 0; shorter < size; shorter++)
		assert_int_equal(eskel_signature_decode(bytes, shorter, &decoded, &error), ESKEL_TRUNCATED);
	bytes[0] = 2;
	assert_int_equal(eskel_signature_decode(bytes, size, &decoded, &error), ESKEL_MALFORMED);
	assert_string_equal(error.text, "a signature has version 2, expected 1");
	bytes[0] = 1;
	bytes[1] = 65;
	assert_int_equal(eskel_signature_decode(bytes, size, &decoded, &error), ESKEL_MALFORMED);
	bytes[1] = 0;
	assert_int_equal(eskel_signature_decode(bytes, size, &decoded, &error), ESKEL_MALFORMED);
	bytes[1] = 2;
	assert_int_equal(eskel_signature_decode(bytes, size, &decoded, &error), ESKEL_MALFORMED);
	bytes[1] = 3;
	for (int n = 0; n < 4; n++) {
		float number = (float)broken_numbers[n];
		uint8_t kept[4];
		memcpy(kept, bytes + 30, 4);
		memcpy(bytes + 30, &number, 4);
		assert_int_equal(eskel_signature_decode(bytes, size, &decoded, &error), ESKEL_MALFORMED);
		assert_int_equal(error.status, ESKEL_MALFORMED);
		memcpy(bytes + 30, kept, 4);
	}
	memset(bytes + 2, 0, 8);
	assert_int_equal(eskel_signature_decode(bytes, size, &decoded, &error), ESKEL_MALFORMED);
	assert_null(decoded);
	free(bytes);
	eskel_signature_free(signature);
}

static void nothing_is_freed_without_harm(void **state)
{
	(void)state;
	eskel_signature_free(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_solid_ellipsoid_has_solidity_one),
		cmocka_unit_test(a_class_has_the_solidity_of_its_share_of_the_volume),
		cmocka_unit_test(flat_and_single_voxel_classes_have_the_greatest_solidity),
		cmocka_unit_test(the_numbers_of_a_signature_are_floats),
		cmocka_unit_test(an_encoded_signature_decodes_to_the_same_numbers),
		cmocka_unit_test(bytes_that_no_encode_made_are_refused),
		cmocka_unit_test(nothing_is_freed_without_harm),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
