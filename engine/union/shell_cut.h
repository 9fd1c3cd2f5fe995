/* A shell cut along the creases of a union: which of its triangles lie on the union's surface. */
#ifndef ESK_SHELL_CUT_H
#define ESK_SHELL_CUT_H

#include "seams.h"
#include "shell.h"

typedef enum { ESK_UNKNOWN, ESK_KEPT, ESK_DROPPED } esk_fate;

/* No edge of a kept triangle, but along creases, joins two vertices of creases. */
typedef struct {
	esk_shell shell;
	uint8_t *fates; /* of triangles */
} esk_cut;

/* Of the s-th of so many ellipsoids. ESKEL_NUMERIC where creases are so close to one another that their edges cross. */
eskel_status esk_cut_make(
	const esk_ellipsoid *ellipsoids, uint32_t count, uint32_t s, const esk_seams *seams, double step, esk_cut *cut);
void esk_cut_clear(esk_cut *cut);

#endif
