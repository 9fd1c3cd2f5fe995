/* The potential of a superquadric is a chain of three logarithms and three exponentials, each of which waits for the one
 * before, and processors look ahead no further than to the next block of eight points. Here each link of the chain is a loop
 * of its own over the whole strip, so that eight blocks are under way at once. Loops that follow the chain of maps call a
 * function for it: of a chain declared in the loop itself gcc makes an array over lanes, and no vector code. */
#include "strip.h"

#include "chain.h"
#include "superquadric.h"

/* Norms N are not less than the greater of their arguments. */
ESK_IN_LANES double floor_of(esk_vector u)
{
	const double x = u.x * u.x, y = u.y * u.y, z = u.z * u.z, across = x > y ? x : y;
	return (across > z ? across : z) - 1;
}

ESK_IN_LANES void put(esk_vector v, esk_strip to[3], int l)
{
	to[0][l] = v.x;
	to[1][l] = v.y;
	to[2][l] = v.z;
}

ESK_IN_LANES esk_vector at(const esk_strip from[3], int l)
{
	return (esk_vector){from[0][l], from[1][l], from[2][l]};
}

ESK_IN_LANES void turn_lane(const esk_form *form, const esk_strip p[3], esk_strip_place *place, int l)
{
	const esk_turns turns = esk_turns_at(form->modes, esk_chain_to_frame(form, p[0][l], p[1][l], p[2][l]).z);
	place->sine[l] = turns.sine;
	place->cosine[l] = turns.cosine;
	place->x_taper[l] = turns.x_taper;
	place->y_taper[l] = turns.y_taper;
}

ESK_EVERY_WIDTH static void turn(const esk_form *form, esk_strip_place *place)
{
	const esk_strip *point = place->point;
	ESK_EACH_OF_STRIP (l)
		turn_lane(form, point, place, l);
}

ESK_IN_LANES esk_chain follow(
	const esk_form *form, const esk_strip p[3], const esk_strip_place *place, esk_steps steps, int l)
{
	const esk_turns turns = {place->sine[l], place->cosine[l], place->x_taper[l], place->y_taper[l]};
	return esk_chain_turned(form, p[0][l], p[1][l], p[2][l], steps, turns);
}

ESK_IN_LANES void locate_lane(
	const esk_form *form, const esk_strip point[3], esk_strip_place *place, esk_steps steps, int l)
{
	const esk_chain c = follow(form, point, place, steps, l);
	put(c.unit, place->unit, l);
	place->floor[l] = floor_of(c.unit);
}

ESK_IN_LANES void pull_lane(const esk_form *form, const esk_strip point[3], const esk_strip_place *place,
	esk_steps steps, esk_strip gradients[3], int l)
{
	const esk_chain c = follow(form, point, place, steps, l);
	put(esk_chain_pull(form, &c, at((const esk_strip *)gradients, l), steps), gradients, l);
}

/* With the steps as a constant. */
#define EACH_STEPS(form, call) \
	switch ((form)->steps) { \
	case ESK_RIGID: \
		ESK_EACH_OF_STRIP (l) \
			call(ESK_RIGID); \
		break; \
	case ESK_BENT: \
		ESK_EACH_OF_STRIP (l) \
			call(ESK_BENT); \
		break; \
	case ESK_WARPED: \
		ESK_EACH_OF_STRIP (l) \
			call(ESK_WARPED); \
		break; \
	}

ESK_EVERY_WIDTH static void locate(const esk_form *form, esk_strip_place *place)
{
	const esk_strip *point = place->point;
#define LOCATE(steps) locate_lane(form, point, place, steps, l)
	EACH_STEPS(form, LOCATE)
#undef LOCATE
}

ESK_EVERY_WIDTH static void pull(const esk_form *form, const esk_strip_place *place, esk_strip gradients[3])
{
	const esk_strip *point = place->point;
#define PULL(steps) pull_lane(form, point, place, steps, gradients, l)
	EACH_STEPS(form, PULL)
#undef PULL
}

void esk_strip_locate(const esk_form *form, const esk_strip point[3], esk_strip_place *place)
{
	place->point = point;
	if (form->steps != ESK_RIGID)
		turn(form, place);
	locate(form, place);
}

ESK_IN_LANES void take_logarithms(const esk_strip u, esk_strip logarithms)
{
	ESK_EACH_OF_STRIP (l)
		logarithms[l] = esk_elementary_log(u[l] * u[l] + ESK_ROUNDING);
}

typedef struct {
	esk_strip log, share, rest;
} norms;

ESK_IN_LANES void take_norms(const esk_strip log_u, const esk_strip log_v, double e, norms *n)
{
	esk_strip least;
	ESK_EACH_OF_STRIP (l)
		least[l] = esk_log_norm_least(esk_log_norm_ratio(log_u[l], log_v[l], e));
	ESK_EACH_OF_STRIP (l) {
		const esk_log_norm norm = esk_log_norm_from(log_u[l], log_v[l], e, 0, least[l]);
		n->log[l] = norm.log;
		n->share[l] = norm.share;
		n->rest[l] = norm.rest;
	}
}

/* In the unit superquadric. */
ESK_EVERY_WIDTH static void take_superquadric(
	const esk_form *form, const esk_strip u[3], esk_strip values, esk_strip gradients[3])
{
	esk_strip x, y, z;
	norms across, whole;
	take_logarithms(u[0], x);
	take_logarithms(u[1], y);
	take_logarithms(u[2], z);
	take_norms(x, y, form->exponents[0], &across);
	take_norms(across.log, z, form->exponents[1], &whole);
	ESK_EACH_OF_STRIP (l) {
		const esk_superquadric s = {.across = {.share = across.share[l], .rest = across.rest[l]},
			.whole = {.share = whole.share[l], .rest = whole.rest[l]},
			.size = esk_elementary_exp_double(whole.log[l])};
		values[l] = s.size - 1;
		put(esk_superquadric_gradient(&s, at(u, l)), gradients, l);
	}
}

ESK_EVERY_WIDTH static void take_ball(const esk_strip u[3], esk_strip values, esk_strip gradients[3])
{
	ESK_EACH_OF_STRIP (l) {
		const esk_jet ball = esk_sphere_jet(at(u, l));
		values[l] = ball.value;
		put(ball.gradient, gradients, l);
	}
}

void esk_strip_gradients(const esk_form *form, const esk_strip_place *place, esk_strip values, esk_strip gradients[3])
{
	if (form->is_superquadric)
		take_superquadric(form, place->unit, values, gradients);
	else
		take_ball(place->unit, values, gradients);
	pull(form, place, gradients);
}
