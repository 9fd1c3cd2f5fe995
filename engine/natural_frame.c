#include "natural_frame.h"

#include <math.h>
#include <string.h>

enum { ROOT = 3 /* where the square root of the covariance starts */ };

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

/* sqrt(M) = sum sqrt(lambda_i) u_i u_i^T over the class's axes u_i. */
static void place_root(const eskel_node *node, const eskel_node *whole, double size, double root[6])
{
	for (int i = 0; i < 3; i++) {
		double u[3], length = sqrt(node->eigenvalues[i]) / size;
		multiply(whole->axes, node->axes[i], u);
		for (int r = 0; r < 3; r++) {
			root[r] += length * (u[r] * u[r]);
			root[3 + r] += sqrt2 * length * (u[(r + 1) % 3] * u[(r + 2) % 3]);
		}
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
