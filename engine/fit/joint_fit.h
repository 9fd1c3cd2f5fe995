/* The joint fit: all classes of a level at once, by Levenberg and Marquardt (section 3.6; where we differ, joint_fit.c). */
#ifndef ESK_JOINT_FIT_H
#define ESK_JOINT_FIT_H

#include "fit_points.h"
#include "primitive.h"
#include "team.h"

typedef struct {
	eskel_fit_freedom freedom;
	bool only_alphas; /* nothing else changes */
	bool only_last;   /* the last stage alone, for a start that is a fit already */
	double spacing;   /* mm, of voxels */
	bool (*progress)(void *context, uint32_t step, uint32_t steps); /* may be NULL; false: ESKEL_CANCELLED */
	void *context;
	esk_team *team;
} esk_joint_options;

/* What progress is told of as all steps; a stage that ends early skips the rest of its own. */
uint32_t esk_joint_steps(const esk_joint_options *options);

/* Which parameters (primitive.h) a freedom leaves free, and how many there are up to the last of these. */
size_t esk_joint_free(eskel_fit_freedom freedom, bool is_free[ESK_PARAMETERS_ALL]);
/* Between which values a fit keeps a parameter: translations in units of c and logarithms of radii from those of the origin. */
void esk_joint_bounds(size_t parameter, double bounds[2]);

/* Takes a step of the first count parameters as far as the bounds allow, which step becomes. */
void esk_joint_step(
	const eskel_primitive *origin, const eskel_primitive *from, double *step, size_t count, eskel_primitive *to);

/* Changes the primitives of a blend, which are where it starts; the weak pull is to those of the origin, whose kind they have.
 * Cost (may be NULL) is that of the end, mm^2. On failure all is untouched. */
eskel_status esk_joint_fit(const esk_fit_points *points, const esk_joint_options *options, uint32_t count,
	const eskel_primitive *origin, eskel_primitive *primitives, double *cost);

#endif
