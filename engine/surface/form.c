/* One chain of maps (eskel_surface.h), evaluated lane by lane: values forwards, gradients and Hessians backwards (jet.h). Steps that
 * change nothing are left out, which changes no bit: with modes of 0 they are exactly the identity. */
#include "form.h"

#include "chain.h"
#include "superquadric.h"

#include <string.h>

void esk_form_make(const eskel_primitive *primitive, esk_form *form)
{
	*form = (esk_form){.length = primitive->radii[2]};
	memcpy(form->centre, primitive->centre, sizeof form->centre);
	memcpy(form->exponents, primitive->exponents, sizeof form->exponents);
	memcpy(form->modes, primitive->modes, sizeof form->modes);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			form->to_frame[k][i] = primitive->axes[k][i] / form->length;
	for (int i = 0; i < 2; i++)
		form->widening[i] = form->length / primitive->radii[i];
	for (int i = 0; i < ESKEL_MODE_COUNT; i++)
		if (primitive->modes[i] != 0 && form->steps != ESK_WARPED)
			form->steps = i < ESKEL_MODE_CUP_XX ? ESK_BENT : ESK_WARPED;
	form->is_superquadric = primitive->exponents[0] != 1 || primitive->exponents[1] != 1;
}

ESK_IN_LANES double value_of(const esk_form *form, double x, double y, double z, esk_steps steps, bool superquadric)
{
	const esk_chain c = esk_chain_follow(form, x, y, z, steps);
	return superquadric ? esk_superquadric_at(c.unit, form->exponents[0], form->exponents[1]).size - 1
			    : esk_dot(c.unit, c.unit) - 1;
}

ESK_IN_LANES esk_jet measure(const esk_form *form, esk_vector unit, bool superquadric)
{
	if (!superquadric)
		return esk_sphere_jet(unit);
	const double e1 = form->exponents[0], e2 = form->exponents[1];
	const esk_superquadric s = esk_superquadric_at(unit, e1, e2);
	return esk_superquadric_jet(&s, unit, e1, e2);
}

ESK_IN_LANES double gradient_of(
	const esk_form *form, double x, double y, double z, esk_steps steps, bool superquadric, esk_vector *gradient)
{
	const esk_chain c = esk_chain_follow(form, x, y, z, steps);
	const esk_jet measured = measure(form, c.unit, superquadric);
	*gradient = esk_chain_pull(form, &c, measured.gradient, steps);
	return measured.value;
}

/* A call for each way, with its steps and its measure as constants. */
#define EACH_WAY(form, call) \
	switch ((form)->steps) { \
	case ESK_RIGID: \
		if ((form)->is_superquadric) { \
			call(ESK_RIGID, true); \
		} else { \
			call(ESK_RIGID, false); \
		} \
		break; \
	case ESK_BENT: \
		if ((form)->is_superquadric) { \
			call(ESK_BENT, true); \
		} else { \
			call(ESK_BENT, false); \
		} \
		break; \
	case ESK_WARPED: \
		if ((form)->is_superquadric) { \
			call(ESK_WARPED, true); \
		} else { \
			call(ESK_WARPED, false); \
		} \
		break; \
	}

ESK_EVERY_WIDTH void esk_form_values(
	const esk_form *form, size_t blocks, const esk_lanes (*points)[3], esk_lanes *values)
{
#define VALUES(steps, superquadric) \
	for (size_t b = 0; b < blocks; b++) \
		ESK_EACH_LANE (l) \
	values[b][l] = value_of(form, points[b][0][l], points[b][1][l], points[b][2][l], steps, superquadric)
	EACH_WAY(form, VALUES)
#undef VALUES
}

ESK_EVERY_WIDTH void esk_form_gradients(
	const esk_form *form, size_t blocks, const esk_lanes (*points)[3], esk_lanes *values, esk_lanes (*gradients)[3])
{
#define GRADIENTS(steps, superquadric) \
	for (size_t b = 0; b < blocks; b++) \
		ESK_EACH_LANE (l) { \
			const esk_lanes *p = points[b]; \
			esk_vector g; \
			values[b][l] = gradient_of(form, p[0][l], p[1][l], p[2][l], steps, superquadric, &g); \
			gradients[b][0][l] = g.x; \
			gradients[b][1][l] = g.y; \
			gradients[b][2][l] = g.z; \
		}
	EACH_WAY(form, GRADIENTS)
#undef GRADIENTS
}

