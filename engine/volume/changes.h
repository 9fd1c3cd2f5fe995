/* Where voxels differ from the one before them. */
#ifndef ESK_CHANGES_H
#define ESK_CHANGES_H

#include <stddef.h>
#include <stdint.h>

/* Writes the offsets, ascending, of the voxels in size bytes that differ from the voxel before them, and returns how
 * many there are. A voxel lies before the first one too. voxel_size is 1, 2, 4 or 8 and divides size, which is at most
 * 65536. There must be room for all voxels. */
size_t esk_changes_find(const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets);

/* The same without vectors. */
size_t esk_changes_find_plainly(const uint8_t *bytes, size_t size, unsigned voxel_size, uint16_t *offsets);

#endif
