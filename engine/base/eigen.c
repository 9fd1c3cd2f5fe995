/* One Givens rotation makes the matrix tridiagonal, LAPACK's implicit QL/QR does the rest.
 *
 * Not dsyev, which does both: its reduction runs on the BLAS, and OpenBLAS picks kernels by processor (the same binary
 * gave three different last bits on five processor types), while the same cloud must give the same skeleton on every
 * machine. dsteqr is scalar arithmetic in one order. */
#include "eigen.h"

#include "triple.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

/* Matrices come from affines rounded to float, so relative differences of 2^-24 mean nothing; some room on top. */
static const double equal_values = 1e-6;
/* A congruence in doubles leaves this much of lambda_1 where a flat cloud has an eigenvalue 0. */
static const double noise = 0x1p-44;

/* The rotation G in the plane of axes 1 and 2 that annihilates a[0][2]: G A G^T has this diagonal and off-diagonal. The
 * columns of z are those of G^T, column by column. */
static void make_tridiagonal(const double a[3][3], double diagonal[3], double off[2], double z[9])
{
	double length = sqrt(a[0][1] * a[0][1] + a[0][2] * a[0][2]);
	double c = length > 0 ? a[0][1] / length : 1, s = length > 0 ? a[0][2] / length : 0;
	double difference = a[2][2] - a[1][1];
	diagonal[0] = a[0][0];
	diagonal[1] = c * c * a[1][1] + 2 * c * s * a[1][2] + s * s * a[2][2];
	diagonal[2] = s * s * a[1][1] - 2 * c * s * a[1][2] + c * c * a[2][2];
	off[0] = length;
	off[1] = c * s * difference + (c * c - s * s) * a[1][2];
	memcpy(z, (double[9]){1, 0, 0, 0, c, s, 0, -s, c}, 9 * sizeof *z);
}

static void normalise(double v[3])
{
	double length = esk_triple_length(v);
	for (int i = 0; i < 3; i++)
		v[i] /= length;
}

/* Positive where the magnitude is greatest. */
static void fix_sign(double v[3])
{
	int greatest = 0;
	for (int i = 1; i < 3; i++)
		if (fabs(v[i]) > fabs(v[greatest]))
			greatest = i;
	if (v[greatest] < 0)
		for (int i = 0; i < 3; i++)
			v[i] = -v[i];
}

/* The first coordinate axis that is well off n, projected onto the plane orthogonal to n. Some component of a unit
 * vector is at most 1/sqrt(3) = 0.577; 0.65 keeps clear of the values that symmetric shapes have (0.577, 0.6, 0.707). */
static void axis_in_plane(const double n[3], double out[3])
{
	int i = 0;
	while (i < 2 && fabs(n[i]) > 0.65)
		i++;
	for (int r = 0; r < 3; r++)
		out[r] = (r == i) - n[i] * n[r];
	normalise(out);
}

static bool are_equal(const esk_eigen *eigen, int i, int j)
{
	return eigen->values[i] - eigen->values[j] <= equal_values * eigen->values[0];
}

static void choose_axes(esk_eigen *eigen)
{
	double(*axes)[3] = eigen->axes;
	bool first_two = are_equal(eigen, 0, 1), last_two = are_equal(eigen, 1, 2);
	if (first_two && last_two)
		memcpy(axes, (double[3][3]){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, sizeof eigen->axes);
	else if (first_two) {
		axis_in_plane(axes[2], axes[0]);
		esk_triple_cross(axes[2], axes[0], axes[1]);
	} else if (last_two)
		axis_in_plane(axes[0], axes[1]);
	fix_sign(axes[0]);
	fix_sign(axes[1]);
	esk_triple_cross(axes[0], axes[1], axes[2]);
}

eskel_status esk_eigen_symmetric(const double matrix[3][3], esk_eigen *eigen)
{
	double a[3][3], values[3], off[2], z[9], work[4]; /* 2 (n - 1) */
	for (int r = 0; r < 3; r++)
		for (int c = r; c < 3; c++) {
			if (!isfinite(matrix[r][c]))
				return ESKEL_NUMERIC;
			a[r][c] = a[c][r] = matrix[r][c];
		}
	make_tridiagonal((const double(*)[3])a, values, off, z);
	if (LAPACKE_dsteqr_work(LAPACK_COL_MAJOR, 'V', 3, values, off, z, 3, work) != 0)
		return ESKEL_NUMERIC;
	for (int i = 0; i < 3; i++) { /* LAPACK's values ascend */
		eigen->values[i] = values[2 - i] > noise * values[2] ? values[2 - i] : 0;
		memcpy(eigen->axes[i], &z[3 * (2 - i)], sizeof eigen->axes[i]);
	}
	choose_axes(eigen);
	return ESKEL_OK;
}

bool esk_eigen_is_degenerate(const esk_eigen *eigen)
{
	return are_equal(eigen, 0, 1);
}
