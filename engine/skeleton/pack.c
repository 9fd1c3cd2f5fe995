#include "pack.h"

#include <math.h>

esk_pack esk_pack_of(const esk_segment *segments, size_t count)
{
	esk_pack pack = {0};
	for (size_t i = 0; i < count; i++) {
		pack.x_first[i] = segments[i].x_first;
		pack.y[i] = segments[i].y;
		pack.z[i] = segments[i].z;
		pack.voxels[i] = (double)esk_segment_voxels(&segments[i]);
		pack.weight[i] = (double)segments[i].weight;
	}
	return pack;
}

static esk_box box_between(const double least[3], const double greatest[3])
{
	esk_box box;
	for (int r = 0; r < 3; r++) {
		box.centre[r] = (least[r] + greatest[r]) / 2;
		box.half[r] = (greatest[r] - least[r]) / 2;
	}
	return box;
}

esk_box esk_pack_box(const esk_pack *pack)
{
	double least[3] = {INFINITY, INFINITY, INFINITY}, greatest[3] = {-INFINITY, -INFINITY, -INFINITY};
	for (int i = 0; i < ESK_PACK && pack->voxels[i] > 0; i++) {
		const double first[3] = {pack->x_first[i], pack->y[i], pack->z[i]};
		const double last[3] = {pack->x_first[i] + 2 * (pack->voxels[i] - 1), pack->y[i], pack->z[i]};
		for (int r = 0; r < 3; r++) {
			least[r] = first[r] < least[r] ? first[r] : least[r];
			greatest[r] = last[r] > greatest[r] ? last[r] : greatest[r];
		}
	}
	return box_between(least, greatest);
}

esk_box esk_box_join(const esk_box *a, const esk_box *b)
{
	double least[3], greatest[3];
	for (int r = 0; r < 3; r++) {
		least[r] = fmin(a->centre[r] - a->half[r], b->centre[r] - b->half[r]);
		greatest[r] = fmax(a->centre[r] + a->half[r], b->centre[r] + b->half[r]);
	}
	return box_between(least, greatest);
}
