/* Vectors of space as three numbers in a row. */
#ifndef ESK_TRIPLE_H
#define ESK_TRIPLE_H

#include <math.h>

static inline double esk_triple_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void esk_triple_subtract(const double a[3], const double b[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[i] - b[i];
}

static inline double esk_triple_length(const double v[3])
{
	return sqrt(esk_triple_dot(v, v));
}

/* out is neither a nor b. */
static inline void esk_triple_cross(const double a[3], const double b[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

#endif
