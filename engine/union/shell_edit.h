/* Changes of a shell: vertices move, edges flip. Each keeps all triangles counterclockwise around the centre, if it may be
 * made. */
#ifndef ESK_SHELL_EDIT_H
#define ESK_SHELL_EDIT_H

#include "shell.h"

/* Positive where a, b and c are counterclockwise around the centre. Exact: keys are of 20 bits. */
static inline int64_t esk_keys_orient(const int32_t a[3], const int32_t b[3], const int32_t c[3])
{
	const int64_t x = (int64_t)b[1] * c[2] - (int64_t)b[2] * c[1], y = (int64_t)b[2] * c[0] - (int64_t)b[0] * c[2],
		      z = (int64_t)b[0] * c[1] - (int64_t)b[1] * c[0];
	return a[0] * x + a[1] * y + a[2] * z;
}

static inline int64_t esk_shell_orient(const esk_shell *shell, uint32_t a, uint32_t b, uint32_t c)
{
	return esk_keys_orient(shell->keys[a], shell->keys[b], shell->keys[c]);
}

/* Whether all triangles around a vertex stay counterclockwise when it moves. */
bool esk_shell_may_move(const esk_shell *shell, uint32_t vertex, const int32_t key[3]);
void esk_shell_move(
	esk_shell *shell, uint32_t vertex, const double unit[3], const double point[3], const int32_t key[3]);
/* Whether the edge is not marked, and the other diagonal leaves both triangles counterclockwise. */
bool esk_shell_may_flip(const esk_shell *shell, uint32_t h);
/* The edge from a to b becomes that from d to c: h starts in the corner that was opposite to its twin. */
void esk_shell_flip(esk_shell *shell, uint32_t h);
/* Flips edges of a vertex for the better. */
void esk_shell_improve(esk_shell *shell, uint32_t vertex);

#endif
