#include "shell.h"

#include "elementary.h"
#include "memory.h"

#include <stdlib.h>
#include <string.h>

enum {
	SPANS = 64, /* of a table around the axis, and along it */
	LEAST_RINGS = 6,
	LEAST_SIDES = 6,
};

static const double turn_most = 0.7; /* radians between the normals at the ends of an edge */
/* Of an equilateral triangle with sides of 1: the root of 3, halved. */
static const double triangle_height = 0.8660254037844386;
static const double tau = 6.28318530717958647693;

/* Where a share of all edges ends along an arc: the cosine and sine of the angle, for shares of 1 / SPANS. */
typedef struct {
	double at[SPANS + 1][2];
	double total; /* edges */
} scale;

/* Of edges up to each of the angles of equal spans, the shares. */
static void invert(const double *edges, const double (*angles)[2], scale *s)
{
	int from = 0;
	s->total = edges[SPANS];
	for (int i = 0; i <= SPANS; i++) {
		const double sought = s->total * i / SPANS;
		while (from < SPANS - 1 && edges[from + 1] < sought)
			from++;
		const double part = (sought - edges[from]) / (edges[from + 1] - edges[from]);
		for (int k = 0; k < 2; k++)
			s->at[i][k] = angles[from][k] + part * (angles[from + 1][k] - angles[from][k]);
	}
}

static void look_up(const scale *s, double share, double at[2])
{
	const double place = share * SPANS;
	const int span = place < SPANS - 1 ? (int)place : SPANS - 1;
	double length = 0;
	for (int k = 0; k < 2; k++) {
		at[k] = s->at[span][k] + (place - span) * (s->at[span + 1][k] - s->at[span][k]);
		length += at[k] * at[k];
	}
	length = sqrt(length);
	at[0] /= length;
	at[1] /= length;
}

/* Along a meridian: rings are as far apart as the triangles of an edge are high, and no further than turn_most. */
static void scale_meridian(const double radii[3], double step, scale *s)
{
	const double wide = radii[0] > radii[1] ? radii[0] : radii[1], height = triangle_height * step;
	double angles[SPANS + 1][2], edges[SPANS + 1], before = 0;
	for (int i = 0; i <= SPANS; i++) {
		esk_elementary_sine_cosine(tau / 2 * i / SPANS, &angles[i][1], &angles[i][0]);
		const double square =
			wide * wide * angles[i][0] * angles[i][0] + radii[2] * radii[2] * angles[i][1] * angles[i][1];
		const double by_length = sqrt(square) / height, by_turn = wide * radii[2] / square / turn_most;
		const double density = by_length > by_turn ? by_length : by_turn;
		edges[i] = i ? edges[i - 1] + (density + before) / 2 * (tau / 2 / SPANS) : 0;
		before = density;
	}
	invert(edges, (const double(*)[2])angles, s);
}

/* Around the axis: by length, mm, but that of the narrow ends counts as a third of that of the wide sides at least. */
static void scale_ring(const double radii[3], scale *s)
{
	const double wide = radii[0] > radii[1] ? radii[0] : radii[1];
	double angles[SPANS + 1][2], edges[SPANS + 1], before = 0;
	for (int i = 0; i <= SPANS; i++) {
		esk_elementary_sine_cosine(tau * i / SPANS, &angles[i][1], &angles[i][0]);
		const double x = radii[0] * angles[i][1], y = radii[1] * angles[i][0], length = sqrt(x * x + y * y);
		const double density = length > wide / 3 ? length : wide / 3;
		edges[i] = i ? edges[i - 1] + (density + before) / 2 * (tau / SPANS) : 0;
		before = density;
	}
	invert(edges, (const double(*)[2])angles, s);
}

/* ---- vertices */

static uint32_t add_vertex(esk_shell *shell, const double unit[3])
{
	const size_t v = shell->vertex_count++;
	memcpy(shell->units[v], unit, sizeof shell->units[v]);
	esk_ellipsoid_point(shell->ellipsoid, unit, shell->points[v]);
	esk_shell_round(unit, shell->keys[v]);
	shell->seams[v] = ESK_NONE;
	return (uint32_t)v;
}

