/* The deformations of a primitive (section 3.5; Barr, "Global and local deformations of solid primitives", 1984): steps 2, 3
 * and 4 of the map in eskel_surface.h from the frame to the unit superquadric, each with its Jacobian, its part of the jet and the
 * derivatives by its modes. */
#ifndef ESK_DEFORMATION_H
#define ESK_DEFORMATION_H

#include "elementary.h"
#include "jet.h"
#include "form.h"

/* Coordinates that modes depend on go no further. Where no mode moves it the primitive lies within 1; beyond, high powers
 * would draw the field into spikes that no sample of the outside meets. */
#define ESK_REACH 1.25

/* A coordinate within the reach, and whether it moves. */
typedef struct {
	double at, moves;
} esk_reached;

ESK_IN_LANES esk_reached esk_reach(double x)
{
	double at = x < ESK_REACH ? x : ESK_REACH;
	at = at > -ESK_REACH ? at : -ESK_REACH;
	return (esk_reached){at, at == x ? 1 : 0};
}

/* A polynomial in the reached coordinate, and its derivatives. */
typedef struct {
	double value, first, second;
} esk_polynomial;

/* c1 t + c2 t^2 + c3 t^3. */
ESK_IN_LANES esk_polynomial esk_polynomial_123(esk_reached t, double c1, double c2, double c3)
{
	return (esk_polynomial){t.at * (c1 + t.at * (c2 + t.at * c3)),
		t.moves * (c1 + t.at * (2 * c2 + t.at * (3 * c3))), t.moves * (2 * c2 + t.at * (6 * c3))};
}

/* c2 t^2 + c3 t^3 + c4 t^4. */
ESK_IN_LANES esk_polynomial esk_polynomial_234(esk_reached t, double c2, double c3, double c4)
{
	double squared = t.at * t.at;
	return (esk_polynomial){squared * (c2 + t.at * (c3 + t.at * c4)),
		t.moves * t.at * (2 * c2 + t.at * (3 * c3 + t.at * (4 * c4))),
		t.moves * (2 * c2 + t.at * (6 * c3 + t.at * (12 * c4)))};
}

/* A mode's factor t^n and its derivative. */
typedef struct {
	double value, first;
} esk_power;

ESK_IN_LANES esk_power esk_power_of(esk_reached t, int n)
{
	const double squared = t.at * t.at, below = n == 4 ? squared * t.at : n == 3 ? squared : n == 2 ? t.at : 1;
	return (esk_power){below * t.at, n * below * t.moves};
}

ESK_IN_LANES esk_polynomial esk_twist(const double *modes, double z)
{
	return esk_polynomial_123(
		esk_reach(z), modes[ESKEL_MODE_TWIST], modes[ESKEL_MODE_TWIST2], modes[ESKEL_MODE_TWIST3]);
}

ESK_IN_LANES esk_polynomial esk_taper_x(const double *modes, double z)
{
	return esk_polynomial_123(
		esk_reach(z), modes[ESKEL_MODE_TAPER_X], modes[ESKEL_MODE_BULGE_X], modes[ESKEL_MODE_TAPER3_X]);
}

ESK_IN_LANES esk_polynomial esk_taper_y(const double *modes, double z)
{
	return esk_polynomial_123(
		esk_reach(z), modes[ESKEL_MODE_TAPER_Y], modes[ESKEL_MODE_BULGE_Y], modes[ESKEL_MODE_TAPER3_Y]);
}

/* The transcendental functions in steps 2 and 3: of the twist, and exp(-taper). They depend on z in the frame alone. */
typedef struct {
	double sine, cosine, x_taper, y_taper;
} esk_turns;

ESK_IN_LANES esk_turns esk_turns_at(const double *modes, double z)
{
	esk_turns t;
	esk_elementary_sine_cosine(esk_twist(modes, z).value, &t.sine, &t.cosine);
	t.x_taper = esk_elementary_exp_double(-esk_taper_x(modes, z).value);
	t.y_taper = esk_elementary_exp_double(-esk_taper_y(modes, z).value);
	return t;
}

