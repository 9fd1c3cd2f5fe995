/* Costs of pairs of classes (section 5.2.1). */
#ifndef ESK_CLASS_COSTS_H
#define ESK_CLASS_COSTS_H

#include "eskel.h"

/* The distance between the numbers of class i of a and class j of b in a metric, padded and aligned as
 * esk_assignment_solve_padded takes them. Of a and b row c, number c of each of the k classes, begins at c * k; padded,
 * the rows of one shape have at most ESK_LEVEL_FLOATS_MAX numbers (shape.h). */
void esk_class_costs(eskel_metric metric, uint32_t numbers, uint32_t k, const float *a, const float *b, float *costs);

/* If every class were given the nearest of the other shape by the metric root, which of the two sums of costs is more: no
 * bijection costs less. */
float esk_class_costs_nearest(uint32_t numbers, uint32_t k, const float *a, const float *b);

#endif
