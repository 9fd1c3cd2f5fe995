/* Least-squares rotation by quaternions.
 *
 * Horn, "Closed-form solution of absolute orientation using unit quaternions" (JOSA A 4, 1987): sum w_i a_i . R b_i,
 * which is to be greatest, is the quadratic form q^T N q in the unit quaternion q of R, so q is the greatest
 * eigenvector of a symmetric 4x4 matrix N of trace 0. A quaternion is a proper rotation whatever it is: no sign of a
 * determinant has to be mended, as with a singular value decomposition, and flat or collinear points are no exception.
 *
 * The eigenvector comes from repeated squaring: a positive matrix of trace 1 tends to the projector on its greatest
 * eigenvector, or, when that one is not unique, on their space, in which every vector serves. Each squaring doubles the
 * accuracy, and sums and products in one order give the same bits on every machine. */
#include "rotation.h"

#include <math.h>
#include <string.h>

/* 32 squarings part eigenvalues whose relative gap is 1e-8; closer ones give rotations that are as good. */
enum { SQUARINGS_MAX = 32 };

/* N + shift I. The eigenvalues of N are +-s_1 +-s_2 +-s_3 in the singular values of h, so shift = sqrt(3) |h|, which
 * is at least their sum, makes it positive. */
static void horn_matrix(const double h[3][3], double shift, double n[4][4])
{
	double upper[4][4] = {
		{h[0][0] + h[1][1] + h[2][2], h[2][1] - h[1][2], h[0][2] - h[2][0], h[1][0] - h[0][1]},
		{0, h[0][0] - h[1][1] - h[2][2], h[0][1] + h[1][0], h[2][0] + h[0][2]},
		{0, 0, h[1][1] - h[0][0] - h[2][2], h[1][2] + h[2][1]},
		{0, 0, 0, h[2][2] - h[0][0] - h[1][1]},
	};
	for (int r = 0; r < 4; r++)
		for (int c = r; c < 4; c++)
			n[r][c] = n[c][r] = upper[r][c] + (r == c ? shift : 0);
}

static double trace(const double n[4][4])
{
	return n[0][0] + n[1][1] + n[2][2] + n[3][3];
}

static void square(double n[4][4])
{
	double out[4][4];
	for (int r = 0; r < 4; r++)
		for (int c = 0; c < 4; c++)
			out[r][c] = n[r][0] * n[0][c] + n[r][1] * n[1][c] + n[r][2] * n[2][c] + n[r][3] * n[3][c];
	memcpy(n, out, sizeof out);
}

static void scale(double n[4][4], double factor)
{
	for (int r = 0; r < 4; r++)
		for (int c = 0; c < 4; c++)
			n[r][c] *= factor;
}

/* The trace of the square of a matrix of trace 1 is 1 for a projector on a line only. */
static void squeeze_to_projector(double n[4][4])
{
	scale(n, 1 / trace((const double(*)[4])n));
	for (int i = 0; i < SQUARINGS_MAX; i++) {
		square(n);
		double t = trace((const double(*)[4])n);
		scale(n, 1 / t);
		if (t > 1 - 0x1p-50)
			break;
	}
}

/* Any column that is not 0 is the eigenvector: the one of greatest diagonal entry, whose square length that is. */
static void unit_column(const double n[4][4], double q[4])
{
	int c = 0;
	for (int i = 1; i < 4; i++)
		if (n[i][i] > n[c][c])
			c = i;
	double length = sqrt(n[0][c] * n[0][c] + n[1][c] * n[1][c] + n[2][c] * n[2][c] + n[3][c] * n[3][c]);
	for (int r = 0; r < 4; r++)
		q[r] = n[r][c] / length;
}

void esk_rotation_fit(const double correlation[3][3], double rotation[3][3])
{
	double squares = 0;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			squares += correlation[r][c] * correlation[r][c];
	double q[4] = {1, 0, 0, 0};
	if (squares > 0) {
		double n[4][4];
		horn_matrix(correlation, sqrt(3 * squares), n);
		squeeze_to_projector(n);
		unit_column((const double(*)[4])n, q);
	}
	double w = q[0], x = q[1], y = q[2], z = q[3];
	const double out[3][3] = {
		{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
		{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
		{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
	};
	memcpy(rotation, out, sizeof out);
}
