/* The rotation that superposes matched points best in the least-squares sense. */
#ifndef ESK_ROTATION_H
#define ESK_ROTATION_H

#include "lanes.h"

/* In each lane by itself: correlation = sum w_i a_i b_i^T. Writes the proper rotation R that minimises
 * sum w_i |a_i - R b_i|^2, one of them where several do (points on a line, mirror images); the identity when the
 * correlation is 0. */
void esk_rotation_fit(const esk_lanes correlation[3][3], esk_lanes rotation[3][3]);

#endif
