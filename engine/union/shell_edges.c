/* Edges along seams: what they cross is flipped until nothing is left (Sloan, "A fast algorithm for generating constrained
 * Delaunay triangulations", 1993). Edges of seams are not: then the edge is refused. */
#include "shell_edit.h"

static uint32_t find_edge(const esk_shell *shell, uint32_t from, uint32_t to)
{
	const uint32_t first = shell->leaving[from];
	uint32_t h = first;
	do {
		if (esk_shell_end(shell, h) == to)
			return h;
		h = esk_shell_turn(shell, h);
	} while (h != first);
	return ESK_NONE;
}

/* Away from the line that it lies on: towards the middle of its neighbours on one side. */
static bool nudge(esk_shell *shell, uint32_t v)
{
	double middle[3] = {0, 0, 0}, unit[3], point[3];
	int32_t key[3];
	const uint32_t first = shell->leaving[v];
	uint32_t h = first;
	for (int side = 0; side < 3; side++, h = esk_shell_turn(shell, h))
		for (int i = 0; i < 3; i++)
			middle[i] += shell->units[esk_shell_end(shell, h)][i] / 3;
	for (double part = 0.25; part > 0.01; part /= 2) {
		for (int i = 0; i < 3; i++)
			unit[i] = shell->units[v][i] + part * (middle[i] - shell->units[v][i]);
		const double length = esk_triple_length(unit);
		for (int i = 0; i < 3; i++)
			unit[i] /= length;
		esk_shell_round(unit, key);
		if (esk_shell_may_move(shell, v, key)) {
			esk_ellipsoid_point(shell->ellipsoid, unit, point);
			esk_shell_move(shell, v, unit, point, key);
			return true;
		}
	}
	return false;
}

/* The first edge that the line from a vertex to another one crosses. ESK_NONE with through set: it passes through that vertex. */
static uint32_t find_crossed(const esk_shell *shell, uint32_t from, uint32_t to, uint32_t *through)
{
	const uint32_t first = shell->leaving[from];
	uint32_t h = first;
	*through = ESK_NONE;
	do {
		const uint32_t across = esk_shell_next(h), b = esk_shell_start(shell, across),
			       c = esk_shell_end(shell, across);
		const int64_t left = esk_shell_orient(shell, from, b, to), right = esk_shell_orient(shell, from, to, c);
		/* Ahead, not behind. */
		const bool ahead =
			esk_triple_dot(shell->units[to], shell->units[b]) > 0 && esk_shell_orient(shell, b, c, to) < 0;
		if (left == 0 && right > 0 && ahead) {
			*through = b;
			return ESK_NONE;
		}
		if (left > 0 && right > 0)
			return across;
		h = esk_shell_turn(shell, h);
	} while (h != first);
	return ESK_NONE;
}

enum { CROSSED_MOST = 64 };

/* The ends of the edges that the line crosses, in order. */
static int list_crossed(const esk_shell *shell, uint32_t from, uint32_t to, uint32_t (*edges)[2], uint32_t *through)
{
	int count = 0;
	uint32_t h = find_crossed(shell, from, to, through);
	while (h != ESK_NONE && count < CROSSED_MOST) {
		edges[count][0] = esk_shell_start(shell, h);
		edges[count++][1] = esk_shell_end(shell, h);
		const uint32_t g = esk_shell_twin(shell, h), apex = esk_shell_start(shell, esk_shell_previous(g));
		if (apex == to)
			return count;
		const int64_t side = esk_shell_orient(shell, from, to, apex);
		if (side == 0) {
			*through = apex;
			return 0;
		}
		/* h runs from the right of the line to the left, and so does the edge by which it leaves the next triangle. */
		h = side > 0 ? esk_shell_next(g) : esk_shell_previous(g);
	}
	return 0;
}

static bool crosses(const esk_shell *shell, uint32_t from, uint32_t to, uint32_t c, uint32_t d)
{
	if (c == from || c == to || d == from || d == to)
		return false;
	return (esk_shell_orient(shell, from, to, c) > 0) != (esk_shell_orient(shell, from, to, d) > 0);
}

/* Flips the edges that the line crosses until none is left (Sloan 1993). */
static bool flip_crossed(esk_shell *shell, uint32_t from, uint32_t to, uint32_t (*edges)[2], int count)
{
	int first = 0;
	for (int tries = 0; count > 0; tries++) {
		if (tries == 4 * CROSSED_MOST)
			return false;
		const uint32_t *edge = edges[first];
		uint32_t h = find_edge(shell, edge[0], edge[1]);
		if (h == ESK_NONE || shell->marks[h] != ESK_FREE)
			return false;
		const bool flipped = esk_shell_may_flip(shell, h);
		if (flipped)
			esk_shell_flip(shell, h);
		const uint32_t ends[2] = {esk_shell_start(shell, h), esk_shell_end(shell, h)};
		first = (first + 1) % CROSSED_MOST;
		count--;
		if (crosses(shell, from, to, ends[0], ends[1])) {
			uint32_t *last = edges[(first + count++) % CROSSED_MOST];
			last[0] = ends[0];
			last[1] = ends[1];
		}
	}
	return true;
}

static uint32_t make_edge(esk_shell *shell, uint32_t from, uint32_t to)
{
	uint32_t edges[CROSSED_MOST][2];
	for (int tries = 0; tries < 8; tries++) {
		uint32_t through;
		const uint32_t h = find_edge(shell, from, to);
		if (h != ESK_NONE)
			return h;
		const int count = list_crossed(shell, from, to, edges, &through);
		if (through != ESK_NONE) {
			if (shell->seams[through] != ESK_NONE || !nudge(shell, through))
				return ESK_NONE;
		} else if (count == 0 || !flip_crossed(shell, from, to, edges, count)) {
			return ESK_NONE;
		}
	}
	return ESK_NONE;
}

bool esk_shell_join(esk_shell *shell, uint32_t from, uint32_t to, bool keep_left)
{
	const uint32_t h = make_edge(shell, from, to);
	if (h == ESK_NONE || shell->marks[h] != ESK_FREE)
		return false;
	shell->marks[h] = keep_left ? ESK_SEAM_KEPT : ESK_SEAM_DROPPED;
	shell->marks[esk_shell_twin(shell, h)] = keep_left ? ESK_SEAM_DROPPED : ESK_SEAM_KEPT;
	return true;
}
