#include "fields.h"

#include <math.h>

static double distance_of(const ellipsoid *e, const double point[3], double gradient[3])
{
	double d = -1;
	for (int a = 0; a < 3; a++) {
		const double x = (point[a] - e->centre[a]) / e->radii[a];
		d += x * x;
		gradient[a] = 2 * x / e->radii[a];
	}
	return d;
}

static double blend_gradient(const void *context, const double point[3], double gradient[3])
{
	const ellipsoids *e = context;
	double sum = 0, whole[3] = {0, 0, 0};
	for (int i = 0; i < e->count; i++) {
		double g[3];
		const double weight = exp(-distance_of(&e->items[i], point, g));
		sum += weight;
		for (int a = 0; a < 3; a++)
			whole[a] += weight * g[a];
	}
	for (int a = 0; a < 3; a++)
		gradient[a] = whole[a] / sum;
	return -log(sum);
}

static double union_gradient(const void *context, const double point[3], double gradient[3])
{
	const ellipsoids *e = context;
	double least = INFINITY;
	for (int i = 0; i < e->count; i++) {
		double g[3];
		const double d = distance_of(&e->items[i], point, g);
		if (d < least) {
			least = d;
			for (int a = 0; a < 3; a++)
				gradient[a] = g[a];
		}
	}
	return least;
}

static double torus_gradient(const void *context, const double point[3], double gradient[3])
{
	const torus *t = context;
	const double rho = hypot(point[0], point[1]), out = rho - t->circle;
	gradient[0] = 2 * out * point[0] / rho;
	gradient[1] = 2 * out * point[1] / rho;
	gradient[2] = 2 * point[2];
	return out * out + point[2] * point[2] - t->tube * t->tube;
}

static void blend_values(const void *context, size_t count, const double (*points)[3], double *values)
{
	double gradient[3];
	for (size_t i = 0; i < count; i++)
		values[i] = blend_gradient(context, points[i], gradient);
}

static void union_values(const void *context, size_t count, const double (*points)[3], double *values)
{
	double gradient[3];
	for (size_t i = 0; i < count; i++)
		values[i] = union_gradient(context, points[i], gradient);
}

static void torus_values(const void *context, size_t count, const double (*points)[3], double *values)
{
	double gradient[3];
	for (size_t i = 0; i < count; i++)
		values[i] = torus_gradient(context, points[i], gradient);
}

esk_field fields_blend(const ellipsoids *e)
{
	return (esk_field){.context = e, .values = blend_values, .gradient = blend_gradient};
}

esk_field fields_union(const ellipsoids *e)
{
	return (esk_field){.context = e, .values = union_values, .gradient = union_gradient};
}

esk_field fields_torus(const torus *t)
{
	return (esk_field){.context = t, .values = torus_values, .gradient = torus_gradient};
}

void fields_ten(ellipsoids *e)
{
	e->count = 10;
	for (int i = 0; i < 10; i++)
		e->items[i] = (ellipsoid){{20 * sin(i * 0.9), 16 * cos(i * 1.3), 10.5 * i - 47},
			{12 + 3 * sin(i), 11 + 3 * cos(2 * i), 9 + i % 3}};
}
