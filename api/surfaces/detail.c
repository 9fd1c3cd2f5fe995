/* Levels of detail, see detail.h. */
#include "detail.h"

#include <math.h>

static const double radius = 2.2360679774997896964; /* in standard deviations, of the best ellipsoid: the root of 5 */
static const double steps_a_radius = 16, steps_a_class = 4, pixels_a_step = 2, pixel = 1e-3 /* radians */;

double esk_detail_step(const eskel_skeleton *skeleton)
{
	const double voxel = cbrt(skeleton->volume / (double)skeleton->voxels);
	const double shortest = radius * sqrt(skeleton->nodes[0].eigenvalues[2]);
	return fmax(round(1e3 * fmax(shortest / steps_a_radius, voxel / 2)), 1) / 1e3;
}

void esk_detail_table(const eskel_skeleton *skeleton, esk_detail details[ESK_DETAILS])
{
	double step = esk_detail_step(skeleton);
	for (int i = 0; i < ESK_DETAILS; i++, step *= 2) {
		uint32_t level = skeleton->level_count;
		while (level > 1 && cbrt(skeleton->volume / level) < steps_a_class * step)
			level--;
		details[i] = (esk_detail){i == 0 ? 0 : step / (pixels_a_step * pixel), level, step};
	}
}

esk_detail esk_detail_at(const eskel_skeleton *skeleton, double distance)
{
	esk_detail details[ESK_DETAILS];
	int row = ESK_DETAILS - 1;
	esk_detail_table(skeleton, details);
	while (row > 0 && distance < details[row].from)
		row--;
	return details[row];
}
