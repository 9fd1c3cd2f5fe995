#include "natural_frame.h"

#include <math.h>

enum { ROOT = 3 /* the row where the square root of the covariance starts */ };

static const double sqrt2 = 1.4142135623730951;

static void multiply(const double matrix[3][3], const double v[3], double out[3])
{
	for (int r = 0; r < 3; r++)
		out[r] = matrix[r][0] * v[0] + matrix[r][1] * v[1] + matrix[r][2] * v[2];
}

static void place_centre(const eskel_node *node, const eskel_node *whole, double size, esk_placed_level *placed)
{
	double from_whole[3], centre[3];
	for (int i = 0; i < 3; i++)
		from_whole[i] = (node->centre[i] - whole->centre[i]) / size;
	multiply(whole->axes, from_whole, centre);
	for (int i = 0; i < 3; i++)
		placed->at[i][node->class_index] = centre[i];
}

/* sqrt(M) = sum sqrt(lambda_i) u_i u_i^T over the class's axes u_i. */
static void place_root(const eskel_node *node, const eskel_node *whole, double size, esk_placed_level *placed)
{
	uint32_t column = node->class_index;
	for (int i = 0; i < 3; i++) {
		double u[3], length = sqrt(node->eigenvalues[i]) / size;
		multiply(whole->axes, node->axes[i], u);
		for (int r = 0; r < 3; r++) {
			placed->at[ROOT + r][column] += length * (u[r] * u[r]);
			placed->at[ROOT + 3 + r][column] += sqrt2 * length * (u[(r + 1) % 3] * u[(r + 2) % 3]);
		}
	}
}

void esk_natural_frame_place(const eskel_skeleton *skeleton, uint32_t level, esk_placed_level *placed)
{
	const eskel_node *whole = &skeleton->nodes[0], *nodes = &skeleton->nodes[ESKEL_NODES(level - 1)];
	double size = cbrt(skeleton->volume);
	*placed = (esk_placed_level){.count = level};
	for (uint32_t c = 0; c < level; c++) {
		place_centre(&nodes[c], whole, size, placed);
		place_root(&nodes[c], whole, size, placed);
		placed->share[c] = nodes[c].weight / skeleton->weight;
	}
}

/* The action of q on the six coordinates of a symmetric matrix, S to q S q^T, is an orthogonal 6x6 matrix too. */
static inline void act_on_roots(const esk_lanes q[3][3], esk_lanes action[6][6])
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
	const esk_placed_level *placed, const esk_lanes orthogonal[3][3], esk_posed_level *posed)
{
	esk_lanes action[6][6];
	act_on_roots(orthogonal, action);
	posed->count = placed->count;
	for (uint32_t j = 0; j < placed->count; j++) {
		double v[ESK_PLACED_COORDINATES];
		for (int c = 0; c < ESK_PLACED_COORDINATES; c++)
			v[c] = placed->at[c][j];
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
