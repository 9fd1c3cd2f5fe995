/* Segments in packs of eight, cut into pieces so that those of a pack lie close together. */
#ifndef ESK_PACK_H
#define ESK_PACK_H

#include "moments.h"

enum { ESK_PACK = 8 };

/* Pieces side by side, so that vectors go over them. All numbers are integers. A place without a piece has no voxels and
 * weight 0. */
typedef struct {
	double x_first[ESK_PACK], y[ESK_PACK], z[ESK_PACK], voxels[ESK_PACK], weight[ESK_PACK];
} esk_pack;

/* The least box around voxels. Centres are integers: all coordinates along an axis have one parity. */
typedef struct {
	double centre[3], half[3];
} esk_box;

esk_pack esk_pack_of(const esk_segment *segments, size_t count);
esk_box esk_pack_box(const esk_pack *pack);

/* The box around both. */
esk_box esk_box_join(const esk_box *a, const esk_box *b);

#endif
