/* What the formats add to a file that is written: its header. */
#ifndef ESK_VOLUME_WRITER_H
#define ESK_VOLUME_WRITER_H

#include "eskel.h"

enum { ESK_VOLUME_HEAD_MOST = 1024 };

typedef struct {
	uint32_t extent[3]; /* 1 to 65535 */
	eskel_affine affine;
	unsigned voxel_size; /* bytes: 1 unsigned, 2 or 4 signed; little-endian */
} esk_volume_grid;

/* Writes all bytes before the voxels; returns how many. NIfTI-1 where its floats and 16-bit extents hold the grid as it is,
 * otherwise NIfTI-2 (nifti_write.c, nrrd_write.c). */
size_t esk_nifti_write_head(const esk_volume_grid *grid, uint8_t head[ESK_VOLUME_HEAD_MOST]);
size_t esk_nrrd_write_head(const esk_volume_grid *grid, uint8_t head[ESK_VOLUME_HEAD_MOST]);

#endif
