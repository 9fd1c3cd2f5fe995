/* How the voxels of a file are stored, and the label that a stored voxel means. */
#ifndef ESK_VOXEL_H
#define ESK_VOXEL_H

#include "eskel.h"

typedef enum { ESK_VOXEL_UNSIGNED, ESK_VOXEL_SIGNED, ESK_VOXEL_FLOAT } esk_voxel_kind;

typedef struct {
	esk_voxel_kind kind;
	unsigned size; /* bytes: 1, 2, 4 or 8; floats 4 or 8 */
	bool big_endian;
	double slope, intercept; /* value = slope * stored + intercept; slope 0: value = stored */
} esk_voxel_format;

double esk_voxel_value(const esk_voxel_format *format, const uint8_t *stored);

/* False when the value, returned in *value, is not an integer of magnitude below 2^31. */
bool esk_voxel_label(const esk_voxel_format *format, const uint8_t *stored, int32_t *label, double *value);

#endif