/* Step 2. */
typedef struct {
	esk_vector to;
	esk_reached along;
	double cosine, sine, turning; /* of the twist; its derivative by z */
	esk_jacobian jacobian;
	esk_vector by_zz;
} esk_bending;

ESK_IN_LANES esk_bending esk_bending_at(const double *modes, esk_vector q, esk_turns turns)
{
	esk_bending b = {.cosine = turns.cosine, .sine = turns.sine};
	b.along = esk_reach(q.z);
	esk_polynomial x = esk_polynomial_234(
		b.along, modes[ESKEL_MODE_BEND_X], modes[ESKEL_MODE_BEND3_X], modes[ESKEL_MODE_BEND4_X]);
	esk_polynomial y = esk_polynomial_234(
		b.along, modes[ESKEL_MODE_BEND_Y], modes[ESKEL_MODE_BEND3_Y], modes[ESKEL_MODE_BEND4_Y]);
	esk_polynomial twist = esk_twist(modes, q.z);
	const double c = b.cosine, s = b.sine, t = twist.first;
	b.turning = t;
	b.to = (esk_vector){c * (q.x - x.value) + s * (q.y - y.value), c * (q.y - y.value) - s * (q.x - x.value), q.z};
	/* The first and second derivatives of the bends, turned. */
	const double x1 = c * x.first + s * y.first, y1 = c * y.first - s * x.first;
	const double x2 = c * x.second + s * y.second, y2 = c * y.second - s * x.second;
	const double to_x = t * b.to.y - x1, to_y = -t * b.to.x - y1;
	b.jacobian = (esk_jacobian){{c, -s, 0}, {s, c, 0}, {to_x, to_y, 1}};
	b.by_zz = (esk_vector){
		twist.second * b.to.y + t * (to_y - y1) - x2, -twist.second * b.to.x - t * (to_x - x1) - y2, 0};
	return b;
}

ESK_IN_LANES esk_jet esk_bending_pull(const esk_bending *b, const esk_jet *f)
{
	esk_jet pulled = esk_jet_pull(&b->jacobian, f);
	const esk_vector g = f->gradient;
	pulled.hessian.xz -= b->turning * (b->sine * g.x + b->cosine * g.y);
	pulled.hessian.yz += b->turning * (b->cosine * g.x - b->sine * g.y);
	pulled.hessian.zz += g.x * b->by_zz.x + g.y * b->by_zz.y;
	return pulled;
}

/* By a mode with the factor t^n in the bend along (x, y) = (1, 0) or (0, 1). */
ESK_IN_LANES esk_tangent esk_bending_by_bend(const esk_bending *b, const esk_jet *f, double x, double y, int n)
{
	const esk_power p = esk_power_of(b->along, n);
	const double turned_x = b->cosine * x + b->sine * y, turned_y = b->cosine * y - b->sine * x;
	const esk_vector v = {-p.value * turned_x, -p.value * turned_y, 0};
	const esk_jacobian dv = {
		.by_z = {b->turning * v.y - p.first * turned_x, -b->turning * v.x - p.first * turned_y, 0}};
	return esk_jet_tangent(&b->jacobian, f, v, &dv);
}

ESK_IN_LANES esk_tangent esk_bending_by_twist(const esk_bending *b, const esk_jet *f, int n)
{
	const esk_power p = esk_power_of(b->along, n);
	const esk_jacobian *j = &b->jacobian;
	const esk_vector v = {p.value * b->to.y, -p.value * b->to.x, 0};
	const esk_jacobian dv = {{p.value * j->by_x.y, -p.value * j->by_x.x, 0},
		{p.value * j->by_y.y, -p.value * j->by_y.x, 0},
		{p.first * b->to.y + p.value * j->by_z.y, -p.first * b->to.x - p.value * j->by_z.x, 0}};
	return esk_jet_tangent(j, f, v, &dv);
}

