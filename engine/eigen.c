/* Cyclic Jacobi rotations: the classic method for a matrix this small, accurate for small eigenvalues too.
 *
 * Why not LAPACK's dsyev: its last bits depend on the BLAS behind it, and OpenBLAS picks kernels by processor (the
 * same binary gave three different answers on five processor types), while the same cloud must give the same
 * skeleton on every machine. These few dozen operations have one order and one rounding. The tests use dsyev as the
 * oracle. */
#include "eigen.h"

#include <math.h>
#include <string.h>

/* Matrices come from affines rounded to float, so relative differences of 2^-24 mean nothing; some room on top. */
static const double equal_values = 1e-6;
/* A congruence in doubles leaves this much of lambda_1 where a flat cloud has an eigenvalue 0. */
static const double noise = 0x1p-44;

enum { SWEEPS_MAX = 40 }; /* convergence is quadratic: 4 to 7 sweeps are usual */

/* The rotation of rows and columns p and q that annihilates a[p][q]; the rows of v follow. */
static void rotate(double a[3][3], double v[3][3], int p, int q)
{
	double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
	double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1));
	double c = 1 / sqrt(t * t + 1), s = t * c;
	int r = 3 - p - q; /* the third index */
	a[p][p] -= t * a[p][q];
	a[q][q] += t * a[p][q];
	a[p][q] = a[q][p] = 0;
	double rp = a[r][p], rq = a[r][q];
	a[r][p] = a[p][r] = c * rp - s * rq;
	a[r][q] = a[q][r] = s * rp + c * rq;
	for (int i = 0; i < 3; i++) {
		double vp = v[p][i], vq = v[q][i];
		v[p][i] = c * vp - s * vq;
		v[q][i] = s * vp + c * vq;
	}
}

/* An entry that cannot change either diagonal entry any more is 0. */
static bool is_negligible(const double a[3][3], int p, int q)
{
	double tiny = fabs(a[p][q]) * 0x1p-10;
	return fabs(a[p][p]) + tiny == fabs(a[p][p]) && fabs(a[q][q]) + tiny == fabs(a[q][q]);
}

static bool diagonalise(double a[3][3], double v[3][3])
{
	for (int sweep = 0; sweep < SWEEPS_MAX; sweep++) {
		bool rotated = false;
		for (int p = 0; p < 2; p++)
			for (int q = p + 1; q < 3; q++) {
				if (is_negligible((const double(*)[3])a, p, q)) {
					a[p][q] = a[q][p] = 0;
					continue;
				}
				rotate(a, v, p, q);
				rotated = true;
			}
		if (!rotated)
			return true;
	}
	return false;
}

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalise(double v[3])
{
	double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
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
		cross(axes[2], axes[0], axes[1]);
	} else if (last_two)
		axis_in_plane(axes[0], axes[1]);
	fix_sign(axes[0]);
	fix_sign(axes[1]);
	cross(axes[0], axes[1], axes[2]);
}

eskel_status esk_eigen_symmetric(const double matrix[3][3], esk_eigen *eigen)
{
	double a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	for (int r = 0; r < 3; r++)
		for (int c = r; c < 3; c++) {
			if (!isfinite(matrix[r][c]))
				return ESKEL_NUMERIC;
			a[r][c] = a[c][r] = matrix[r][c];
		}
	if (!diagonalise(a, v))
		return ESKEL_NUMERIC;

	int order[3] = {0, 1, 2}; /* stable: equal values keep the order of the coordinate axes */
	for (int i = 1; i < 3; i++)
		for (int j = i; j > 0 && a[order[j]][order[j]] > a[order[j - 1]][order[j - 1]]; j--) {
			int swap = order[j];
			order[j] = order[j - 1];
			order[j - 1] = swap;
		}
	double greatest = a[order[0]][order[0]];
	for (int i = 0; i < 3; i++) {
		double value = a[order[i]][order[i]];
		eigen->values[i] = value > noise * greatest ? value : 0;
		memcpy(eigen->axes[i], v[order[i]], sizeof v[0]);
	}
	choose_axes(eigen);
	return ESKEL_OK;
}

bool esk_eigen_is_degenerate(const esk_eigen *eigen)
{
	return are_equal(eigen, 0, 1);
}
