/* NIfTI-1 files in memory, of blobs that are easily told apart. For tests of the API; whatever fails ends the program. */
#ifndef VOLUMES_H
#define VOLUMES_H

#include <stddef.h>
#include <stdint.h>

/* One object: a bent and tapered rod with a knob on one side, so that it is no mirror image of itself. */
typedef struct {
	int label;                  /* 1 to 255 */
	double length, width, knob; /* mm: half axis of the rod, of its section, radius of the knob */
	int mirrored;               /* left for right */
	double centre[3];           /* voxels */
} blob;

typedef struct {
	uint8_t *bytes;
	size_t size;
} volume_file;

/* 1 mm voxels, RAS. Free with volume_free. */
volume_file volume_of_blobs(const blob *blobs, size_t count, unsigned extent);
void volume_free(volume_file *file);

/* Member of family number family: families differ in proportions, members by some percent. */
blob blob_of_family(unsigned family, unsigned member);
/* Such a blob alone in a volume of 48 x 48 x 48. */
volume_file volume_of_family(unsigned family, unsigned member, int mirrored);

#endif
