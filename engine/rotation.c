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
#include <stdbool.h>
#include <string.h>

/* 32 squarings part eigenvalues whose relative gap is 1e-8; closer ones give rotations that are as good. */
enum { SQUARINGS_MAX = 32 };

/* N + shift I. The eigenvalues of N are +-s_1 +-s_2 +-s_3 in the singular values of h, so shift = sqrt(3) |h|, which
 * is at least their sum, makes it positive. The projector on (1, 0, 0, 0), the identity's quaternion, when h is 0. */
static inline void horn_matrix(const esk_lanes h[3][3], esk_lanes n[4][4])
{
	ESK_EACH_LANE (l) {
		double xx = h[0][0][l], xy = h[0][1][l], xz = h[0][2][l];
		double yx = h[1][0][l], yy = h[1][1][l], yz = h[1][2][l];
		double zx = h[2][0][l], zy = h[2][1][l], zz = h[2][2][l];
		double squares =
			xx * xx + xy * xy + xz * xz + yx * yx + yy * yy + yz * yz + zx * zx + zy * zy + zz * zz;
		double shift = sqrt(3 * squares);
		n[0][0][l] = squares > 0 ? xx + yy + zz + shift : 1;
		n[1][1][l] = xx - yy - zz + shift;
		n[2][2][l] = yy - xx - zz + shift;
		n[3][3][l] = zz - xx - yy + shift;
		n[0][1][l] = n[1][0][l] = zy - yz;
		n[0][2][l] = n[2][0][l] = xz - zx;
		n[0][3][l] = n[3][0][l] = yx - xy;
		n[1][2][l] = n[2][1][l] = xy + yx;
		n[1][3][l] = n[3][1][l] = zx + xz;
		n[2][3][l] = n[3][2][l] = yz + zy;
	}
}

/* out = n n, which is symmetric as n is. */
static inline void square(const esk_lanes n[4][4], esk_lanes out[4][4])
{
	for (int r = 0; r < 4; r++)
		for (int c = r; c < 4; c++)
			ESK_EACH_LANE (l)
				out[r][c][l] = out[c][r][l] = n[r][0][l] * n[0][c][l] + n[r][1][l] * n[1][c][l] +
							      n[r][2][l] * n[2][c][l] + n[r][3][l] * n[3][c][l];
}

/* Brings the traces to 1; the least of them before. */
static inline double normalise(esk_lanes n[4][4])
{
	esk_lanes trace, factor;
	ESK_EACH_LANE (l) {
		trace[l] = n[0][0][l] + n[1][1][l] + n[2][2][l] + n[3][3][l];
		factor[l] = 1 / trace[l];
	}
	for (int r = 0; r < 4; r++)
		for (int c = 0; c < 4; c++)
			ESK_EACH_LANE (l)
				n[r][c][l] *= factor[l];
	double least = trace[0];
	for (int l = 1; l < ESK_LANES; l++)
		least = trace[l] < least ? trace[l] : least;
	return least;
}

/* Squares twice. The trace of a matrix of trace 1 becomes 1 if it is a projector on a line only, and is never less than
 * 1/64, so it need not be brought back to 1 in between. */
static inline void squeeze_to_projector(esk_lanes n[4][4])
{
	esk_lanes between[4][4];
	normalise(n);
	for (int i = 0; i < SQUARINGS_MAX; i += 2) {
		square((const esk_lanes(*)[4])n, between);
		square((const esk_lanes(*)[4])between, n);
		if (normalise(n) > 1 - 0x1p-50)
			break;
	}
}

/* Any column that is not 0 is the eigenvector: the one of greatest diagonal entry, whose square length that is. */
static inline void unit_column(const esk_lanes n[4][4], esk_lanes q[4])
{
	esk_lanes greatest;
	memcpy(q, n[0], 4 * sizeof q[0]);
	memcpy(greatest, n[0][0], sizeof greatest);
	for (int c = 1; c < 4; c++)
		ESK_EACH_LANE (l) {
			bool greater = n[c][c][l] > greatest[l];
			greatest[l] = greater ? n[c][c][l] : greatest[l];
			for (int r = 0; r < 4; r++)
				q[r][l] = greater ? n[c][r][l] : q[r][l];
		}
	ESK_EACH_LANE (l) {
		double length = sqrt(q[0][l] * q[0][l] + q[1][l] * q[1][l] + q[2][l] * q[2][l] + q[3][l] * q[3][l]);
		for (int r = 0; r < 4; r++)
			q[r][l] /= length;
	}
}

ESK_EVERY_WIDTH void esk_rotation_fit(const esk_lanes correlation[3][3], esk_lanes rotation[3][3])
{
	esk_lanes n[4][4], q[4];
	horn_matrix(correlation, n);
	squeeze_to_projector(n);
	unit_column((const esk_lanes(*)[4])n, q);
	ESK_EACH_LANE (l) {
		double w = q[0][l], x = q[1][l], y = q[2][l], z = q[3][l];
		rotation[0][0][l] = 1 - 2 * (y * y + z * z);
		rotation[0][1][l] = 2 * (x * y - w * z);
		rotation[0][2][l] = 2 * (x * z + w * y);
		rotation[1][0][l] = 2 * (x * y + w * z);
		rotation[1][1][l] = 1 - 2 * (x * x + z * z);
		rotation[1][2][l] = 2 * (y * z - w * x);
		rotation[2][0][l] = 2 * (x * z - w * y);
		rotation[2][1][l] = 2 * (y * z + w * x);
		rotation[2][2][l] = 1 - 2 * (x * x + y * y);
	}
}
