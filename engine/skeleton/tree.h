/* The skeleton as a data structure (section 2.5): K levels, level k with k nodes. */
#ifndef ESK_TREE_H
#define ESK_TREE_H

#include "eskel.h"

/* Zeroed, with room for its levels and nodes. */
eskel_status esk_tree_new(uint32_t level_count, eskel_skeleton **skeleton);

/* Fills in what follows from the rest. Given are metric, coarse_start, volume, the levels, and of every node voxels,
 * weight, centre and covariance. ESKEL_NUMERIC when a result is not finite. */
eskel_status esk_tree_derive(eskel_skeleton *skeleton);

#endif
