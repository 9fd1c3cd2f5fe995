/* Classical scaling (Torgerson, 1952): squared distances, centred in both directions and halved, are inner products,
 * whose two greatest eigenvalues and their vectors are the best plane.
 *
 * Eigenvectors have no sign, and equal eigenvalues (three shapes at one distance) any vectors of a plane. So that the
 * picture is the same everywhere, signs are fixed, and of equal values the plane is turned until the first shape off the
 * centre lies on the first axis. The last bits are the processor's own (eigen.c says why); a picture's digits hide them. */
#include "eskel.h"
#include "memory.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

/* Coordinates are roots of eigenvalues, of which rounding leaves some 1e-16 a shape in place of 0: 1e-8, and some room. */
static const double noise = 1e-6;
/* What is equal but for rounding, with room: the vectors of such values mean nothing. */
static const double equal_values = 1e-9;
/* Clear of the ratios that symmetric arrangements have: 0.5, 0.577, 0.6, 0.707, 1. */
static const double large = 0.65;

/* -1/2 J D^2 J, where J takes the mean of a column, or row, from it. */
static void make_products(const double *distances, size_t count, double *products, double *means)
{
	double whole = 0;
	for (size_t i = 0; i < count; i++) {
		double sum = 0;
		for (size_t j = 0; j < count; j++)
			sum += distances[i * count + j] * distances[i * count + j];
		means[i] = sum / (double)count;
		whole += means[i];
	}
	whole /= (double)count;
	for (size_t i = 0; i < count; i++)
		for (size_t j = 0; j < count; j++) {
			const double d = distances[i * count + j];
			products[i * count + j] = (means[i] + means[j] - whole - d * d) / 2;
		}
}

/* The first shape whose value is large decides the sign; all zero when the spread is only noise. */
static void fix_axis(double (*points)[2], size_t count, int axis, double least)
{
	double most = 0;
	size_t i = 0;
	for (size_t n = 0; n < count; n++)
		most = fmax(most, fabs(points[n][axis]));
	while (i + 1 < count && fabs(points[i][axis]) < large * most)
		i++;
	const double factor = most <= least ? 0 : points[i][axis] < 0 ? -1 : 1;
	for (size_t n = 0; n < count; n++)
		points[n][axis] = factor == 0 ? 0 : factor * points[n][axis];
}

static void turn_plane(double (*points)[2], size_t count, double radius)
{
	size_t i = 0;
	while (i + 1 < count && hypot(points[i][0], points[i][1]) < large * radius)
		i++;
	const double length = hypot(points[i][0], points[i][1]);
	if (length == 0)
		return;
	const double c = points[i][0] / length, s = points[i][1] / length;
	for (size_t n = 0; n < count; n++) {
		const double x = points[n][0], y = points[n][1];
		points[n][0] = c * x + s * y;
		points[n][1] = c * y - s * x;
	}
}

/* values ascend; vectors[count] of each, one after the other. */
static void place(const double values[2], const double *vectors, size_t count, double (*points)[2])
{
	double radius = 0;
	for (size_t n = 0; n < count; n++) {
		for (int axis = 0; axis < 2; axis++)
			points[n][axis] = sqrt(fmax(values[1 - axis], 0)) * vectors[(size_t)(1 - axis) * count + n];
		radius = fmax(radius, hypot(points[n][0], points[n][1]));
	}
	if (values[1] - values[0] <= equal_values * values[1])
		turn_plane(points, count, radius);
	fix_axis(points, count, 0, 0);
	fix_axis(points, count, 1, noise * sqrt((double)count) * radius);
}

eskel_status eskel_scaling(const double *distances, size_t count, double (*points)[2])
{
	if (count > INT32_MAX / 64) /* LAPACK counts work in 32 bits */
		return ESKEL_INVALID;
	if (count == 1)
		points[0][0] = points[0][1] = 0;
	if (count < 2)
		return ESKEL_OK;
	const lapack_int n = (lapack_int)count;
	lapack_int found = 0;
	double *products = esk_memory_array(count * count, sizeof *products);
	double *values = esk_memory_array(count, sizeof *values);
	double *vectors = esk_memory_array(2 * count, sizeof *vectors);
	lapack_int *support = esk_memory_array(4, sizeof *support);
	eskel_status status = products && values && vectors && support ? ESKEL_OK : ESKEL_NO_MEMORY;
	if (status == ESKEL_OK) {
		make_products(distances, count, products, values);
		const lapack_int info = LAPACKE_dsyevr(LAPACK_COL_MAJOR, 'V', 'I', 'L', n, products, n, 0, 0, n - 1, n,
			0, &found, values, vectors, n, support);
		status = info == LAPACK_WORK_MEMORY_ERROR ? ESKEL_NO_MEMORY
			 : info != 0 || found != 2        ? ESKEL_NUMERIC
							  : ESKEL_OK;
	}
	if (status == ESKEL_OK)
		place(values, vectors, count, points);
	free(products);
	free(values);
	free(vectors);
	free(support);
	return status;
}