typedef struct {
	uint32_t first, sides;
	double phase; /* share of a side by which the first vertex is turned */
} ring;

/* Rings of vertices, the first and last of one each. */
static void add_ring(esk_shell *shell, const scale *around, const double at[2], ring *r)
{
	r->first = (uint32_t)shell->vertex_count;
	for (uint32_t i = 0; i < r->sides; i++) {
		double turn[2];
		look_up(around, (i + r->phase) / r->sides, turn);
		add_vertex(shell, (const double[3]){at[1] * turn[0], at[1] * turn[1], at[0]});
	}
}

/* ---- triangles */

static void link_edges(esk_shell *shell, uint32_t g, uint32_t h)
{
	shell->twins[g] = h;
	shell->twins[h] = g;
}

static uint32_t add_triangle(esk_shell *shell, uint32_t a, uint32_t b, uint32_t c)
{
	const uint32_t corners[3] = {a, b, c}, first = (uint32_t)(4 * shell->triangle_count++);
	memcpy(shell->starts + first, corners, sizeof corners);
	memset(shell->marks + first, ESK_FREE, 4);
	shell->leaving[a] = first;
	shell->leaving[b] = first + 1;
	shell->leaving[c] = first + 2;
	return first;
}

/* The strip between two rings, from the first vertex of both: the triangle follows at whose corner less of the turn is
 * done. upper: of each vertex of the ring above, the half-edge that comes to it from the next one, and lower likewise
 * for the ring below, the half-edge that leaves it. */
static void add_strip(esk_shell *shell, const ring *above, const ring *below, const uint32_t *upper, uint32_t *lower)
{
	uint32_t i = 0, j = 0, before = ESK_NONE, first = ESK_NONE;
	const uint32_t sides = above->sides > 1 ? above->sides : 0; /* a pole has none */
	while (i < sides || j < below->sides) {
		const uint32_t top = above->first + i % above->sides, bottom = below->first + j % below->sides;
		const double next_top = (i + 1 + above->phase) / above->sides,
			     next_bottom = (j + 1 + below->phase) / below->sides;
		uint32_t left, right, t;
		if (j == below->sides || (i < sides && next_top < next_bottom)) {
			t = add_triangle(shell, bottom, above->first + (i + 1) % above->sides, top);
			link_edges(shell, t + 1, upper[i++]);
			left = t + 2;
			right = t;
		} else {
			t = add_triangle(shell, bottom, below->first + (j + 1) % below->sides, top);
			lower[j++] = t;
			left = t + 2;
			right = t + 1;
		}
		if (before == ESK_NONE)
			first = left;
		else
			link_edges(shell, before, left);
		before = right;
	}
	link_edges(shell, before, first);
}

/* The last fan, around the other pole. */
static void add_fan(esk_shell *shell, const ring *above, uint32_t pole, const uint32_t *upper)
{
	uint32_t before = ESK_NONE, first = ESK_NONE;
	for (uint32_t i = 0; i < above->sides; i++) {
		const uint32_t t = add_triangle(shell, pole, above->first + (i + 1) % above->sides, above->first + i);
		link_edges(shell, t + 1, upper[i]);
		if (before == ESK_NONE)
			first = t + 2;
		else
			link_edges(shell, before, t + 2);
		before = t;
	}
	link_edges(shell, before, first);
}

/* ---- the whole */

static bool allocate(esk_shell *shell, size_t vertices)
{
	shell->vertex_capacity = vertices;
	shell->triangle_capacity = 2 * shell->vertex_capacity;
	shell->units = esk_memory_array(shell->vertex_capacity, sizeof *shell->units);
	shell->points = esk_memory_array(shell->vertex_capacity, sizeof *shell->points);
	shell->keys = esk_memory_array(shell->vertex_capacity, sizeof *shell->keys);
	shell->seams = esk_memory_array(shell->vertex_capacity, sizeof *shell->seams);
	shell->leaving = esk_memory_array(shell->vertex_capacity, sizeof *shell->leaving);
	shell->starts = esk_memory_array(shell->triangle_capacity, 4 * sizeof *shell->starts);
	shell->twins = esk_memory_array(shell->triangle_capacity, 4 * sizeof *shell->twins);
	shell->marks = esk_memory_array(shell->triangle_capacity, 4 * sizeof *shell->marks);
	return shell->units && shell->points && shell->keys && shell->seams && shell->leaving && shell->starts &&
	       shell->twins && shell->marks;
}

