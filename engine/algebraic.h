/* Implicit surface of even degree through boundary points, by least squares (section 3.8).
 *
 * In the class's frame, in units of its radii, the potential is a polynomial P of degree D = 2, 4 or 6, negative inside. */
#ifndef ESK_ALGEBRAIC_H
#define ESK_ALGEBRAIC_H

#include "eskel.h"
#include "lanes.h"

/* Monomials x^i y^j z^k with i + j + k <= 6. */
enum { ESK_ALGEBRAIC_DEGREE_MAX = 6, ESK_ALGEBRAIC_TERMS_MAX = 84 };

typedef struct {
	unsigned degree;
	double centre[3];
	double to_frame[3][3]; /* axes over radii */
	/* Of monomials in the order of i descending, then j, then k: so that three nested Horner schemes read them in turn. */
	double coefficients[ESK_ALGEBRAIC_TERMS_MAX];
} esk_algebraic;

size_t esk_algebraic_term_count(unsigned degree);

/* At eight points, point[axis][lane]. */
void esk_algebraic_values(const esk_algebraic *algebraic, const esk_lanes point[3], esk_lanes values);
void esk_algebraic_gradients(
	const esk_algebraic *algebraic, const esk_lanes point[3], esk_lanes values, esk_lanes gradients[3]);

#endif
