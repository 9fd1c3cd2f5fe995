/* Algebraic surfaces fitted to the classes of a level, each on its own (section 3.8). */
#ifndef ESK_LEAST_SQUARES_FIT_H
#define ESK_LEAST_SQUARES_FIT_H

#include "boundary.h"

typedef struct {
	size_t boundary_points;                                         /* at most, of all classes together */
	bool (*progress)(void *context, uint32_t step, uint32_t steps); /* may be NULL; false: ESKEL_CANCELLED */
	void *context;
} esk_least_squares_options;

/* Makes the classes of a surface algebraic, all but those that have no boundary or too odd a one: these stay as they are. */
eskel_status esk_least_squares_fit(
	const esk_boundary *boundary, const esk_least_squares_options *options, eskel_surface *surface);

#endif
