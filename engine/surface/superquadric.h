/* The unit superquadric d = N(N(x^2, y^2; e1), z^2; e2) - 1 with N(u, v; e) = (u^(1/e) + v^(1/e))^e (section 3.4; eskel_surface.h says
 * where we differ), its gradient, Hessian and derivatives by the exponents; and the unit sphere, which is e1 = e2 = 1.
 *
 * In logarithms l_u = ln u nothing over- or underflows. With L = ln N and s = u^(1/e) / (u^(1/e) + v^(1/e)), the share of u,
 *	dL/dl_u = s, dL/dl_v = 1 - s, ds/dl_u = -ds/dl_v = s (1 - s) / e,
 *	dL/de = -s ln s - (1 - s) ln(1 - s), ds/de = -s (1 - s) (l_u - l_v) / e^2.
 * Second derivatives by x go with |x|^(2/e - 2), which is infinite at x = 0 when e > 1: so x^2 is x^2 + ROUNDING. */
#ifndef ESK_SUPERQUADRIC_H
#define ESK_SUPERQUADRIC_H

#include "elementary.h"
#include "jet.h"

/* 2^-12 of a radius: too small to see, and with e = 1.8 second derivatives stay below 2,000. */
#define ESK_ROUNDING 0x1p-24

/* N in logarithms. */
typedef struct {
	double log;         /* L */
	double share, rest; /* s, 1 - s */
	double log_sum;     /* ln(1 + smaller / larger) */
	double ratio;       /* |l_u - l_v| / e */
} esk_log_norm;

ESK_IN_LANES double esk_log_norm_ratio(double log_u, double log_v, double e)
{
	double difference = log_u - log_v;
	return (difference > 0 ? difference : -difference) / e;
}

/* The smaller of u^(1/e) and v^(1/e) over the larger. */
ESK_IN_LANES double esk_log_norm_least(double ratio)
{
	return esk_elementary_exp_double(ratio < 690 ? -ratio : -690);
}

ESK_IN_LANES esk_log_norm esk_log_norm_from(double log_u, double log_v, double e, double ratio, double least)
{
	double difference = log_u - log_v, larger = difference > 0 ? log_u : log_v;
	double sum = 1 + least, major = 1 / sum, minor = least * major, log_sum = esk_elementary_log(sum);
	return (esk_log_norm){
		larger + e * log_sum, difference > 0 ? major : minor, difference > 0 ? minor : major, log_sum, ratio};
}

ESK_IN_LANES esk_log_norm esk_log_norm_of(double log_u, double log_v, double e)
{
	double ratio = esk_log_norm_ratio(log_u, log_v, e);
	return esk_log_norm_from(log_u, log_v, e, ratio, esk_log_norm_least(ratio));
}

/* -s ln s - (1 - s) ln(1 - s): the larger share is 1 / sum, the smaller exp(-ratio) / sum. */
ESK_IN_LANES double esk_log_norm_entropy(const esk_log_norm *n)
{
	return n->log_sum + n->ratio * (n->share < n->rest ? n->share : n->rest);
}

typedef struct {
	esk_log_norm across, whole;
	double log_x, log_y, log_z;
	double size; /* d + 1 */
} esk_superquadric;

ESK_IN_LANES esk_superquadric esk_superquadric_at(esk_vector u, double e1, double e2)
{
	esk_superquadric s;
	s.log_x = esk_elementary_log(u.x * u.x + ESK_ROUNDING);
	s.log_y = esk_elementary_log(u.y * u.y + ESK_ROUNDING);
	s.log_z = esk_elementary_log(u.z * u.z + ESK_ROUNDING);
	s.across = esk_log_norm_of(s.log_x, s.log_y, e1);
	s.whole = esk_log_norm_of(s.across.log, s.log_z, e2);
	s.size = esk_elementary_exp_double(s.whole.log);
	return s;
}