void esk_shell_clear(esk_shell *shell)
{
	free(shell->units);
	free(shell->points);
	free(shell->keys);
	free(shell->seams);
	free(shell->leaving);
	free(shell->starts);
	free(shell->twins);
	free(shell->marks);
	*shell = (esk_shell){0};
}

/* How many sides the ring at a share along the meridian has: its edges are as long as those along the meridian there. */
static uint32_t count_sides(const esk_ellipsoid *e, const scale *along, const scale *around, double step, uint32_t r,
	uint32_t spans, double at[2])
{
	const double wide = e->radii[0] > e->radii[1] ? e->radii[0] : e->radii[1];
	double next[2];
	look_up(along, (double)r / spans, at);
	look_up(along, (r + 1.0) / spans, next);
	const double x = wide * (next[1] - at[1]), z = e->radii[2] * (next[0] - at[0]);
	const double edge = sqrt(x * x + z * z) / triangle_height, longest = edge < step ? edge : step;
	const double by_length = at[1] * around->total / longest;
	/* Around the axis the normal turns by the circle that it describes. */
	const double across = at[1] / wide, ahead = at[0] / e->radii[2];
	const double by_turn = tau * across / sqrt(across * across + ahead * ahead) / turn_most;
	const double sides = by_length > by_turn ? by_length : by_turn;
	return sides > LEAST_SIDES ? (uint32_t)(sides + 0.5) : LEAST_SIDES;
}

/* As if all rings were as wide as the widest. */
double esk_shell_estimate(const esk_ellipsoid *e, double step)
{
	scale along, around;
	scale_meridian(e->radii, step, &along);
	scale_ring(e->radii, &around);
	return 2 * (along.total + LEAST_RINGS) * (around.total / step + LEAST_SIDES + tau / turn_most);
}

bool esk_shell_make(const esk_ellipsoid *e, double step, size_t room, esk_shell *shell)
{
	scale along, around;
	scale_meridian(e->radii, step, &along);
	scale_ring(e->radii, &around);
	const uint32_t spans = along.total > LEAST_RINGS ? (uint32_t)(along.total + 0.5) : LEAST_RINGS;
	ring *rings = esk_memory_array(spans + 1, sizeof *rings);
	double(*at)[2] = esk_memory_array(spans + 1, sizeof *at);
	size_t vertices = 2, widest = 0;
	bool good = rings && at;
	for (uint32_t r = 1; r < spans && good; r++) {
		rings[r].sides = count_sides(e, &along, &around, step, r, spans, at[r]);
		/* Half a side from ring to ring; and vertices lie in no plane of symmetry. */
		rings[r].phase = (r % 2 ? 0.5 : 0) + 0.137;
		vertices += rings[r].sides;
		widest = rings[r].sides > widest ? rings[r].sides : widest;
	}
	*shell = (esk_shell){.ellipsoid = e};
	uint32_t *upper = esk_memory_array(widest, sizeof *upper), *lower = esk_memory_array(widest, sizeof *lower);
	good = good && upper && lower && allocate(shell, vertices + room);
	if (good) {
		rings[0] = (ring){add_vertex(shell, (const double[3]){0, 0, 1}), 1, 0};
		for (uint32_t r = 1; r < spans; r++) {
			add_ring(shell, &around, at[r], &rings[r]);
			add_strip(shell, &rings[r - 1], &rings[r], upper, lower);
			uint32_t *swap = upper;
			upper = lower;
			lower = swap;
		}
		add_fan(shell, &rings[spans - 1], add_vertex(shell, (const double[3]){0, 0, -1}), upper);
	}
	free(rings);
	free(at);
	free(upper);
	free(lower);
	if (!good)
		esk_shell_clear(shell);
	return good;
}
