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

/* A symmetric 4x4 matrix a lane: its upper triangle, row by row. Entry (r, c) is at place[r][c]. */
enum { ENTRIES = 10 };
static const int place[4][4] = {{0, 1, 2, 3}, {1, 4, 5, 6}, {2, 5, 7, 8}, {3, 6, 8, 9}};

/* N + shift I. The eigenvalues of N are +-s_1 +-s_2 +-s_3 in the singular values of h, so shift = sqrt(3) |h|, which
 * is at least their sum, makes it positive. The projector on (1, 0, 0, 0), the identity's quaternion, when h is 0. */
ESK_IN_LANES void horn_matrix(const esk_lanes h[3][3], esk_lanes n[ENTRIES])
{
	ESK_EACH_LANE (l) {
		double xx = h[0][0][l], xy = h[0][1][l], xz = h[0][2][l];
		double yx = h[1][0][l], yy = h[1][1][l], yz = h[1][2][l];
		double zx = h[2][0][l], zy = h[2][1][l], zz = h[2][2][l];
		double squares =
			xx * xx + xy * xy + xz * xz + yx * yx + yy * yy + yz * yz + zx * zx + zy * zy + zz * zz;
		double shift = sqrt(3 * squares);
		n[0][l] = squares > 0 ? xx + yy + zz + shift : 1;
		n[1][l] = zy - yz;
		n[2][l] = xz - zx;
		n[3][l] = yx - xy;
		n[4][l] = xx - yy - zz + shift;
		n[5][l] = xy + yx;
		n[6][l] = zx + xz;
		n[7][l] = yy - xx - zz + shift;
		n[8][l] = yz + zy;
		n[9][l] = zz - xx - yy + shift;
	}
}

/* out = n n, which is symmetric as n is. */
ESK_IN_LANES void square(const esk_lanes n[ENTRIES], esk_lanes out[ENTRIES])
{
	ESK_EACH_LANE (l) {
		double a = n[0][l], b = n[1][l], c = n[2][l], d = n[3][l], e = n[4][l];
		double f = n[5][l], g = n[6][l], h = n[7][l], i = n[8][l], j = n[9][l];
		out[0][l] = a * a + b * b + c * c + d * d;
		out[1][l] = a * b + b * e + c * f + d * g;
		out[2][l] = a * c + b * f + c * h + d * i;
		out[3][l] = a * d + b * g + c * i + d * j;
		out[4][l] = b * b + e * e + f * f + g * g;
		out[5][l] = b * c + e * f + f * h + g * i;
		out[6][l] = b * d + e * g + f * i + g * j;
		out[7][l] = c * c + f * f + h * h + i * i;
		out[8][l] = c * d + f * g + h * i + i * j;
		out[9][l] = d * d + g * g + i * i + j * j;
	}
}

/* Brings the traces to 1; the least of them before. */
ESK_IN_LANES double normalise(esk_lanes n[ENTRIES])
{
	esk_lanes trace;
	ESK_EACH_LANE (l) {
		trace[l] = n[0][l] + n[4][l] + n[7][l] + n[9][l];
		double factor = 1 / trace[l];
		for (int e = 0; e < ENTRIES; e++)
			n[e][l] *= factor;
	}
	double least = trace[0];
	for (int l = 1; l < ESK_LANES; l++)
		least = trace[l] < least ? trace[l] : least;
	return least;
}

/* Squares twice. The trace of a matrix of trace 1 becomes 1 if it is a projector on a line only, and is never less than
 * 1/64, so it need not be brought back to 1 in between. */
ESK_IN_LANES void squeeze_to_projector(esk_lanes n[ENTRIES])
{
	esk_lanes between[ENTRIES];
	normalise(n);
	for (int i = 0; i < SQUARINGS_MAX; i += 2) {
		square((const esk_lanes *)n, between);
		square((const esk_lanes *)between, n);
		if (normalise(n) > 1 - 0x1p-50)
			break;
	}
}

/* Any column that is not 0 is the eigenvector: the one of greatest diagonal entry, whose square length that is. */
ESK_IN_LANES void unit_column(const esk_lanes n[ENTRIES], esk_lanes q[4])
{
	esk_lanes greatest;
	for (int r = 0; r < 4; r++)
		memcpy(q[r], n[place[0][r]], sizeof q[r]);
	memcpy(greatest, n[0], sizeof greatest);
	for (int c = 1; c < 4; c++)
		ESK_EACH_LANE (l) {
			double diagonal = n[place[c][c]][l];
			bool greater = diagonal > greatest[l];
			greatest[l] = greater ? diagonal : greatest[l];
			for (int r = 0; r < 4; r++)
				q[r][l] = greater ? n[place[c][r]][l] : q[r][l];
		}
	ESK_EACH_LANE (l) {
		double length = sqrt(q[0][l] * q[0][l] + q[1][l] * q[1][l] + q[2][l] * q[2][l] + q[3][l] * q[3][l]);
		for (int r = 0; r < 4; r++)
			q[r][l] /= length;
	}
}

ESK_EVERY_WIDTH void esk_rotation_fit(const esk_lanes correlation[3][3], esk_lanes rotation[3][3])
{
	esk_lanes n[ENTRIES], q[4];
	horn_matrix(correlation, n);
	squeeze_to_projector(n);
	unit_column((const esk_lanes *)n, q);
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
