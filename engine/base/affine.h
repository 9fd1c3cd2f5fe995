/* Small fixed-size linear algebra of the voxel-to-world map. */
#ifndef ESK_AFFINE_H
#define ESK_AFFINE_H

#include "eskel.h"

void esk_affine_apply(const eskel_affine *affine, const double index[3], double world[3]);

/* out = L C L^T with L the linear part: a covariance of index coordinates brought to world space (mm^2). The sum runs
 * in a fixed order and the result is exactly symmetric. out may be covariance. */
void esk_affine_congruence(const eskel_affine *affine, const double covariance[3][3], double out[3][3]);

#endif
