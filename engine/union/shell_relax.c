/* Vertices next to seams, which were laid without regard to them, move to where angles are better. */
#include "shell_edit.h"

/* The least, over the triangles around a vertex that lies at point, of the square of their area over that of their sides. */
static double find_worst(const esk_shell *shell, uint32_t v, const double point[3])
{
	double least = 1;
	const uint32_t first = shell->leaving[v];
	uint32_t h = first;
	do {
		const double *p = shell->points[esk_shell_end(shell, h)],
			     *q = shell->points[esk_shell_start(shell, esk_shell_previous(h))];
		double u[3], w[3], across[3];
		esk_triple_subtract(p, point, u);
		esk_triple_subtract(q, point, w);
		esk_triple_cross(u, w, across);
		const double sides = 2 * (esk_triple_dot(u, u) + esk_triple_dot(w, w) -
						 esk_triple_dot(u, w)); /* |u|^2 + |w|^2 + |u - w|^2 */
		const double shape = esk_triple_dot(across, across) / (sides * sides);
		least = shape < least ? shape : least;
		h = esk_shell_turn(shell, h);
	} while (h != first);
	return least;
}

static bool is_hidden(const double point[3], const esk_ellipsoid *const *others, size_t count)
{
	for (size_t k = 0; k < count; k++)
		if (esk_ellipsoid_value(others[k], point) < 0)
			return true;
	return false;
}

static void find_middle(const esk_shell *shell, uint32_t v, double unit[3], double point[3])
{
	double middle[3] = {0, 0, 0};
	const uint32_t first = shell->leaving[v];
	uint32_t h = first, count = 0;
	do {
		for (int i = 0; i < 3; i++)
			middle[i] += shell->points[esk_shell_end(shell, h)][i];
		count++;
		h = esk_shell_turn(shell, h);
	} while (h != first);
	for (int i = 0; i < 3; i++)
		middle[i] /= count;
	esk_ellipsoid_unit(shell->ellipsoid, middle, unit);
	const double length = esk_triple_length(unit);
	for (int i = 0; i < 3; i++)
		unit[i] /= length;
	esk_ellipsoid_point(shell->ellipsoid, unit, point);
}

/* To the middle of its neighbours, where that makes the worst triangle better; out of other ellipsoids, and into none. */
static void centre(esk_shell *shell, uint32_t v, const esk_ellipsoid *const *others, size_t count)
{
	double unit[3], point[3];
	int32_t key[3];
	find_middle(shell, v, unit, point);
	esk_shell_round(unit, key);
	if (!esk_shell_may_move(shell, v, key) || is_hidden(point, others, count))
		return;
	if (find_worst(shell, v, point) > find_worst(shell, v, shell->points[v]) ||
		is_hidden(shell->points[v], others, count))
		esk_shell_move(shell, v, unit, point, key);
}

void esk_shell_relax(esk_shell *shell, size_t count, const uint32_t *vertices, const esk_ellipsoid *const *others,
	size_t other_count)
{
	enum { ROUNDS = 2 };
	for (int round = 0; round < ROUNDS; round++)
		for (size_t i = 0; i < count; i++) {
			if (shell->seams[vertices[i]] == ESK_NONE)
				centre(shell, vertices[i], others, other_count);
			esk_shell_improve(shell, vertices[i]);
		}
}
