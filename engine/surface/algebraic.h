/* Implicit surface of even degree through boundary points, by least squares (section 3.8).
 *
 * In the class's frame, in units of its radii (so that its ellipsoid is the unit sphere), the potential is a polynomial P of
 * degree D = 2, 4 or 6 with P(0) = -1: the paper's F with the other sign, negative inside.
 *
 * An even degree does not make the surface bounded, as the paper has it: the leading form may well be negative in some
 * direction, and mostly is when only boundary points are fitted. So P is fitted to r^D - 1 as well, the ellipsoid's
 * potential of that degree, at points well inside and outside; the weight of these is the least in a fixed sequence at which P
 * is proven positive outside of the cube |x|, |y|, |z| <= ESK_ALGEBRAIC_BOX, and the centre inside.
 *
 * Boundary points alone also leave it free to have sheets where there are none. Where points are known to be inside or
 * outside, those on the wrong side of what was fitted are fitted to the right one, again and again.
 *
 * The paper prefers the Bernstein basis for the sake of affine invariance. Least squares of values have the same solution in
 * every basis, and in the class's own frame it does not change with the world's axes; what the Bernstein basis is needed
 * for is the proof. */
#ifndef ESK_ALGEBRAIC_H
#define ESK_ALGEBRAIC_H

#include "eskel.h"
#include "lanes.h"

/* Monomials x^i y^j z^k with i + j + k <= 6. */
enum { ESK_ALGEBRAIC_DEGREE_MAX = 6, ESK_ALGEBRAIC_TERMS_MAX = 84 };

#define ESK_ALGEBRAIC_BOX 3.0

typedef struct {
	unsigned degree;
	double centre[3];
	double to_frame[3][3]; /* axes over radii */
	/* Of monomials in the order of i descending, then j, then k: so that three nested Horner schemes read them in turn. */
	double coefficients[ESK_ALGEBRAIC_TERMS_MAX];
} esk_algebraic;

size_t esk_algebraic_term_count(unsigned degree);

/* The frame of a primitive. */
void esk_algebraic_place(const eskel_primitive *primitive, esk_algebraic *algebraic);
/* What a surface is fitted to, mm: points of the boundary, and points known to be on one side of it. */
typedef struct {
	size_t count;
	const double (*points)[3];
	size_t side_count; /* may be 0 */
	const double (*sides)[3];
	const bool *are_inside;
} esk_algebraic_points;

/* In the frame of a primitive. ESKEL_INVALID as eskel_surface_set_algebraic. */
eskel_status esk_algebraic_fit(const eskel_primitive *primitive, unsigned degree, const esk_algebraic_points *points,
	esk_algebraic *algebraic);
/* Is it proven that the centre is inside, and that nothing outside of the box is? */
bool esk_algebraic_is_bounded(const esk_algebraic *algebraic);

/* At eight points, point[axis][lane]. */
void esk_algebraic_values(const esk_algebraic *algebraic, const esk_lanes point[3], esk_lanes values);
void esk_algebraic_gradients(
	const esk_algebraic *algebraic, const esk_lanes point[3], esk_lanes values, esk_lanes gradients[3]);

#endif
