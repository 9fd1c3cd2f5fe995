/* A function of three coordinates with its gradient and Hessian, and how they change when its argument does.
 *
 * Of F(f(x)) the gradient is J^T g and the Hessian J^T H J + sum_i g_i (Hessian of f_i), with g and H those of F at f(x) and
 * J the Jacobian of f. A parameter t of f moves f(x) by v = df/dt, so that F grows by g.v, and the gradient of that is
 * J^T H v + (dv/dx)^T g. Nothing but such products is needed for the derivatives of a chain of maps, by each parameter of
 * each map, of the value and of the gradient.
 *
 * Plain numbers of one point: loops over lanes (lanes.h) make vectors of them, and what is not asked for is not computed. */
#ifndef ESK_JET_H
#define ESK_JET_H

#include "lanes.h"

typedef struct {
	double x, y, z;
} esk_vector;

typedef struct {
	double xx, xy, xz, yy, yz, zz;
} esk_symmetric;

/* The derivative of a vector by each coordinate. */
typedef struct {
	esk_vector by_x, by_y, by_z;
} esk_jacobian;

typedef struct {
	double value;
	esk_vector gradient;
	esk_symmetric hessian;
} esk_jet;

/* The derivative by a parameter of a value and of its gradient. */
typedef struct {
	double value;
	esk_vector gradient;
} esk_tangent;

ESK_IN_LANES double esk_dot(esk_vector a, esk_vector b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

ESK_IN_LANES esk_vector esk_vector_sum(esk_vector a, esk_vector b)
{
	return (esk_vector){a.x + b.x, a.y + b.y, a.z + b.z};
}

ESK_IN_LANES esk_vector esk_symmetric_apply(esk_symmetric h, esk_vector v)
{
	return (esk_vector){h.xx * v.x + h.xy * v.y + h.xz * v.z, h.xy * v.x + h.yy * v.y + h.yz * v.z,
		h.xz * v.x + h.yz * v.y + h.zz * v.z};
}

/* J^T v. */
ESK_IN_LANES esk_vector esk_jacobian_pull(const esk_jacobian *j, esk_vector v)
{
	return (esk_vector){esk_dot(j->by_x, v), esk_dot(j->by_y, v), esk_dot(j->by_z, v)};
}

/* The jet of F(f(x)) but for the Hessians of f. */
ESK_IN_LANES esk_jet esk_jet_pull(const esk_jacobian *j, const esk_jet *f)
{
	esk_vector x = esk_symmetric_apply(f->hessian, j->by_x), y = esk_symmetric_apply(f->hessian, j->by_y);
	esk_vector z = esk_symmetric_apply(f->hessian, j->by_z);
	return (esk_jet){.value = f->value,
		.gradient = esk_jacobian_pull(j, f->gradient),
		.hessian = {esk_dot(j->by_x, x), esk_dot(j->by_x, y), esk_dot(j->by_x, z), esk_dot(j->by_y, y),
			esk_dot(j->by_y, z), esk_dot(j->by_z, z)}};
}

/* By a parameter of f that moves f(x) by v. */
ESK_IN_LANES esk_tangent esk_jet_tangent(const esk_jacobian *j, const esk_jet *f, esk_vector v, const esk_jacobian *dv)
{
	esk_vector through_point = esk_jacobian_pull(j, esk_symmetric_apply(f->hessian, v));
	return (esk_tangent){
		esk_dot(f->gradient, v), esk_vector_sum(through_point, esk_jacobian_pull(dv, f->gradient))};
}

/* The same, before a further map with the Jacobian j. */
ESK_IN_LANES esk_tangent esk_tangent_pull(const esk_jacobian *j, esk_tangent t)
{
	return (esk_tangent){t.value, esk_jacobian_pull(j, t.gradient)};
}

#endif
