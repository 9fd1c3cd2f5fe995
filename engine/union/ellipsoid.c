#include "ellipsoid.h"

void esk_ellipsoid_make(const eskel_primitive *primitive, esk_ellipsoid *e)
{
	const double *radii = primitive->radii;
	const int last = radii[2] >= radii[0] && radii[2] >= radii[1] ? 2 : radii[0] >= radii[1] ? 0 : 1;
	for (int a = 0; a < 3; a++) {
		const int from = (last + 1 + a) % 3; /* an even permutation */
		e->centre[a] = primitive->centre[a];
		e->radii[a] = radii[from];
		for (int i = 0; i < 3; i++) {
			e->axes[a][i] = primitive->axes[from][i] * radii[from];
			e->duals[a][i] = primitive->axes[from][i] / radii[from];
		}
	}
	for (int i = 0; i < 3; i++)
		e->reach[i] = sqrt(
			e->axes[0][i] * e->axes[0][i] + e->axes[1][i] * e->axes[1][i] + e->axes[2][i] * e->axes[2][i]);
}
