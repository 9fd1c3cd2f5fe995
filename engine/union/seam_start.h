/* Where two ellipsoids meet: a point of each curve that they have in common. */
#ifndef ESK_SEAM_START_H
#define ESK_SEAM_START_H

#include "ellipsoid.h"

#include <stdbool.h>

enum { ESK_STARTS_MOST = 6 };

/* The potential of b on the surface of a lies between these; they are met if it has both signs. */
typedef struct {
	double least, greatest;
	int count;
	double points[ESK_STARTS_MOST][3]; /* on a, and close to b: some on the same curve */
} esk_seam_starts;

/* False where a number is not finite. */
bool esk_seam_find(const esk_ellipsoid *a, const esk_ellipsoid *b, esk_seam_starts *starts);

#endif
