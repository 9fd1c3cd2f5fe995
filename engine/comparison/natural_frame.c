#include "natural_frame.h"

#include "eigen.h"

#include <math.h>
#include <string.h>

enum { ROOT = 3 /* where the square root of the covariance starts */ };

/* Variances below this share of the greatest one are stretched as if they were it: a flat shape has a variance of 0. The
 * fourth root of it is 1/32: no axis is stretched more than 32 times as much as another. */
static const double least_variance = 0x1p-20;

static const double sqrt2 = 1.4142135623730951;

static void multiply(const double matrix[3][3], const double v[3], double out[3])
{
	for (int r = 0; r < 3; r++)
		out[r] = matrix[r][0] * v[0] + matrix[r][1] * v[1] + matrix[r][2] * v[2];
}

static void place_centre(const eskel_node *node, const eskel_node *whole, double size, double centre[3])
{
	double from_whole[3];
	for (int i = 0; i < 3; i++)
		from_whole[i] = (node->centre[i] - whole->centre[i]) / size;
	multiply(whole->axes, from_whole, centre);
}

/* sqrt(M) = sum sqrt(lambda_i) u_i u_i^T over the class's axes u_i: one term. */
static void add_root(double length, const double u[3], double root[6])
{
	for (int r = 0; r < 3; r++) {
		root[r] += length * (u[r] * u[r]);
		root[3 + r] += sqrt2 * length * (u[(r + 1) % 3] * u[(r + 2) % 3]);
	}
}

static void place_root(const eskel_node *node, const eskel_node *whole, double size, double root[6])
{
	for (int i = 0; i < 3; i++) {
		double u[3];
		multiply(whole->axes, node->axes[i], u);
		add_root(sqrt(node->eigenvalues[i]) / size, u, root);
	}
}

void esk_natural_frame_place(const eskel_skeleton *skeleton, uint32_t level, esk_placed_class *classes)
{
	const eskel_node *whole = &skeleton->nodes[0], *nodes = &skeleton->nodes[ESKEL_NODES(level - 1)];
	double size = cbrt(skeleton->volume);
	for (uint32_t c = 0; c < level; c++) {
		classes[c] = (esk_placed_class){.share = nodes[c].weight / skeleton->weight};
		place_centre(&nodes[c], whole, size, classes[c].at);
		place_root(&nodes[c], whole, size, &classes[c].at[ROOT]);
	}
}

/* variance^(-1/4) of each axis over the geometric mean of the three. */
static void find_stretch(const eskel_node *whole, double stretch[3])
{
	double product = 1, least = least_variance * whole->eigenvalues[0];
	for (int i = 0; i < 3; i++) {
		double variance = fmax(whole->eigenvalues[i], least);
		stretch[i] = variance > 0 ? 1 / sqrt(sqrt(variance)) : 1;
		product *= stretch[i];
	}
	for (int i = 0; i < 3; i++)
		stretch[i] /= cbrt(product);
}

/* The covariance from its square root, stretched, and the square root of that. */
static eskel_status stretch_root(const double stretch[3], double root[6])
{
	const double s[3][3] = {{root[0], root[5] / sqrt2, root[4] / sqrt2},
		{root[5] / sqrt2, root[1], root[3] / sqrt2}, {root[4] / sqrt2, root[3] / sqrt2, root[2]}};
	double covariance[3][3];
	esk_eigen eigen;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			covariance[r][c] =
				(s[r][0] * s[0][c] + s[r][1] * s[1][c] + s[r][2] * s[2][c]) * stretch[r] * stretch[c];
	eskel_status status = esk_eigen_symmetric((const double(*)[3])covariance, &eigen);
	if (status)
		return status;
	memset(root, 0, 6 * sizeof *root);
	for (int i = 0; i < 3; i++)
		add_root(sqrt(eigen.values[i]), eigen.axes[i], root);
	return ESKEL_OK;
}

eskel_status esk_natural_frame_place_stretched(
	const eskel_skeleton *skeleton, uint32_t level, esk_placed_class *classes)
{
	double stretch[3];
	eskel_status status = ESKEL_OK;
	find_stretch(&skeleton->nodes[0], stretch);
	esk_natural_frame_place(skeleton, level, classes);
	for (uint32_t c = 0; !status && c < level; c++) {
		for (int i = 0; i < 3; i++)
			classes[c].at[i] *= stretch[i];
		status = stretch_root(stretch, &classes[c].at[ROOT]);
	}
	return status;
}

/* The action of q on the six coordinates of a symmetric matrix, S to q S q^T, is an orthogonal 6x6 matrix too. */
ESK_IN_LANES void act_on_roots(const esk_lanes q[3][3], esk_lanes action[6][6])
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			int s = (r + 1) % 3, t = (r + 2) % 3, d = (c + 1) % 3, e = (c + 2) % 3;
			ESK_EACH_LANE (l) {
				action[r][c][l] = q[r][c][l] * q[r][c][l];
				action[r][3 + c][l] = sqrt2 * (q[r][d][l] * q[r][e][l]);
				action[3 + r][c][l] = sqrt2 * (q[s][c][l] * q[t][c][l]);
				action[3 + r][3 + c][l] = q[s][d][l] * q[t][e][l] + q[s][e][l] * q[t][d][l];
			}
		}
}

ESK_EVERY_WIDTH void esk_placed_pose(
	const esk_placed_class *classes, uint32_t count, const esk_lanes orthogonal[3][3], esk_posed_level *posed)
{
	esk_lanes action[6][6];
	act_on_roots(orthogonal, action);
	for (uint32_t j = 0; j < count; j++) {
		double v[ESK_PLACED_COORDINATES];
		memcpy(v, classes[j].at, sizeof v);
		for (int r = 0; r < 3; r++)
			ESK_EACH_LANE (l)
				posed->at[r][j][l] = orthogonal[r][0][l] * v[0] + orthogonal[r][1][l] * v[1] +
						     orthogonal[r][2][l] * v[2];
		for (int r = 0; r < 6; r++)
			ESK_EACH_LANE (l)
				posed->at[ROOT + r][j][l] = action[r][0][l] * v[3] + action[r][1][l] * v[4] +
							    action[r][2][l] * v[5] + action[r][3][l] * v[6] +
							    action[r][4][l] * v[7] + action[r][5][l] * v[8];
	}
}
