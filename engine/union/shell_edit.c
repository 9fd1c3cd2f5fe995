/* Changes of a shell: vertices move, edges flip, vertices are added. Each keeps all triangles counterclockwise around the
 * centre, or is not made. */
#include "shell_edit.h"

#include <string.h>

bool esk_shell_may_move(const esk_shell *shell, uint32_t v, const int32_t key[3])
{
	const uint32_t first = shell->leaving[v];
	uint32_t h = first;
	do {
		const uint32_t next = esk_shell_next(h);
		if (esk_keys_orient(key, shell->keys[esk_shell_start(shell, next)],
			    shell->keys[esk_shell_end(shell, next)]) <= 0)
			return false;
		h = esk_shell_turn(shell, h);
	} while (h != first);
	return true;
}

/* ---- flips */

bool esk_shell_may_flip(const esk_shell *shell, uint32_t h)
{
	const uint32_t g = esk_shell_twin(shell, h);
	const uint32_t a = esk_shell_start(shell, h), b = esk_shell_start(shell, g);
	const uint32_t c = esk_shell_start(shell, esk_shell_previous(h)),
		       d = esk_shell_start(shell, esk_shell_previous(g));
	return shell->marks[h] == ESK_FREE && esk_shell_orient(shell, c, a, d) > 0 &&
	       esk_shell_orient(shell, d, b, c) > 0;
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
void esk_shell_flip(esk_shell *shell, uint32_t h)
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

/* The angles opposite to the edge are more than two right ones together (Delaunay). */
static bool is_better_flipped(const esk_shell *shell, uint32_t h)
{
	const uint32_t g = esk_shell_twin(shell, h);
	const double *a = shell->points[esk_shell_start(shell, h)], *b = shell->points[esk_shell_start(shell, g)];
	const double *c = shell->points[esk_shell_start(shell, esk_shell_previous(h))],
		     *d = shell->points[esk_shell_start(shell, esk_shell_previous(g))];
	double ca[3], cb[3], da[3], db[3], across[3];
	esk_triple_subtract(a, c, ca);
	esk_triple_subtract(b, c, cb);
	esk_triple_subtract(a, d, da);
	esk_triple_subtract(b, d, db);
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
	       esk_shell_may_flip(shell, h);
}

void esk_shell_improve(esk_shell *shell, uint32_t v)
{
	uint32_t h = shell->leaving[v], first = h;
	do {
		const uint32_t next = esk_shell_turn(shell, h);
		if (should_flip(shell, h)) {
			esk_shell_flip(shell, h);
			first = next;
		}
		h = next;
	} while (h != first);
}

/* Flips the edges opposite to a vertex for the better: each gives it an edge more. */
static void spread(esk_shell *shell, uint32_t v)
{
	enum { EDGES_MOST = 32 };
	uint32_t h = shell->leaving[v];
	const uint32_t first = h;
	int edges = 0, good = 0;
	do {
		edges++;
		h = esk_shell_turn(shell, h);
	} while (h != first);
	while (good < edges && edges < EDGES_MOST) {
		const uint32_t opposite = esk_shell_next(h);
		if (should_flip(shell, opposite)) {
			esk_shell_flip(shell, opposite);
			h = esk_shell_next(opposite); /* the same edge, in another place */
			edges++;
			good = 0;
		} else {
			h = esk_shell_turn(shell, h);
			good++;
		}
	}
}

/* ---- vertices */

void esk_shell_move(esk_shell *shell, uint32_t v, const double unit[3], const double point[3], const int32_t key[3])
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
	esk_shell_move(shell, v, unit, point, key);
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
			if (esk_keys_orient(shell->keys[esk_shell_start(shell, across)],
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
	double u[3];
	esk_triple_subtract(a, b, u);
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
		if (shell->seams[v] == ESK_NONE && (found == ESK_NONE || square < least) &&
			esk_shell_may_move(shell, v, key)) {
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
		esk_shell_move(shell, v, unit, point, key);
	else if (shell->vertex_count < shell->vertex_capacity)
		v = add(shell, *near, unit, point, key);
	else
		return false;
	shell->seams[v] = seam;
	spread(shell, v);
	*near = shell->leaving[v];
	return esk_shell_may_move(shell, v, key);
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
	if (!esk_shell_may_flip(shell, h))
		return false;
	esk_shell_flip(shell, h);
	return esk_shell_may_move(shell, v, key);
}