/* The jets before each step. */
typedef struct {
	esk_jet unit, scaled, bent, frame;
} jets;

ESK_IN_LANES jets pull(const esk_form *form, const esk_chain *c, esk_steps steps, bool superquadric)
{
	jets j;
	j.unit = measure(form, c->unit, superquadric);
	j.scaled = steps == ESK_WARPED ? esk_warping_pull(&c->warping, &j.unit) : j.unit;
	j.bent = esk_scaling_pull(&c->scaling, &j.scaled);
	j.frame = esk_bending_pull(&c->bending, &j.bent);
	return j;
}

/* Writes a tangent whose gradient is in the frame. */
ESK_IN_LANES void put(const esk_form *form, esk_tangent t, esk_derivatives *out, int parameter, int l)
{
	const esk_vector g = esk_chain_to_world(form, t.gradient);
	out->value_by[parameter][l] = t.value;
	out->gradient_by[parameter][0][l] = g.x;
	out->gradient_by[parameter][1][l] = g.y;
	out->gradient_by[parameter][2][l] = g.z;
}

/* Translation and rotation. They move q by -e_k / c and q x e_k. */
ESK_IN_LANES void put_motion(const esk_form *form, const esk_chain *c, const esk_jet *f, esk_derivatives *out, int l)
{
	const esk_vector q = c->in_frame, g = f->gradient;
	const esk_symmetric h = f->hessian;
	const double s = -1 / form->length;
	put(form, (esk_tangent){s * g.x, {s * h.xx, s * h.xy, s * h.xz}}, out, ESK_TRANSLATION, l);
	put(form, (esk_tangent){s * g.y, {s * h.xy, s * h.yy, s * h.yz}}, out, ESK_TRANSLATION + 1, l);
	put(form, (esk_tangent){s * g.z, {s * h.xz, s * h.yz, s * h.zz}}, out, ESK_TRANSLATION + 2, l);
	const esk_vector about_x = {0, q.z, -q.y}, about_y = {-q.z, 0, q.x}, about_z = {q.y, -q.x, 0};
	/* The gradient of g.(q x e) but through g is e x g. */
	const esk_vector x = esk_symmetric_apply(h, about_x), y = esk_symmetric_apply(h, about_y);
	const esk_vector z = esk_symmetric_apply(h, about_z);
	put(form, (esk_tangent){esk_dot(g, about_x), {x.x, x.y - g.z, x.z + g.y}}, out, ESK_ROTATION, l);
	put(form, (esk_tangent){esk_dot(g, about_y), {y.x + g.z, y.y, y.z - g.x}}, out, ESK_ROTATION + 1, l);
	put(form, (esk_tangent){esk_dot(g, about_z), {z.x - g.y, z.y + g.x, z.z}}, out, ESK_ROTATION + 2, l);
}

/* ln a and ln b change widths over c, ln c these and q, which it moves by -q. */
ESK_IN_LANES void put_radii(const esk_form *form, const esk_chain *c, const jets *j, esk_derivatives *out, int l)
{
	const esk_jacobian *bending = &c->bending.jacobian;
	const esk_tangent a = esk_tangent_pull(bending, esk_scaling_by_x(&c->scaling, &j->scaled, 0));
	const esk_tangent b = esk_tangent_pull(bending, esk_scaling_by_y(&c->scaling, &j->scaled, 0));
	const esk_vector q = c->in_frame, g = j->frame.gradient, h = esk_symmetric_apply(j->frame.hessian, q);
	put(form, a, out, ESK_LOG_RADII, l);
	put(form, b, out, ESK_LOG_RADII + 1, l);
	put(form,
		(esk_tangent){-esk_dot(g, q) - a.value - b.value,
			{-h.x - g.x - a.gradient.x - b.gradient.x, -h.y - g.y - a.gradient.y - b.gradient.y,
				-h.z - g.z - a.gradient.z - b.gradient.z}},
		out, ESK_LOG_RADII + 2, l);
}

