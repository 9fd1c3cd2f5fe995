/* An ellipsoid as triangles: a mesh of the sphere whose vertices move, and whose edges flip, but which stays one.
 *
 * Triangles are half-edges, three of four numbers each: half-edge h starts at the vertex starts[h], and twins[h] is the
 * same edge in the next triangle. Around the centre all triangles are counterclockwise as seen from outside: that is judged
 * in the directions of their vertices, rounded to integers, so that it is exact. As long as it holds the triangles cover each
 * direction once, and the mesh, which lies star-shaped around the centre, does not intersect itself. */
#ifndef ESK_SHELL_H
#define ESK_SHELL_H

#include "ellipsoid.h"

#include <stdbool.h>

#define ESK_NONE UINT32_MAX

typedef enum { ESK_FREE, ESK_SEAM_KEPT, ESK_SEAM_DROPPED } esk_mark;

typedef struct {
	const esk_ellipsoid *ellipsoid;
	size_t vertex_count, vertex_capacity;
	double (*units)[3];  /* of length 1 but for rounding */
	double (*points)[3]; /* mm */
	int32_t (*keys)[3];  /* the unit, rounded to 2^-19: determinants of three are below 2^58 */
	uint32_t *seams;     /* the vertex of a seam that it is, ESK_NONE: none */
	uint32_t *leaving;   /* a half-edge that starts there */
	size_t triangle_count, triangle_capacity;
	uint32_t *starts, *twins;
	uint8_t *marks; /* esk_mark: whether a seam runs along a half-edge, and which becomes of its triangle */
} esk_shell;

static inline void esk_shell_round(const double unit[3], int32_t key[3])
{
	for (int a = 0; a < 3; a++)
		key[a] = (int32_t)floor(unit[a] * (1 << 19) + 0.5);
}

static inline uint32_t esk_shell_next(uint32_t h)
{
	return (h & 3) == 2 ? h - 2 : h + 1;
}

static inline uint32_t esk_shell_previous(uint32_t h)
{
	return (h & 3) == 0 ? h + 2 : h - 1;
}

static inline uint32_t esk_shell_start(const esk_shell *shell, uint32_t h)
{
	return shell->starts[h];
}

static inline uint32_t esk_shell_end(const esk_shell *shell, uint32_t h)
{
	return shell->starts[esk_shell_next(h)];
}

static inline uint32_t esk_shell_twin(const esk_shell *shell, uint32_t h)
{
	return shell->twins[h];
}

/* Around its start, counterclockwise. */
static inline uint32_t esk_shell_turn(const esk_shell *shell, uint32_t h)
{
	return esk_shell_twin(shell, esk_shell_previous(h));
}

/* No less triangles than a shell has at first, and not much more. */
double esk_shell_estimate(const esk_ellipsoid *ellipsoid, double step);
/* Rings around the longest axis, with edges of about a step; shorter where the ellipsoid bends more; with room for more
 * vertices. False when memory ran out. The estimate is less than 2^28. */
bool esk_shell_make(const esk_ellipsoid *ellipsoid, double step, size_t room, esk_shell *shell);
void esk_shell_clear(esk_shell *shell);

/* Lays a vertex of a seam into the shell, near a half-edge, and gives one that starts there. False where it cannot. */
bool esk_shell_place(esk_shell *shell, uint32_t seam, const double point[3], uint32_t *near);
/* Makes an edge between two vertices, marked: the triangle to its left is kept or dropped, the one to its right not. */
bool esk_shell_join(esk_shell *shell, uint32_t from, uint32_t to, bool keep_left);
/* Improves the angles around these vertices, of which those of seams stay where they are, and the rest leave other ellipsoids. */
void esk_shell_relax(esk_shell *shell, size_t count, const uint32_t *vertices, const esk_ellipsoid *const *others,
	size_t other_count);
/* Divides an edge that is not marked. False where it cannot. */
bool esk_shell_divide(esk_shell *shell, uint32_t h);

#endif
