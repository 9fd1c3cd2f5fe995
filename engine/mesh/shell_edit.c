/* Changes of a shell: vertices move, edges flip, vertices are added. Each keeps all triangles counterclockwise around the
 * centre, or is not made. */
#include "shell.h"

#include <string.h>

/* ---- orientation */

/* Positive where a, b and c are counterclockwise around the centre. Exact: keys are of 20 bits. */
static int64_t orient(const int32_t a[3], const int32_t b[3], const int32_t c[3])
{
	const int64_t x = (int64_t)b[1] * c[2] - (int64_t)b[2] * c[1], y = (int64_t)b[2] * c[0] - (int64_t)b[0] * c[2],
		      z = (int64_t)b[0] * c[1] - (int64_t)b[1] * c[0];
	return a[0] * x + a[1] * y + a[2] * z;
}

static int64_t orient_vertices(const esk_shell *shell, uint32_t a, uint32_t b, uint32_t c)
{
	return orient(shell->keys[a], shell->keys[b], shell->keys[c]);
}

/* Whether all triangles around a vertex stay counterclockwise when it moves. */
static bool may_move(const esk_shell *shell, uint32_t v, const int32_t key[3])
{
	const uint32_t first = shell->leaving[v];
	uint32_t h = first;
	do {
		const uint32_t next = esk_shell_next(h);
		if (orient(key, shell->keys[esk_shell_start(shell, next)], shell->keys[esk_shell_end(shell, next)]) <=
			0)
			return false;
		h = esk_shell_turn(shell, h);
	} while (h != first);
	return true;
}

/* ---- flips */

/* Whether the other diagonal leaves both triangles counterclockwise. */
static bool may_flip(const esk_shell *shell, uint32_t h)
{
	const uint32_t g = esk_shell_twin(shell, h);
	const uint32_t a = esk_shell_start(shell, h), b = esk_shell_start(shell, g);
	const uint32_t c = esk_shell_start(shell, esk_shell_previous(h)),
		       d = esk_shell_start(shell, esk_shell_previous(g));
	return shell->marks[h] == ESK_FREE && orient_vertices(shell, c, a, d) > 0 &&
	       orient_vertices(shell, d, b, c) > 0;
}

static void put(esk_shell *shell, uint32_t h, uint32_t start, uint32_t twin, uint8_t mark)
{
	shell->starts[h] = start;
	shell->twins[h] = twin;
	shell->twins[twin] = h;
	shell->marks[h] = mark;
	shell->leaving[start] = h;
}

/* The edge ab of the triangles abc and bad becomes dc of cad and dbc. */
static void flip(esk_shell *shell, uint32_t h)
{
	const uint32_t g = esk_shell_twin(shell, h);
	const uint32_t hn = esk_shell_next(h), hp = esk_shell_previous(h), gn = esk_shell_next(g),
		       gp = esk_shell_previous(g);
	const uint32_t a = esk_shell_start(shell, h), b = esk_shell_start(shell, g), c = esk_shell_start(shell, hp),
		       d = esk_shell_start(shell, gp);
	const uint32_t *twins = shell->twins;
	const uint32_t ca = twins[hp], ad = twins[gn], db = twins[gp], bc = twins[hn];
	const uint8_t *marks = shell->marks;
	const uint8_t mark_ca = marks[hp], mark_ad = marks[gn], mark_db = marks[gp], mark_bc = marks[hn];
	shell->starts[h] = d;
	shell->starts[g] = c;
	put(shell, hn, c, ca, mark_ca);
	put(shell, hp, a, ad, mark_ad);
	put(shell, gn, d, db, mark_db);
	put(shell, gp, b, bc, mark_bc);
}

static void subtract(const double a[3], const double b[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] - b[i];
}