enum { FURTHER = ESK_FURTHER_MODES - ESK_FIRST_MODE_COUNT }; /* from a further mode to its parameter */

/* Modes of step 2. */
ESK_IN_LANES void put_bending(
	const esk_form *form, const esk_chain *c, const esk_jet *bent, bool further, esk_derivatives *out, int l)
{
	const esk_bending *b = &c->bending;
	put(form, esk_bending_by_bend(b, bent, 1, 0, 2), out, ESK_FIRST_MODES + ESKEL_MODE_BEND_X, l);
	put(form, esk_bending_by_bend(b, bent, 0, 1, 2), out, ESK_FIRST_MODES + ESKEL_MODE_BEND_Y, l);
	put(form, esk_bending_by_twist(b, bent, 1), out, ESK_FIRST_MODES + ESKEL_MODE_TWIST, l);
	if (!further)
		return;
	put(form, esk_bending_by_bend(b, bent, 1, 0, 3), out, FURTHER + ESKEL_MODE_BEND3_X, l);
	put(form, esk_bending_by_bend(b, bent, 0, 1, 3), out, FURTHER + ESKEL_MODE_BEND3_Y, l);
	put(form, esk_bending_by_bend(b, bent, 1, 0, 4), out, FURTHER + ESKEL_MODE_BEND4_X, l);
	put(form, esk_bending_by_bend(b, bent, 0, 1, 4), out, FURTHER + ESKEL_MODE_BEND4_Y, l);
	put(form, esk_bending_by_twist(b, bent, 2), out, FURTHER + ESKEL_MODE_TWIST2, l);
	put(form, esk_bending_by_twist(b, bent, 3), out, FURTHER + ESKEL_MODE_TWIST3, l);
}

/* Modes of step 3. */
ESK_IN_LANES void put_scaling(
	const esk_form *form, const esk_chain *c, const esk_jet *scaled, bool further, esk_derivatives *out, int l)
{
	const esk_scaling *s = &c->scaling;
	const esk_jacobian *j = &c->bending.jacobian;
	put(form, esk_tangent_pull(j, esk_scaling_by_x(s, scaled, 1)), out, ESK_FIRST_MODES + ESKEL_MODE_TAPER_X, l);
	put(form, esk_tangent_pull(j, esk_scaling_by_y(s, scaled, 1)), out, ESK_FIRST_MODES + ESKEL_MODE_TAPER_Y, l);
	if (!further)
		return;
	put(form, esk_tangent_pull(j, esk_scaling_by_x(s, scaled, 2)), out, FURTHER + ESKEL_MODE_BULGE_X, l);
	put(form, esk_tangent_pull(j, esk_scaling_by_y(s, scaled, 2)), out, FURTHER + ESKEL_MODE_BULGE_Y, l);
	put(form, esk_tangent_pull(j, esk_scaling_by_x(s, scaled, 3)), out, FURTHER + ESKEL_MODE_TAPER3_X, l);
	put(form, esk_tangent_pull(j, esk_scaling_by_y(s, scaled, 3)), out, FURTHER + ESKEL_MODE_TAPER3_Y, l);
}

ESK_IN_LANES esk_tangent before_scaling(const esk_chain *c, esk_tangent t)
{
	return esk_tangent_pull(&c->bending.jacobian, esk_tangent_pull(&c->scaling.jacobian, t));
}

