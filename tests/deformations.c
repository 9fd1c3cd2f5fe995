#include "deformations.h"

#include "deformation.h"

static esk_vector unwarp(const double *modes, esk_vector u)
{
	const esk_reached x = esk_reach(u.x);
	u.y /= esk_elementary_exp_double(-modes[ESKEL_MODE_SKEW] * x.at);
	const esk_reached y = esk_reach(u.y);
	u.z /= esk_elementary_exp_double(-(modes[ESKEL_MODE_WEDGE_X] * x.at + modes[ESKEL_MODE_WEDGE_Y] * y.at));
	u.z += modes[ESKEL_MODE_CUP_XX] * x.at * x.at + modes[ESKEL_MODE_CUP_XY] * x.at * y.at +
	       modes[ESKEL_MODE_CUP_YY] * y.at * y.at;
	return u;
}

static esk_vector unscale(const double *modes, const double *widening, esk_vector u)
{
	const esk_turns turns = esk_turns_at(modes, u.z);
	const esk_scaling s = esk_scaling_at(modes, widening, u, turns); /* its scales depend on z alone */
	return (esk_vector){u.x / s.x_scale, u.y / s.y_scale, u.z};
}

static esk_vector unbend(const double *modes, esk_vector u)
{
	/* Where the axis goes, and the turn there. */
	const esk_turns turns = esk_turns_at(modes, u.z);
	const esk_bending b = esk_bending_at(modes, (esk_vector){0, 0, u.z}, turns);
	const double x = u.x - b.to.x, y = u.y - b.to.y;
	return (esk_vector){b.cosine * x - b.sine * y, b.sine * x + b.cosine * y, u.z};
}

void deformations_undo(const esk_form *form, const double unit[3], double world[3])
{
	esk_vector u = unwarp(form->modes, (esk_vector){unit[0], unit[1], unit[2]});
	u = unbend(form->modes, unscale(form->modes, form->widening, u));
	const double squared = form->length * form->length; /* the inverse of axes / c is their transpose times c^2 */
	for (int i = 0; i < 3; i++)
		world[i] = form->centre[i] + squared * (form->to_frame[0][i] * u.x + form->to_frame[1][i] * u.y +
							       form->to_frame[2][i] * u.z);
}