/* The angles opposite to the edge are more than two right ones together (Delaunay). */
static bool is_better_flipped(const esk_shell *shell, uint32_t h)
{
	const uint32_t g = esk_shell_twin(shell, h);
	const double *a = shell->points[esk_shell_start(shell, h)], *b = shell->points[esk_shell_start(shell, g)];
	const double *c = shell->points[esk_shell_start(shell, esk_shell_previous(h))],
		     *d = shell->points[esk_shell_start(shell, esk_shell_previous(g))];
	double ca[3], cb[3], da[3], db[3], across[3];
	subtract(a, c, ca);
	subtract(b, c, cb);
	subtract(a, d, da);
	subtract(b, d, db);
	const double cosine_c = esk_triple_dot(ca, cb), cosine_d = esk_triple_dot(da, db);
	if (cosine_c >= 0 && cosine_d >= 0)
		return false;
	esk_triple_cross(ca, cb, across);
	const double sine_c = esk_triple_length(across);
	esk_triple_cross(da, db, across);
	const double sine_d = esk_triple_length(across);
	/* The sine of the sum is negative; and so by more than rounding, or equal diagonals would flip for ever. */
	return sine_c * cosine_d + sine_d * cosine_c < -1e-9 * sine_c * sine_d;
}

/* Not to an edge between vertices of seams, which would cut a corner of the surface. */
static bool should_flip(const esk_shell *shell, uint32_t h)
{
	const uint32_t c = esk_shell_start(shell, esk_shell_previous(h)),
		       d = esk_shell_start(shell, esk_shell_previous(esk_shell_twin(shell, h)));
	return (shell->seams[c] == ESK_NONE || shell->seams[d] == ESK_NONE) && is_better_flipped(shell, h) &&
	       may_flip(shell, h);
}

/* Flips the edges of the triangles around a vertex for the better. */
static void improve(esk_shell *shell, uint32_t v)
{
	enum { DEEPEST = 8 };
	for (int round = 0; round < DEEPEST; round++) {
		bool changed = false;
		uint32_t h = shell->leaving[v], first = h;
		do {
			const uint32_t edges[2] = {h, esk_shell_next(h)};
			for (int k = 0; k < 2 && !changed; k++)
				if (should_flip(shell, edges[k])) {
					flip(shell, edges[k]);
					changed = true;
				}
			h = esk_shell_turn(shell, h);
		} while (h != first && !changed);
		if (!changed)
			break;
	}
}

/* ---- vertices */

static void move(esk_shell *shell, uint32_t v, const double unit[3], const double point[3], const int32_t key[3])
{
	memcpy(shell->units[v], unit, sizeof shell->units[v]);
	memcpy(shell->points[v], point, sizeof shell->points[v]);
	memcpy(shell->keys[v], key, sizeof shell->keys[v]);
}

/* In the triangle of h; the triangles around it may be flat. */
static uint32_t add(esk_shell *shell, uint32_t h, const double unit[3], const double point[3], const int32_t key[3])
{
	const uint32_t v = (uint32_t)shell->vertex_count++, t = (uint32_t)(4 * shell->triangle_count);
	const uint32_t hn = esk_shell_next(h), hp = esk_shell_previous(h);
	const uint32_t a = esk_shell_start(shell, h), b = esk_shell_start(shell, hn), c = esk_shell_start(shell, hp);
	const uint32_t bc = esk_shell_twin(shell, hn), ca = esk_shell_twin(shell, hp);
	const uint8_t mark_bc = shell->marks[hn], mark_ca = shell->marks[hp];
	shell->triangle_count += 2;
	shell->seams[v] = ESK_NONE;
	move(shell, v, unit, point, key);
	/* b c v and c a v */
	put(shell, t, b, bc, mark_bc);
	put(shell, t + 4, c, ca, mark_ca);
	put(shell, t + 1, c, t + 6, ESK_FREE);
	put(shell, t + 6, v, t + 1, ESK_FREE);
	put(shell, t + 2, v, hn, ESK_FREE);
	put(shell, hn, b, t + 2, ESK_FREE);
	put(shell, t + 5, a, hp, ESK_FREE);
	put(shell, hp, v, t + 5, ESK_FREE);
	shell->leaving[a] = h;
	return v;
}

/* The triangle, by a half-edge, that a direction lies in, from one near it. */
static bool locate(const esk_shell *shell, const int32_t key[3], uint32_t *near)
{
	uint32_t h = *near;
	for (size_t steps = 0; steps < 2 * shell->triangle_count; steps++) {
		uint32_t across = h;
		int inside = 0;
		for (; inside < 3; inside++, across = esk_shell_next(across))
			if (orient(shell->keys[esk_shell_start(shell, across)],
				    shell->keys[esk_shell_end(shell, across)], key) < 0)
				break;
		if (inside == 3) {
			*near = h;
			return true;
		}
		/* On from the edge after the one that it came by, so that it does not turn in circles. */
		h = esk_shell_next(esk_shell_twin(shell, across));
	}
	return false;
}

