/* Primitives composed: Blinn's blend or the union (eskel.h), and the derivatives of a blend by every parameter.
 *
 * With e_i = alpha_i d_i and the weights w_i = exp(-e_i) / sum_j exp(-e_j),
 *	grad d     = sum_i w_i alpha_i grad d_i,
 *	dd/dt      = w_i alpha_i dd_i/dt                 for a parameter t of class i,
 *	d grad d/dt = w_i alpha_i (d grad d_i/dt - dd_i/dt (alpha_i grad d_i - grad d)),
 * and for alpha_i the same with d_i and grad d_i / alpha_i in the place of alpha_i times the derivatives of d_i. */
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

/* At eight points, point[axis][lane]: the values and gradients of the composition, and in derivatives[i].value_by and
 * gradient_by its derivatives by the first count parameters of class i (value and gradient there are those of the class). A
 * class whose weight is below least_weight at all eight points is not derived by: is_near[i] is false. No algebraic parts. */
void esk_composition_derive(const esk_composition *composition, const esk_lanes point[3], size_t count,
	double least_weight, esk_lanes values, esk_lanes gradients[3], bool *is_near, esk_derivatives *derivatives);

#endif
