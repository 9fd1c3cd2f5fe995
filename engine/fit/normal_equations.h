/* The residuals of a blend at the points of a fit, and the normal equations for its parameters (section 3.6). */
#ifndef ESK_NORMAL_EQUATIONS_H
#define ESK_NORMAL_EQUATIONS_H

#include "composition.h"
#include "fit_points.h"
#include "team.h"

/* With delta = d / sqrt(|grad d|^2 + (d / L)^2), in mm, which is the first-order distance near the surface and saturates at
 * L far from it, residuals are delta on the boundary, what delta + margin is above 0 inside, and what margin - delta is
 * above 0 outside. */
typedef struct esk_normal_equations esk_normal_equations;

/* For so many classes with at most so many parameters each (ESK_PARAMETERS_...). Borrows the points and the team. */
eskel_status esk_normal_equations_new(const esk_fit_points *points, uint32_t class_count, size_t most_parameters,
	esk_team *team, esk_normal_equations **equations);
void esk_normal_equations_free(esk_normal_equations *equations);

/* The weighted sum of squares of the residuals, mm^2, with L = length. They, and the composition, stay for the next call. */
double esk_normal_equations_measure(esk_normal_equations *equations, const esk_composition *composition, double length);

/* The same, given up once it is not below most; in the calling thread, and nothing stays. */
double esk_normal_equations_measure_below(
	esk_normal_equations *equations, const esk_composition *composition, double length, double most);

/* J^T J and J^T r for the composition that was measured last and the first count parameters of each class, those of class i
 * from i count on: the upper triangle of matrix[n][n], vector[n], n = class_count count. */
void esk_normal_equations_derive(esk_normal_equations *equations, size_t count, double *matrix, double *vector);

/* The residuals of group g, a lane a point, as last measured. */
const double *esk_normal_equations_residuals(const esk_normal_equations *equations, size_t group);

#endif
