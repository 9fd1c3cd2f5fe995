#include "natural_frame.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = ESK_PLACED_CLASSES_MAX, ROOT = 3 /* the row where the square root of the covariance starts */ };

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
static void act_on_roots(const double q[3][3], double action[6][6])
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			int s = (r + 1) % 3, t = (r + 2) % 3, d = (c + 1) % 3, e = (c + 2) % 3;
			action[r][c] = q[r][c] * q[r][c];
			action[r][3 + c] = sqrt2 * (q[r][d] * q[r][e]);
			action[3 + r][c] = sqrt2 * (q[s][c] * q[t][c]);
			action[3 + r][3 + c] = q[s][d] * q[t][e] + q[s][e] * q[t][d];
		}
}

static void move_centres(const double q[3][3], double (*at)[COLUMNS])
{
	for (int j = 0; j < COLUMNS; j++) {
		double x = at[0][j], y = at[1][j], z = at[2][j];
		for (int r = 0; r < 3; r++)
			at[r][j] = q[r][0] * x + q[r][1] * y + q[r][2] * z;
	}
}

static void move_roots(const double q[3][3], double (*at)[COLUMNS])
{
	double action[6][6], out[6][COLUMNS];
	act_on_roots(q, action);
	for (int r = 0; r < 6; r++)
		for (int j = 0; j < COLUMNS; j++) {
			double sum = 0;
			for (int c = 0; c < 6; c++)
				sum += action[r][c] * at[c][j];
			out[r][j] = sum;
		}
	memcpy(at, out, sizeof out);
}

void esk_placed_move(const double orthogonal[3][3], esk_placed_level *placed)
{
	move_centres(orthogonal, &placed->at[0]);
	move_roots(orthogonal, &placed->at[ROOT]);
}
