/* The canonical voxel-to-world affine of an object: which signed permutation of the index axes its cloud uses. */
#ifndef ESK_ORIENTATION_H
#define ESK_ORIENTATION_H

#include "eskel.h"

/* Canonical index axis a is input axis axis[a], running backwards when reversed[a]. */
typedef struct {
	int axis[3];
	bool reversed[3];
} esk_orientation;

/* Rounds the linear part of a checked affine in place, then chooses the orientation nearest to RAS. */
void esk_orientation_choose(eskel_affine *affine, esk_orientation *orientation);

/* The canonical affine when the voxel at canonical index 0 has index origin[] along the input axes. */
eskel_affine esk_orientation_apply(
	const esk_orientation *orientation, const eskel_affine *affine, const double origin[3]);

/* Whether an affine is usable and its own canonical form. */
bool esk_orientation_is_canonical(const eskel_affine *affine);

#endif
