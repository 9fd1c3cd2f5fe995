/* A scalar function of space, negative inside of a surface, zero on it, without unit; points in mm. */
#ifndef ESK_FIELD_H
#define ESK_FIELD_H

#include <stddef.h>

typedef struct {
	const void *context;
	/* The values at many points at once. */
	void (*values)(const void *context, size_t count, const double (*points)[3], double *values);
	/* The value at a point, and its gradient, 1/mm. */
	double (*gradient)(const void *context, const double point[3], double gradient[3]);
	/* The values and gradients at many points at once; NULL: one by one. */
	void (*gradients)(
		const void *context, size_t count, const double (*points)[3], double *values, double (*gradients)[3]);
} esk_field;

#endif
