#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "elementary.h"
#include "overlap.h"
#include "skeletons.h"
#include "synthetic.h"

#include <math.h>
#include <string.h>

enum { class_count = 3 };

/* As overlap.c has them. */
static const double spread = 1.5, blur = 0.1;

typedef struct {
	double share, centre[3], covariance[3][3];
} ellipsoid;

/* Classes by axes and lengths, and the same as the engine places them: the square root has the same axes. */
static void make_classes(uint64_t seed, ellipsoid *known, esk_placed_class *placed)
{
	for (int c = 0; c < class_count; c++) {
		double axes[3][3];
		memset(&known[c], 0, sizeof known[c]);
		memset(&placed[c], 0, sizeof placed[c]);
		known[c].share = placed[c].share = (c + 1) / 6.0;
		skeletons_rotation(&seed, axes);
		for (int i = 0; i < 3; i++) {
			double length = 0.05 + 0.25 * synthetic_uniform(&seed);
			known[c].centre[i] = placed[c].at[i] = 0.8 * synthetic_uniform(&seed) - 0.4;
			for (int r = 0; r < 3; r++) {
				for (int s = 0; s < 3; s++)
					known[c].covariance[r][s] += length * length * axes[i][r] * axes[i][s];
				placed[c].at[3 + r] += length * axes[i][r] * axes[i][r];
				placed[c].at[6 + r] += sqrt(2) * length * axes[i][(r + 1) % 3] * axes[i][(r + 2) % 3];
			}
		}
	}
}

static void move(const double m[3][3], const ellipsoid *from, ellipsoid *to)
{
	*to = (ellipsoid){.share = from->share};
	for (int r = 0; r < 3; r++)
		for (int s = 0; s < 3; s++) {
			to->centre[r] += m[r][s] * from->centre[s];
			for (int i = 0; i < 3; i++)
				for (int j = 0; j < 3; j++)
					to->covariance[r][s] += m[r][i] * from->covariance[i][j] * m[s][j];
		}
}

/* By the Cholesky factor L of the widened covariance: |L^-1 d|^2 by forward substitution, sqrt(det) = L11 L22 L33. */
static double density_at(const ellipsoid *e, const double x[3])
{
	double l[3][3] = {{0}}, y[3], square = 0, root = 1;
	for (int r = 0; r < 3; r++) {
		y[r] = x[r] - e->centre[r];
		for (int c = 0; c <= r; c++) {
			double rest = spread * e->covariance[r][c] + (r == c ? blur * blur : 0);
			for (int i = 0; i < c; i++)
				rest -= l[r][i] * l[c][i];
			l[r][c] = r == c ? sqrt(rest) : rest / l[c][c];
		}
		for (int i = 0; i < r; i++)
			y[r] -= l[r][i] * y[i];
		y[r] /= l[r][r];
		square += y[r] * y[r];
		root *= l[r][r];
	}
	return e->share * exp(-square / 2) / root / pow(2 * M_PI, 1.5);
}

static double mixture_at(const ellipsoid *classes, const double x[3])
{
	double sum = 0;
	for (int c = 0; c < class_count; c++)
		sum += density_at(&classes[c], x);
	return sum;
}

/* A sum over a grid: densities this smooth are integrated to 1e-8 by steps of 0.08. */
static double integral(const ellipsoid *a, const ellipsoid *b)
{
	const int half = 25;
	const double step = 0.08;
	double sum = 0;
	for (int z = -half; z <= half; z++)
		for (int y = -half; y <= half; y++)
			for (int x = -half; x <= half; x++) {
				const double at[3] = {x * step, y * step, z * step};
				sum += mixture_at(a, at) * mixture_at(b, at);
			}
	return sum * step * step * step;
}

static void overlaps_are_integrals_of_products_of_densities(void **state)
{
	(void)state;
	uint64_t random = 1;
	ellipsoid a[class_count], b[class_count], moved[class_count];
	esk_placed_class placed_a[class_count], placed_b[class_count];
	double moves[ESK_LANES][3][3], overlaps[ESK_LANES];
	esk_lanes orthogonal[3][3];
	make_classes(1, a, placed_a);
	make_classes(2, b, placed_b);
	for (int l = 0; l < ESK_LANES; l++) {
		skeletons_rotation(&random, moves[l]);
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++) {
				moves[l][r][c] *= l % 2 && r == 0 ? -1 : 1; /* a reflection */
				orthogonal[r][c][l] = moves[l][r][c];
			}
	}
	esk_overlap_find(placed_a, placed_b, class_count, (const esk_lanes(*)[3])orthogonal, overlaps);
	for (int l = 0; l < ESK_LANES; l++) {
		for (int c = 0; c < class_count; c++)
			move((const double(*)[3])moves[l], &b[c], &moved[c]);
		double expected = integral(a, moved), found = overlaps[l] / pow(2 * M_PI, 1.5);
		if (!(fabs(found - expected) <= 1e-6 * expected))
			fail_msg("lane %d: %.12g, expected %.12g", l, found, expected);
	}
}

static void swapping_the_shapes_and_inverting_the_pose_changes_nothing(void **state)
{
	(void)state;
	uint64_t random = 5;
	ellipsoid known[class_count];
	esk_placed_class a[class_count], b[class_count];
	double ab[ESK_LANES], ba[ESK_LANES];
	esk_lanes there[3][3], back[3][3];
	make_classes(3, known, a);
	make_classes(4, known, b);
	for (int l = 0; l < ESK_LANES; l++) {
		double rotation[3][3];
		skeletons_rotation(&random, rotation);
		for (int e = 0; e < 9; e++)
			there[e / 3][e % 3][l] = back[e % 3][e / 3][l] = rotation[e / 3][e % 3];
	}
	esk_overlap_find(a, b, class_count, (const esk_lanes(*)[3])there, ab);
	esk_overlap_find(b, a, class_count, (const esk_lanes(*)[3])back, ba);
	for (int l = 0; l < ESK_LANES; l++)
		assert_true(fabs(ab[l] - ba[l]) <= 1e-12 * ab[l]);
}

static void the_exponential_is_that_of_the_c_library(void **state)
{
	(void)state;
	uint64_t random = 6;
	for (int n = 0; n < 100000; n++) {
		double x = (2 * synthetic_uniform(&random) - 1) * (n % 2 ? 1 : 699), expected = exp(x);
		double found = esk_elementary_exp_double(x);
		if (!(fabs(found - expected) <= 1e-14 * expected))
			fail_msg("exp %.17g is %.17g, expected %.17g", x, found, expected);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(overlaps_are_integrals_of_products_of_densities),
		cmocka_unit_test(swapping_the_shapes_and_inverting_the_pose_changes_nothing),
		cmocka_unit_test(the_exponential_is_that_of_the_c_library),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
