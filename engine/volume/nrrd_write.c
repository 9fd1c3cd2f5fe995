/* The headers of the NRRD files that are written: voxels attached and gzipped, space RAS, every number with the 17 digits
 * that tell a double from its neighbours. */
#include "volume_writer.h"

#include <stdio.h>

size_t esk_nrrd_write_head(const esk_volume_grid *grid, uint8_t head[ESK_VOLUME_HEAD_MOST])
{
	const double(*m)[4] = grid->affine.m;
	const char *type = grid->voxel_size == 1 ? "uint8" : grid->voxel_size == 2 ? "int16" : "int32";
	int size = snprintf((char *)head, ESK_VOLUME_HEAD_MOST,
		"NRRD0004\ntype: %s\ndimension: 3\nspace: right-anterior-superior\nsizes: %u %u %u\n"
		"space directions: (%.17g,%.17g,%.17g) (%.17g,%.17g,%.17g) (%.17g,%.17g,%.17g)\n"
		"kinds: domain domain domain\nendian: little\nencoding: gzip\nspace origin: (%.17g,%.17g,%.17g)\n\n",
		type, grid->extent[0], grid->extent[1], grid->extent[2], m[0][0], m[1][0], m[2][0], m[0][1], m[1][1],
		m[2][1], m[0][2], m[1][2], m[2][2], m[0][3], m[1][3], m[2][3]);
	return (size_t)size; /* 12 numbers of up to 24 characters and 200 others: it fits */
}
