/* Where the voxels of an NRRD file lie. */
#ifndef ESK_NRRD_GEOMETRY_H
#define ESK_NRRD_GEOMETRY_H

#include "nrrd_lists.h"

/* Fills info's affine, which is checked, and warnings, two at most. The kinds and space directions must have been read as
 * lists of the axes before. */
eskel_status esk_nrrd_read_geometry(const esk_nrrd_axes *axes, eskel_volume_info *info, eskel_error *error);

#endif