static double square_between(const double a[3], const double b[3])
{
	const double u[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
	return esk_triple_dot(u, u);
}

/* The nearest corner of a triangle that may move there. */
static uint32_t find_movable(const esk_shell *shell, uint32_t h, const int32_t key[3], const double point[3])
{
	uint32_t found = ESK_NONE;
	double least = 0;
	for (int k = 0; k < 3; k++, h = esk_shell_next(h)) {
		const uint32_t v = esk_shell_start(shell, h);
		const double square = square_between(shell->points[v], point);
		if (shell->seams[v] == ESK_NONE && (found == ESK_NONE || square < least) && may_move(shell, v, key)) {
			found = v;
			least = square;
		}
	}
	return found;
}

bool esk_shell_place(esk_shell *shell, uint32_t seam, const double point[3], uint32_t *near)
{
	double unit[3];
	int32_t key[3];
	esk_ellipsoid_unit(shell->ellipsoid, point, unit);
	esk_shell_round(unit, key);
	if (!locate(shell, key, near))
		return false;
	uint32_t v = find_movable(shell, *near, key, point);
	if (v != ESK_NONE)
		move(shell, v, unit, point, key);
	else if (shell->vertex_count < shell->vertex_capacity)
		v = add(shell, *near, unit, point, key);
	else
		return false;
	shell->seams[v] = seam;
	improve(shell, v);
	*near = shell->leaving[v];
	return may_move(shell, v, key);
}

bool esk_shell_divide(esk_shell *shell, uint32_t h)
{
	double unit[3], point[3];
	int32_t key[3];
	const double *a = shell->units[esk_shell_start(shell, h)], *b = shell->units[esk_shell_end(shell, h)];
	for (int i = 0; i < 3; i++)
		unit[i] = a[i] + b[i];
	const double length = esk_triple_length(unit);
	if (!(length > 0) || shell->vertex_count == shell->vertex_capacity)
		return false;
	for (int i = 0; i < 3; i++)
		unit[i] /= length;
	esk_ellipsoid_point(shell->ellipsoid, unit, point);
	esk_shell_round(unit, key);
	const uint32_t v = add(shell, h, unit, point, key);
	/* h is still the edge; the new vertex is opposite to it. */
	if (!may_flip(shell, h))
		return false;
	flip(shell, h);
	return may_move(shell, v, key);
}

/* ---- edges */

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
		if (may_move(shell, v, key)) {
			esk_ellipsoid_point(shell->ellipsoid, unit, point);
			move(shell, v, unit, point, key);
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
		const int64_t left = orient_vertices(shell, from, b, to), right = orient_vertices(shell, from, to, c);
		/* Ahead, not behind. */
		const bool ahead =
			esk_triple_dot(shell->units[to], shell->units[b]) > 0 && orient_vertices(shell, b, c, to) < 0;
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
		const int64_t side = orient_vertices(shell, from, to, apex);
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
	return (orient_vertices(shell, from, to, c) > 0) != (orient_vertices(shell, from, to, d) > 0);
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
		const bool flipped = may_flip(shell, h);
		if (flipped)
			flip(shell, h);
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

/* ---- angles */

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
		for (int i = 0; i < 3; i++) {
			u[i] = p[i] - point[i];
			w[i] = q[i] - point[i];
		}
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
	if (!may_move(shell, v, key) || is_hidden(point, others, count))
		return;
	if (find_worst(shell, v, point) > find_worst(shell, v, shell->points[v]) ||
		is_hidden(shell->points[v], others, count))
		move(shell, v, unit, point, key);
}

void esk_shell_relax(esk_shell *shell, size_t count, const uint32_t *vertices, const esk_ellipsoid *const *others,
	size_t other_count)
{
	enum { ROUNDS = 2 };
	for (int round = 0; round < ROUNDS; round++)
		for (size_t i = 0; i < count; i++) {
			if (shell->seams[vertices[i]] == ESK_NONE)
				centre(shell, vertices[i], others, other_count);
			improve(shell, vertices[i]);
		}
}
