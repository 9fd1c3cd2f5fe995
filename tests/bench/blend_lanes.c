#include "blend_lanes.h"

#include "elementary.h"
#include "lanes.h"

/* Sums over the ellipsoids of exp(-d) and, but for the factor -1, its gradient. */
ESK_IN_LANES void sum_up(const ellipsoids *e, const esk_lanes p[3], esk_lanes sum, esk_lanes g[3])
{
	ESK_EACH_LANE (l)
		sum[l] = g[0][l] = g[1][l] = g[2][l] = 0;
	for (int i = 0; i < e->count; i++) {
		const ellipsoid *q = &e->items[i];
		const double s[3] = {1 / q->radii[0], 1 / q->radii[1], 1 / q->radii[2]};
		ESK_EACH_LANE (l) {
			const double x = (p[0][l] - q->centre[0]) * s[0], y = (p[1][l] - q->centre[1]) * s[1],
				     z = (p[2][l] - q->centre[2]) * s[2];
			const double d = x * x + y * y + z * z - 1;
			const double weight = esk_elementary_exp_double(d < 60 ? -d : -60);
			sum[l] += weight;
			g[0][l] += weight * 2 * x * s[0];
			g[1][l] += weight * 2 * y * s[1];
			g[2][l] += weight * 2 * z * s[2];
		}
	}
}

ESK_IN_LANES void sum_values(const ellipsoids *e, const esk_lanes p[3], esk_lanes sum)
{
	ESK_EACH_LANE (l)
		sum[l] = 0;
	for (int i = 0; i < e->count; i++) {
		const ellipsoid *q = &e->items[i];
		const double s[3] = {1 / q->radii[0], 1 / q->radii[1], 1 / q->radii[2]};
		ESK_EACH_LANE (l) {
			const double x = (p[0][l] - q->centre[0]) * s[0], y = (p[1][l] - q->centre[1]) * s[1],
				     z = (p[2][l] - q->centre[2]) * s[2];
			const double d = x * x + y * y + z * z - 1;
			sum[l] += esk_elementary_exp_double(d < 60 ? -d : -60);
		}
	}
}

ESK_IN_LANES void load(const double (*points)[3], size_t rest, esk_lanes p[3])
{
	for (int l = 0; l < ESK_LANES; l++)
		for (int a = 0; a < 3; a++)
			p[a][l] = points[(size_t)l < rest ? l : 0][a];
}

ESK_EVERY_WIDTH
static void values(const void *context, size_t count, const double (*points)[3], double *out)
{
	for (size_t first = 0; first < count; first += ESK_LANES) {
		esk_lanes p[3], sum;
		load(points + first, count - first, p);
		sum_values(context, (const esk_lanes *)p, sum);
		ESK_EACH_LANE (l)
			sum[l] = -esk_elementary_log(sum[l]);
		for (size_t l = 0; l < ESK_LANES && first + l < count; l++)
			out[first + l] = sum[l];
	}
}

ESK_EVERY_WIDTH
static void gradients(const void *context, size_t count, const double (*points)[3], double (*out)[3])
{
	for (size_t first = 0; first < count; first += ESK_LANES) {
		esk_lanes p[3], sum, g[3];
		load(points + first, count - first, p);
		sum_up(context, (const esk_lanes *)p, sum, g);
		for (size_t l = 0; l < ESK_LANES && first + l < count; l++)
			for (int a = 0; a < 3; a++)
				out[first + l][a] = g[a][l] / sum[l];
	}
}

esk_field blend_lanes(const ellipsoids *e)
{
	esk_field field = fields_blend(e);
	field.values = values;
	field.gradients = gradients;
	return field;
}
