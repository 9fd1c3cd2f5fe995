/* Skeletons brought to one size and pose, so that their classes can be compared by place (section 2.2). */
#ifndef ESK_NATURAL_FRAME_H
#define ESK_NATURAL_FRAME_H

#include "eskel.h"
#include "lanes.h"

/* Every class is an ellipsoid, and that is nine coordinates: the centre x, y, z and the square root of the covariance,
 * xx, yy, zz, and sqrt(2) times yz, zx, xy. The Euclidean distance of two such points,
 *     sqrt(|g - g'|^2 + |sqrt(M) - sqrt(M')|^2) with the Frobenius norm,
 * is the 2-Wasserstein distance of the ellipsoids, how far (root mean square) matter has to go to make one of the other,
 * if their axes are parallel, and somewhat more if not. */
enum { ESK_PLACED_COORDINATES = 9, ESK_PLACED_CLASSES_MAX = 16 };

/* A class of a shape of volume 1 whose centre is the origin. */
typedef struct {
	double at[ESK_PLACED_COORDINATES];
	double share; /* of the whole weight; those of a level sum to 1 */
} esk_placed_class;

/* Places the classes of a level in the axes of level 1, right-handed: one of the natural frames. The others differ from
 * it by a signed permutation of the axes. */
void esk_natural_frame_place(const eskel_skeleton *skeleton, uint32_t level, esk_placed_class *classes);

/* Places them in the same axes, stretched so that the variance along axis i becomes sqrt(variance) but for a common
 * factor, and the volume stays 1. */
eskel_status esk_natural_frame_place_stretched(
	const eskel_skeleton *skeleton, uint32_t level, esk_placed_class *classes);

/* The coordinates of a level in eight poses at once. */
typedef struct {
	esk_lanes at[ESK_PLACED_COORDINATES][ESK_PLACED_CLASSES_MAX]; /* those of the level's classes are set */
} esk_posed_level;

/* Moves a level of at most ESK_PLACED_CLASSES_MAX classes by an orthogonal matrix a lane. */
void esk_placed_pose(
	const esk_placed_class *classes, uint32_t count, const esk_lanes orthogonal[3][3], esk_posed_level *posed);

#endif
