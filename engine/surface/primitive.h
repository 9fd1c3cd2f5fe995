/* The primitive of a class (sections 3.3 to 3.5; eskel_surface.h states the maps and the potential): its
 * parameters. How it is evaluated is in form.h.
 *
 * Parameters change a primitive from where it is, so their derivatives are those at 0 for the first six. In this order:
 *	0  translation along its own axes, mm (3)
 *	3  rotation vector along its own axes (3)
 *	6  ln a, ln b, ln c (3)
 *	9  taper x, y; bend x, y; twist: the first five modes
 *	14 alpha
 *	15 e1, e2
 *	17 the other sixteen modes */
#ifndef ESK_PRIMITIVE_H
#define ESK_PRIMITIVE_H

#include "eskel.h"

enum {
	ESK_TRANSLATION = 0,
	ESK_ROTATION = 3,
	ESK_LOG_RADII = 6,
	ESK_FIRST_MODES = 9,
	ESK_ALPHA = 14,
	ESK_EXPONENTS = 15,
	ESK_FURTHER_MODES = 17,
	ESK_FIRST_MODE_COUNT = ESK_ALPHA - ESK_FIRST_MODES,
	/* How many of them to derive by: without exponents, with these, all. */
	ESK_PARAMETERS_SMOOTH = 15,
	ESK_PARAMETERS_USUAL = 17,
	ESK_PARAMETERS_ALL = 33
};

/* The best ellipsoid of a class, z along its longest axis, alpha 1. Eigenvalues count as least_variance at least. */
void esk_primitive_from_node(const eskel_node *node, double gamma, double least_variance, eskel_primitive *primitive);
/* All numbers are in the ranges of eskel_surface.h, the axes a right-handed frame but for 1e-9; only superquadrics and deformed
 * ones have exponents, only these modes. */
bool esk_primitive_is_valid(const eskel_primitive *primitive);
/* Changes the first count parameters by step. to may be from. Not checked: the modes, exponents and alpha that a step leads
 * to must be in range, so must the radii. */
void esk_primitive_step(const eskel_primitive *from, const double *step, size_t count, eskel_primitive *to);
/* Which centre is nearest to a point, the first of equals. */
uint32_t esk_primitive_nearest(const eskel_primitive *primitives, uint32_t count, const double point[3]);

#endif