/* d ln(x^2 + ROUNDING)/dx. */
ESK_IN_LANES double esk_superquadric_slope(double x)
{
	return 2 * x / (x * x + ESK_ROUNDING);
}

ESK_IN_LANES esk_vector esk_superquadric_gradient(const esk_superquadric *s, esk_vector u)
{
	const double r = s->whole.share, a = s->across.share, b = s->across.rest, size = s->size;
	return (esk_vector){size * (r * a) * esk_superquadric_slope(u.x), size * (r * b) * esk_superquadric_slope(u.y),
		size * s->whole.rest * esk_superquadric_slope(u.z)};
}

ESK_IN_LANES esk_jet esk_superquadric_jet(const esk_superquadric *s, esk_vector u, double e1, double e2)
{
	const double r = s->whole.share, a = s->across.share, b = s->across.rest, size = s->size;
	const double wx = r * a, wy = r * b, wz = s->whole.rest; /* dL by the three logarithms */
	const double hx = esk_superquadric_slope(u.x), hy = esk_superquadric_slope(u.y),
		     hz = esk_superquadric_slope(u.z);
	const double outer = r * wz / e2, inner = r * a * b / e1;
	/* d(hx)/dx = 2 / X - hx^2. */
	const double xx = 2 * wx / (u.x * u.x + ESK_ROUNDING) + (wx * wx + outer * a * a + inner - wx) * hx * hx;
	const double yy = 2 * wy / (u.y * u.y + ESK_ROUNDING) + (wy * wy + outer * b * b + inner - wy) * hy * hy;
	const double zz = 2 * wz / (u.z * u.z + ESK_ROUNDING) + (wz * wz + outer - wz) * hz * hz;
	return (esk_jet){.value = size - 1,
		.gradient = esk_superquadric_gradient(s, u),
		.hessian = {size * xx, size * (wx * wy + outer * a * b - inner) * hx * hy,
			size * (wx * wz - outer * a) * hx * hz, size * yy, size * (wy * wz - outer * b) * hy * hz,
			size * zz}};
}

/* By e1. */
ESK_IN_LANES esk_tangent esk_superquadric_by_section(const esk_superquadric *s, esk_vector u, double e1, double e2)
{
	const double r = s->whole.share, a = s->across.share, b = s->across.rest, wz = s->whole.rest;
	const double entropy = esk_log_norm_entropy(&s->across), log = r * entropy;
	const double a_by = -a * b * (s->log_x - s->log_y) / (e1 * e1), r_by = r * wz / e2 * entropy;
	return (esk_tangent){
		s->size * log, {s->size * esk_superquadric_slope(u.x) * (log * (r * a) + r_by * a + r * a_by),
				       s->size * esk_superquadric_slope(u.y) * (log * (r * b) + r_by * b - r * a_by),
				       s->size * esk_superquadric_slope(u.z) * (log * wz - r_by)}};
}

/* By e2. */
ESK_IN_LANES esk_tangent esk_superquadric_by_profile(const esk_superquadric *s, esk_vector u, double e2)
{
	const double r = s->whole.share, a = s->across.share, b = s->across.rest, wz = s->whole.rest;
	const double log = esk_log_norm_entropy(&s->whole);
	const double r_by = -r * wz * (s->across.log - s->log_z) / (e2 * e2);
	return (esk_tangent){s->size * log, {s->size * esk_superquadric_slope(u.x) * a * (log * r + r_by),
						    s->size * esk_superquadric_slope(u.y) * b * (log * r + r_by),
						    s->size * esk_superquadric_slope(u.z) * (log * wz - r_by)}};
}

ESK_IN_LANES esk_jet esk_sphere_jet(esk_vector u)
{
	return (esk_jet){
		.value = esk_dot(u, u) - 1, .gradient = {2 * u.x, 2 * u.y, 2 * u.z}, .hessian = {2, 0, 0, 2, 0, 2}};
}

#endif
