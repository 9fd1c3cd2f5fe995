/* Primitives composed: Blinn's blend or the union (eskel_surface.h). With e_i = alpha_i d_i and the weights
 * w_i = exp(-e_i) / sum_j exp(-e_j) the gradient of a blend is sum_i w_i alpha_i grad d_i. */
#ifndef ESK_COMPOSITION_H
#define ESK_COMPOSITION_H

#include "algebraic.h"
#include "field.h"
#include "form.h"

typedef struct {
	esk_form form;
	double alpha;
	const esk_algebraic *algebraic; /* borrowed; in the place of the form unless NULL */
} esk_part;

typedef struct {
	eskel_compose compose;
	uint32_t count; /* 1 to ESKEL_LEVELS_MAX */
	esk_part parts[ESKEL_LEVELS_MAX];
} esk_composition;

/* No algebraic parts. */
void esk_composition_make(
	const eskel_primitive *primitives, uint32_t count, eskel_compose compose, esk_composition *composition);
/* Borrows the composition. */
esk_field esk_composition_field(const esk_composition *composition);

void esk_composition_values(
	const esk_composition *composition, size_t count, const double (*points)[3], double *values);
double esk_composition_gradient(const esk_composition *composition, const double point[3], double gradient[3]);
/* As one by one, bit for bit. values may be NULL. */
void esk_composition_gradients(const esk_composition *composition, size_t count, const double (*points)[3],
	double *values, double (*gradients)[3]);

#endif
