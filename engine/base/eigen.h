/* Eigenvalues and axes of a symmetric positive 3x3 matrix (section 2.2). */
#ifndef ESK_EIGEN_H
#define ESK_EIGEN_H

#include "eskel.h"

typedef struct {
	double values[3];  /* descending; a value that is only rounding noise, or negative, is 0 */
	double axes[3][3]; /* row i is the unit axis of values[i]; right-handed */
} esk_eigen;

/* Only the upper triangle is read. ESKEL_NUMERIC when an entry is not finite.
 *
 * Axes are lines, and equal values leave them undefined, so conventions decide: the component of greatest magnitude of
 * the first two axes is positive (the first one on a tie) and the third is their cross product; axes of a diagonal
 * matrix, and of three nearly equal values, are coordinate axes; of two nearly equal values one axis is a coordinate
 * axis projected onto their plane. */
eskel_status esk_eigen_symmetric(const double matrix[3][3], esk_eigen *eigen);

/* The major axis is undefined: the two greatest values are equal but for rounding. */
bool esk_eigen_is_degenerate(const esk_eigen *eigen);

#endif
