/* Costs of pairs of classes (section 5.2.1). */
#ifndef ESK_CLASS_COSTS_H
#define ESK_CLASS_COSTS_H

#include "eskel.h"

/* The distance between the numbers of class i of a and class j of b in a metric, padded and aligned as
 * esk_assignment_solve_padded takes them. Of a and b row c, number c of each of the k classes, begins at c * k. */
void esk_class_costs(eskel_metric metric, uint32_t numbers, uint32_t k, const float *a, const float *b, float *costs);

#endif
