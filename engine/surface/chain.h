/* The chain of maps from the world to the unit superquadric (eskel_surface.h), at one point, and gradients back along it. */
#ifndef ESK_CHAIN_H
#define ESK_CHAIN_H

#include "deformation.h"
#include "form.h"

/* Step 1. */
ESK_IN_LANES esk_vector esk_chain_to_frame(const esk_form *form, double x, double y, double z)
{
	const double(*m)[3] = form->to_frame;
	x -= form->centre[0];
	y -= form->centre[1];
	z -= form->centre[2];
	return (esk_vector){m[0][0] * x + m[0][1] * y + m[0][2] * z, m[1][0] * x + m[1][1] * y + m[1][2] * z,
		m[2][0] * x + m[2][1] * y + m[2][2] * z};
}

/* A gradient back to world coordinates. */
ESK_IN_LANES esk_vector esk_chain_to_world(const esk_form *form, esk_vector g)
{
	const double(*m)[3] = form->to_frame;
	return (esk_vector){m[0][0] * g.x + m[1][0] * g.y + m[2][0] * g.z,
		m[0][1] * g.x + m[1][1] * g.y + m[2][1] * g.z, m[0][2] * g.x + m[1][2] * g.y + m[2][2] * g.z};
}

typedef struct {
	esk_vector in_frame;
	esk_bending bending;
	esk_scaling scaling;
	esk_warping warping;
	esk_vector unit;
} esk_chain;

ESK_IN_LANES esk_chain esk_chain_turned(
	const esk_form *form, double x, double y, double z, esk_steps steps, esk_turns turns)
{
	esk_chain c;
	c.in_frame = esk_chain_to_frame(form, x, y, z);
	if (steps == ESK_RIGID) {
		c.unit = (esk_vector){form->widening[0] * c.in_frame.x, form->widening[1] * c.in_frame.y, c.in_frame.z};
		return c;
	}
	c.bending = esk_bending_at(form->modes, c.in_frame, turns);
	c.scaling = esk_scaling_at(form->modes, form->widening, c.bending.to, turns);
	c.unit = c.scaling.to;
	if (steps == ESK_WARPED) {
		c.warping = esk_warping_at(form->modes, c.scaling.to);
		c.unit = c.warping.to;
	}
	return c;
}

ESK_IN_LANES esk_chain esk_chain_follow(const esk_form *form, double x, double y, double z, esk_steps steps)
{
	esk_turns turns = {0};
	if (steps != ESK_RIGID)
		turns = esk_turns_at(form->modes, esk_chain_to_frame(form, x, y, z).z);
	return esk_chain_turned(form, x, y, z, steps, turns);
}

/* A gradient in the unit superquadric back to world coordinates. */
ESK_IN_LANES esk_vector esk_chain_pull(const esk_form *form, const esk_chain *c, esk_vector g, esk_steps steps)
{
	if (steps == ESK_RIGID)
		g = (esk_vector){form->widening[0] * g.x, form->widening[1] * g.y, g.z};
	if (steps == ESK_WARPED)
		g = esk_jacobian_pull(&c->warping.jacobian, g);
	if (steps != ESK_RIGID)
		g = esk_jacobian_pull(&c->bending.jacobian, esk_jacobian_pull(&c->scaling.jacobian, g));
	return esk_chain_to_world(form, g);
}

#endif