/* Modes of step 4. */
ESK_IN_LANES void put_warping(
	const esk_form *form, const esk_chain *c, const esk_jet *unit, esk_derivatives *out, int l)
{
	const esk_warping *w = &c->warping;
	const double x = w->x.at, y = w->y.at, by_x = w->x.moves, by_y = w->y.moves;
	const esk_tangent xx = esk_warping_by_cup(w, unit, x * x, 2 * x * by_x, 0);
	const esk_tangent xy = esk_warping_by_cup(w, unit, x * y, y * by_x, x * by_y);
	const esk_tangent yy = esk_warping_by_cup(w, unit, y * y, 0, 2 * y * by_y);
	put(form, before_scaling(c, xx), out, FURTHER + ESKEL_MODE_CUP_XX, l);
	put(form, before_scaling(c, xy), out, FURTHER + ESKEL_MODE_CUP_XY, l);
	put(form, before_scaling(c, yy), out, FURTHER + ESKEL_MODE_CUP_YY, l);
	put(form, before_scaling(c, esk_warping_by_wedge(w, unit, x, by_x, 0)), out, FURTHER + ESKEL_MODE_WEDGE_X, l);
	put(form, before_scaling(c, esk_warping_by_wedge(w, unit, y, 0, by_y)), out, FURTHER + ESKEL_MODE_WEDGE_Y, l);
	put(form, before_scaling(c, esk_warping_by_skew(w, unit)), out, FURTHER + ESKEL_MODE_SKEW, l);
}

ESK_IN_LANES void put_exponents(const esk_form *form, const esk_chain *c, esk_steps steps, esk_derivatives *out, int l)
{
	const double e1 = form->exponents[0], e2 = form->exponents[1];
	const esk_superquadric s = esk_superquadric_at(c->unit, e1, e2);
	esk_tangent section = esk_superquadric_by_section(&s, c->unit, e1, e2);
	esk_tangent profile = esk_superquadric_by_profile(&s, c->unit, e2);
	if (steps == ESK_WARPED) {
		section = esk_tangent_pull(&c->warping.jacobian, section);
		profile = esk_tangent_pull(&c->warping.jacobian, profile);
	}
	put(form, before_scaling(c, section), out, ESK_EXPONENTS, l);
	put(form, before_scaling(c, profile), out, ESK_EXPONENTS + 1, l);
}

ESK_IN_LANES void derive_lane(const esk_form *form, const esk_lanes point[3], esk_steps steps, bool superquadric,
	bool further, esk_derivatives *out, int l)
{
	const esk_chain c = esk_chain_follow(form, point[0][l], point[1][l], point[2][l], steps);
	const jets j = pull(form, &c, steps, superquadric);
	const esk_vector g = esk_chain_to_world(form, j.frame.gradient);
	out->value[l] = j.unit.value;
	out->gradient[0][l] = g.x;
	out->gradient[1][l] = g.y;
	out->gradient[2][l] = g.z;
	put_motion(form, &c, &j.frame, out, l);
	put_radii(form, &c, &j, out, l);
	put_bending(form, &c, &j.bent, further, out, l);
	put_scaling(form, &c, &j.scaled, further, out, l);
	put(form, (esk_tangent){0}, out, ESK_ALPHA, l);
	if (superquadric)
		put_exponents(form, &c, steps, out, l);
	if (further)
		put_warping(form, &c, &j.unit, out, l);
}

ESK_EVERY_WIDTH static void derive_smooth(const esk_form *form, const esk_lanes point[3], esk_derivatives *out)
{
	ESK_EACH_LANE (l)
		derive_lane(form, point, ESK_BENT, false, false, out, l);
}

ESK_EVERY_WIDTH static void derive_usual(const esk_form *form, const esk_lanes point[3], esk_derivatives *out)
{
	ESK_EACH_LANE (l)
		derive_lane(form, point, ESK_BENT, true, false, out, l);
}

ESK_EVERY_WIDTH static void derive_all(const esk_form *form, const esk_lanes point[3], esk_derivatives *out)
{
	ESK_EACH_LANE (l)
		derive_lane(form, point, ESK_WARPED, true, true, out, l);
}

void esk_form_derive(const esk_form *form, const esk_lanes point[3], size_t count, esk_derivatives *derivatives)
{
	if (count > ESK_PARAMETERS_USUAL || form->steps == ESK_WARPED)
		derive_all(form, point, derivatives);
	else if (count > ESK_PARAMETERS_SMOOTH || form->is_superquadric)
		derive_usual(form, point, derivatives);
	else
		derive_smooth(form, point, derivatives);
}