/* Step 3. */
typedef struct {
	esk_vector to;
	esk_reached along;
	double x_scale, y_scale;
	esk_polynomial x_taper, y_taper;
	esk_jacobian jacobian;
} esk_scaling;

ESK_IN_LANES esk_scaling esk_scaling_at(const double *modes, const double *widening, esk_vector q, esk_turns turns)
{
	esk_scaling s;
	s.along = esk_reach(q.z);
	s.x_taper = esk_taper_x(modes, q.z);
	s.y_taper = esk_taper_y(modes, q.z);
	s.x_scale = widening[0] * turns.x_taper;
	s.y_scale = widening[1] * turns.y_taper;
	s.to = (esk_vector){s.x_scale * q.x, s.y_scale * q.y, q.z};
	s.jacobian = (esk_jacobian){
		{s.x_scale, 0, 0}, {0, s.y_scale, 0}, {-s.x_taper.first * s.to.x, -s.y_taper.first * s.to.y, 1}};
	return s;
}

ESK_IN_LANES esk_jet esk_scaling_pull(const esk_scaling *s, const esk_jet *f)
{
	esk_jet pulled = esk_jet_pull(&s->jacobian, f);
	const esk_vector g = f->gradient;
	const esk_polynomial x = s->x_taper, y = s->y_taper;
	pulled.hessian.xz -= g.x * x.first * s->x_scale;
	pulled.hessian.yz -= g.y * y.first * s->y_scale;
	pulled.hessian.zz +=
		g.x * (x.first * x.first - x.second) * s->to.x + g.y * (y.first * y.first - y.second) * s->to.y;
	return pulled;
}

/* By a mode with the factor t^n in the taper of x; n = 0: by ln(a / c). */
ESK_IN_LANES esk_tangent esk_scaling_by_x(const esk_scaling *s, const esk_jet *f, int n)
{
	const esk_power p = n ? esk_power_of(s->along, n) : (esk_power){1, 0};
	const esk_vector v = {-p.value * s->to.x, 0, 0};
	const esk_jacobian dv = {.by_x = {-p.value * s->x_scale, 0, 0},
		.by_z = {(p.value * s->x_taper.first - p.first) * s->to.x, 0, 0}};
	return esk_jet_tangent(&s->jacobian, f, v, &dv);
}

/* In the taper of y; n = 0: by ln(b / c). */
ESK_IN_LANES esk_tangent esk_scaling_by_y(const esk_scaling *s, const esk_jet *f, int n)
{
	const esk_power p = n ? esk_power_of(s->along, n) : (esk_power){1, 0};
	const esk_vector v = {0, -p.value * s->to.y, 0};
	const esk_jacobian dv = {.by_y = {0, -p.value * s->y_scale, 0},
		.by_z = {0, (p.value * s->y_taper.first - p.first) * s->to.y, 0}};
	return esk_jet_tangent(&s->jacobian, f, v, &dv);
}

/* Step 4. */
typedef struct {
	esk_vector to;
	esk_reached x, y;
	double cup_x, cup_y, cup_xx, cup_xy, cup_yy; /* derivatives of the cup */
	double wedge_x, wedge_y, skew;               /* derivatives of the exponents */
	double y_scale, z_scale;
	esk_jacobian jacobian;
} esk_warping;

