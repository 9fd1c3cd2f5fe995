/* The blend of a level's primitives at strips of points: what a fit asks for over and over. Values and gradients are those of
 * composition.h. */
#ifndef ESK_BLEND_H
#define ESK_BLEND_H

#include "composition.h"
#include "strip.h"

/* At points[axis][lane]; weights[i] are those of class i (composition.h). No algebraic parts. */
void esk_blend_evaluate(const esk_composition *blend, const esk_strip points[3], esk_strip values,
	esk_strip gradients[3], esk_strip *weights);

#endif
