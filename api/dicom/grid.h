/* The one grid that the frames of a segmentation lie in. */
#ifndef ESK_GRID_H
#define ESK_GRID_H

#include "segmentation.h"

/* Finds the extent, the affine (RAS) and the warnings, and gives each frame its place: of its first pixel, and its
 * slice. Frames of one segment in the same slice are refused. */
eskel_status esk_grid_fit(esk_segmentation *segmentation, eskel_volume_info *info, eskel_error *error);

#endif