ESK_IN_LANES esk_warping esk_warping_at(const double *modes, esk_vector u)
{
	esk_warping w;
	w.x = esk_reach(u.x);
	w.y = esk_reach(u.y);
	const double x = w.x.at, y = w.y.at;
	const double xx = modes[ESKEL_MODE_CUP_XX], xy = modes[ESKEL_MODE_CUP_XY], yy = modes[ESKEL_MODE_CUP_YY];
	w.cup_x = (2 * xx * x + xy * y) * w.x.moves;
	w.cup_y = (xy * x + 2 * yy * y) * w.y.moves;
	w.cup_xx = 2 * xx * w.x.moves;
	w.cup_xy = xy * w.x.moves * w.y.moves;
	w.cup_yy = 2 * yy * w.y.moves;
	w.wedge_x = modes[ESKEL_MODE_WEDGE_X] * w.x.moves;
	w.wedge_y = modes[ESKEL_MODE_WEDGE_Y] * w.y.moves;
	w.skew = modes[ESKEL_MODE_SKEW] * w.x.moves;
	w.y_scale = esk_elementary_exp_double(-modes[ESKEL_MODE_SKEW] * x);
	w.z_scale = esk_elementary_exp_double(-(modes[ESKEL_MODE_WEDGE_X] * x + modes[ESKEL_MODE_WEDGE_Y] * y));
	w.to = (esk_vector){u.x, u.y * w.y_scale, (u.z - (xx * x * x + xy * x * y + yy * y * y)) * w.z_scale};
	w.jacobian = (esk_jacobian){{1, -w.skew * w.to.y, -w.cup_x * w.z_scale - w.wedge_x * w.to.z},
		{0, w.y_scale, -w.cup_y * w.z_scale - w.wedge_y * w.to.z}, {0, 0, w.z_scale}};
	return w;
}

ESK_IN_LANES esk_jet esk_warping_pull(const esk_warping *w, const esk_jet *f)
{
	esk_jet pulled = esk_jet_pull(&w->jacobian, f);
	const double y = f->gradient.y, z = f->gradient.z, scale = w->z_scale;
	const double z_x = w->jacobian.by_x.z, z_y = w->jacobian.by_y.z;
	pulled.hessian.xx +=
		y * (w->skew * w->skew * w->to.y) + z * (w->wedge_x * (w->cup_x * scale - z_x) - w->cup_xx * scale);
	pulled.hessian.xy +=
		z * (w->cup_x * w->wedge_y * scale - w->cup_xy * scale - w->wedge_x * z_y) - y * (w->skew * w->y_scale);
	pulled.hessian.yy += z * (w->wedge_y * (w->cup_y * scale - z_y) - w->cup_yy * scale);
	pulled.hessian.xz -= z * (w->wedge_x * scale);
	pulled.hessian.yz -= z * (w->wedge_y * scale);
	return pulled;
}

/* By a mode of the cup: its factor and that one's derivatives by x and y. */
ESK_IN_LANES esk_tangent esk_warping_by_cup(
	const esk_warping *w, const esk_jet *f, double factor, double by_x, double by_y)
{
	const esk_vector v = {0, 0, -factor * w->z_scale};
	const esk_jacobian dv = {.by_x = {0, 0, -by_x * w->z_scale - w->wedge_x * v.z},
		.by_y = {0, 0, -by_y * w->z_scale - w->wedge_y * v.z}};
	return esk_jet_tangent(&w->jacobian, f, v, &dv);
}

/* By a mode of the wedge: its factor and that one's derivatives by x and y. */
ESK_IN_LANES esk_tangent esk_warping_by_wedge(
	const esk_warping *w, const esk_jet *f, double factor, double by_x, double by_y)
{
	const esk_vector v = {0, 0, -factor * w->to.z};
	const esk_jacobian dv = {{0, 0, -by_x * w->to.z - factor * w->jacobian.by_x.z},
		{0, 0, -by_y * w->to.z - factor * w->jacobian.by_y.z}, {0, 0, -factor * w->z_scale}};
	return esk_jet_tangent(&w->jacobian, f, v, &dv);
}

ESK_IN_LANES esk_tangent esk_warping_by_skew(const esk_warping *w, const esk_jet *f)
{
	const esk_vector v = {0, -w->x.at * w->to.y, 0};
	const esk_jacobian dv = {.by_x = {0, -w->x.moves * w->to.y - w->x.at * w->jacobian.by_x.y, 0},
		.by_y = {0, -w->x.at * w->y_scale, 0}};
	return esk_jet_tangent(&w->jacobian, f, v, &dv);
}

#endif
