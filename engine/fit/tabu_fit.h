/* The paper's fit in two stages (section 3.6): each primitive to its own class, then the alphas. */
#ifndef ESK_TABU_FIT_H
#define ESK_TABU_FIT_H

#include "joint_fit.h"

typedef struct {
	esk_joint_options
		joint; /* of the descents; what is in it of progress counts classes, and the alphas as one more */
	uint32_t neighbours, memory, steps;
	double threshold; /* mm */
	uint64_t seed;
} esk_tabu_options;

enum { ESK_TABU_MEMORY_MOST = 64 };

/* As esk_joint_fit. */
eskel_status esk_tabu_fit(const esk_fit_points *points, const esk_tabu_options *options, uint32_t count,
	const eskel_primitive *origin, eskel_primitive *primitives);

#endif
