/* Overlap of shapes as mixtures of normal densities.
 *
 * A class of share w, centre g and covariance M is the density w N(g, SPREAD M + BLUR^2 I), a shape their sum f. The
 * integral over space of N(g, A) N(g', B) is the value at g - g' of N(0, A + B), so with S = A + B and d = g - g'
 *     integral of f_a f_b = (2 pi)^(-3/2) sum_ij w_i w'_j exp(-d^T S^-1 d / 2) / sqrt(det S).
 * The constant factor is left out. No class is paired with another one: partitions of like shapes may differ as they
 * like, as long as together their classes cover the same matter. */
#include "overlap.h"

#include "elementary.h"

#include <math.h>
#include <string.h>

/* Wide enough for the sum to be a smooth shape, not a heap of ellipsoids. Nothing hangs on the exact values: spreads of 1
 * and 2, and blurs (in cube roots of the volume) of 0.05 and 0.15, tell sides about as well. */
static const double spread = 1.5, blur = 0.1;
/* Twice the exponent of a term that does not count any more. */
static const double far = 1000;

typedef struct {
	esk_lanes xx, yy, zz, yz, zx, xy;
} covariances;

/* Half of S, from the square root R of M: SPREAD R R + BLUR^2 I. The coordinates of R off the diagonal are times sqrt 2. */
ESK_IN_LANES void widen(const esk_posed_level *posed, uint32_t j, covariances *m)
{
	ESK_EACH_LANE (l) {
		double xx = posed->at[3][j][l], yy = posed->at[4][j][l], zz = posed->at[5][j][l];
		double yz = posed->at[6][j][l], zx = posed->at[7][j][l], xy = posed->at[8][j][l];
		const double half = spread / 2, half_root = spread * 0.70710678118654752, least = blur * blur;
		m->xx[l] = spread * (xx * xx) + half * (xy * xy + zx * zx) + least;
		m->yy[l] = spread * (yy * yy) + half * (xy * xy + yz * yz) + least;
		m->zz[l] = spread * (zz * zz) + half * (zx * zx + yz * yz) + least;
		m->yz[l] = half_root * (yz * (yy + zz)) + half * (xy * zx);
		m->zx[l] = half_root * (zx * (zz + xx)) + half * (xy * yz);
		m->xy[l] = half_root * (xy * (xx + yy)) + half * (zx * yz);
	}
}

/* d^T adj(S) d / det S = d^T S^-1 d. */
ESK_IN_LANES double term(double x, double y, double z, double xx, double yy, double zz, double yz, double zx, double xy)
{
	double c_xx = yy * zz - yz * yz, c_yy = zz * xx - zx * zx, c_zz = xx * yy - xy * xy;
	double c_yz = zx * xy - yz * xx, c_zx = xy * yz - zx * yy, c_xy = yz * zx - xy * zz;
	double determinant = xx * c_xx + xy * c_xy + zx * c_zx;
	double square = x * x * c_xx + y * y * c_yy + z * z * c_zz + 2 * (y * z * c_yz + z * x * c_zx + x * y * c_xy);
	square /= determinant;
	return esk_elementary_exp_double(-0.5 * (square < far ? square : far)) / sqrt(determinant);
}

/* Classes of b as they lie, and how wide. */
typedef struct {
	esk_posed_level posed;
	covariances wide[ESK_PLACED_CLASSES_MAX];
} mixture;

ESK_EVERY_WIDTH static void make_mixture(
	const esk_placed_class *classes, uint32_t count, const esk_lanes orthogonal[3][3], mixture *made)
{
	esk_placed_pose(classes, count, orthogonal, &made->posed);
	for (uint32_t j = 0; j < count; j++)
		widen(&made->posed, j, &made->wide[j]);
}

ESK_EVERY_WIDTH static void add_terms(const esk_placed_class *a, const mixture *of_a, const esk_placed_class *b,
	const mixture *of_b, uint32_t count, double overlaps[ESK_LANES])
{
	esk_lanes sum = {0};
	for (uint32_t i = 0; i < count; i++) {
		const covariances *m = &of_a->wide[i];
		for (uint32_t j = 0; j < count; j++) {
			const covariances *n = &of_b->wide[j];
			double shares = a[i].share * b[j].share;
			ESK_EACH_LANE (l)
				sum[l] +=
					shares * term(of_b->posed.at[0][j][l] - of_a->posed.at[0][i][l],
							 of_b->posed.at[1][j][l] - of_a->posed.at[1][i][l],
							 of_b->posed.at[2][j][l] - of_a->posed.at[2][i][l],
							 m->xx[l] + n->xx[l], m->yy[l] + n->yy[l], m->zz[l] + n->zz[l],
							 m->yz[l] + n->yz[l], m->zx[l] + n->zx[l], m->xy[l] + n->xy[l]);
		}
	}
	memcpy(overlaps, sum, sizeof sum);
}

void esk_overlap_find(const esk_placed_class *a, const esk_placed_class *b, uint32_t count,
	const esk_lanes orthogonal[3][3], double overlaps[ESK_LANES])
{
	esk_lanes identity[3][3] = {{{0}}};
	mixture of_a, of_b;
	for (int r = 0; r < 3; r++)
		for (int l = 0; l < ESK_LANES; l++)
			identity[r][r][l] = 1;
	make_mixture(a, count, (const esk_lanes(*)[3])identity, &of_a);
	make_mixture(b, count, orthogonal, &of_b);
	add_terms(a, &of_a, b, &of_b, count, overlaps);
}
