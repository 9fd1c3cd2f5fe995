/* A primitive made ready for evaluation: its potential, gradient, and the derivatives of both by its parameters. */
#ifndef ESK_FORM_H
#define ESK_FORM_H

#include "lanes.h"
#include "primitive.h"

/* Which of the steps 2 to 4 change something: none, 2 and 3, all. */
typedef enum { ESK_RIGID, ESK_BENT, ESK_WARPED } esk_steps;

typedef struct {
	double centre[3];
	double to_frame[3][3]; /* axes / c */
	double widening[2];    /* c / a, c / b */
	double length;         /* c, mm */
	double exponents[2];
	double modes[ESKEL_MODE_COUNT];
	esk_steps steps;
	bool is_superquadric; /* some exponent is not 1 */
} esk_form;

/* Everything about eight points, one a lane. */
typedef struct {
	esk_lanes value, gradient[3];
	esk_lanes value_by[ESK_PARAMETERS_ALL];
	esk_lanes gradient_by[ESK_PARAMETERS_ALL][3];
} esk_derivatives;

void esk_form_make(const eskel_primitive *primitive, esk_form *form);

/* At blocks of eight points, points[block][axis][lane]. Lanes do not mix: a point has the same bits in any of them. */
void esk_form_values(const esk_form *form, size_t blocks, const esk_lanes (*points)[3], esk_lanes *values);
void esk_form_gradients(const esk_form *form, size_t blocks, const esk_lanes (*points)[3], esk_lanes *values,
	esk_lanes (*gradients)[3]);
/* The derivatives by the first count parameters (ESK_PARAMETERS_...); those by alpha are 0. With the exponents asked for all
 * is of the superquadric, so where they are 1 the value is 2e-7 off that of the ellipsoid (eskel_surface.h, rounded creases). */
void esk_form_derive(const esk_form *form, const esk_lanes point[3], size_t count, esk_derivatives *derivatives);

#endif
