/* The oracle is the definition in eskel_surface.h, written again in long double as directly as it reads, with the C library's
 * functions, and differences of it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "deformations.h"
#include "form.h"
#include "synthetic.h"

#include <math.h>
#include <string.h>

typedef long double real;

static real uniform(uint64_t *state, real least, real most)
{
	return least + (most - least) * (real)synthetic_uniform(state);
}

static real reach(real x)
{
	return fminl(fmaxl(x, -1.25L), 1.25L);
}

static real norm(real u, real v, real e)
{
	return powl(powl(u, 1 / e) + powl(v, 1 / e), e);
}

/* Turns the axes about a rotation vector along themselves: e_k becomes exp(vector) e_k. */
static void turn(const double axes[3][3], const real vector[3], real turned[3][3])
{
	real angle = sqrtl(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
	real n[3] = {0, 0, 1}, matrix[3][3];
	for (int i = 0; i < 3 && angle > 0; i++)
		n[i] = vector[i] / angle;
	const real cross[3][3] = {{0, -n[2], n[1]}, {n[2], 0, -n[0]}, {-n[1], n[0], 0}};
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			matrix[r][c] =
				(r == c) * cosl(angle) + (1 - cosl(angle)) * n[r] * n[c] + sinl(angle) * cross[r][c];
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			turned[k][i] =
				matrix[0][k] * axes[0][i] + matrix[1][k] * axes[1][i] + matrix[2][k] * axes[2][i];
}

/* The potential of the primitive after a step; rounded: as a superquadric's, with its creases rounded. */
static real potential(const eskel_primitive *p, const real step[ESK_PARAMETERS_ALL], const real point[3], bool rounded)
{
	real axes[3][3], m[ESKEL_MODE_COUNT], radii[3], q[3] = {0};
	turn(p->axes, step + ESK_ROTATION, axes);
	for (int i = 0; i < ESKEL_MODE_COUNT; i++)
		m[i] = p->modes[i] + step[i < 5 ? 9 + i : 12 + i];
	for (int k = 0; k < 3; k++)
		radii[k] = p->radii[k] * expl(step[ESK_LOG_RADII + k]);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			q[k] += axes[k][i] *
				(point[i] - p->centre[i] - step[0] * p->axes[0][i] - step[1] * p->axes[1][i] -
					step[2] * p->axes[2][i]) /
				radii[2];
	real t = reach(q[2]);
	real x = q[0] - (m[ESKEL_MODE_BEND_X] * t * t + m[ESKEL_MODE_BEND3_X] * t * t * t +
				m[ESKEL_MODE_BEND4_X] * t * t * t * t);
	real y = q[1] - (m[ESKEL_MODE_BEND_Y] * t * t + m[ESKEL_MODE_BEND3_Y] * t * t * t +
				m[ESKEL_MODE_BEND4_Y] * t * t * t * t);
	real turned = -(m[ESKEL_MODE_TWIST] * t + m[ESKEL_MODE_TWIST2] * t * t + m[ESKEL_MODE_TWIST3] * t * t * t);
	real u = x * cosl(turned) - y * sinl(turned), v = x * sinl(turned) + y * cosl(turned), w = q[2];
	u *= radii[2] / radii[0] *
	     expl(-(m[ESKEL_MODE_TAPER_X] * t + m[ESKEL_MODE_BULGE_X] * t * t + m[ESKEL_MODE_TAPER3_X] * t * t * t));
	v *= radii[2] / radii[1] *
	     expl(-(m[ESKEL_MODE_TAPER_Y] * t + m[ESKEL_MODE_BULGE_Y] * t * t + m[ESKEL_MODE_TAPER3_Y] * t * t * t));
	real a = reach(u), b = reach(v);
	v *= expl(-m[ESKEL_MODE_SKEW] * a);
	w -= m[ESKEL_MODE_CUP_XX] * a * a + m[ESKEL_MODE_CUP_XY] * a * b + m[ESKEL_MODE_CUP_YY] * b * b;
	w *= expl(-(m[ESKEL_MODE_WEDGE_X] * a + m[ESKEL_MODE_WEDGE_Y] * b));
	if (!rounded)
		return u * u + v * v + w * w - 1;
	const real soft = 0x1p-24L, e1 = p->exponents[0] + step[15], e2 = p->exponents[1] + step[16];
	return norm(norm(u * u + soft, v * v + soft, e1), w * w + soft, e2) - 1;
}

/* Central differences of the fourth order. */
static real slope(const eskel_primitive *p, const real point[3], bool rounded, int coordinate, int parameter)
{
	/* Truncation h^4 against rounding 1e-19 / h. */
	const real h = 2e-5L;
	const real weights[4] = {1 / 12.0L, -2 / 3.0L, 2 / 3.0L, -1 / 12.0L}, offsets[4] = {-2, -1, 1, 2};
	real sum = 0;
	for (int n = 0; n < 4; n++) {
		real at[3] = {point[0], point[1], point[2]}, step[ESK_PARAMETERS_ALL] = {0};
		if (parameter >= 0)
			step[parameter] = offsets[n] * h;
		if (coordinate >= 0 && parameter < 0)
			at[coordinate] += offsets[n] * h;
		if (coordinate >= 0 && parameter >= 0) {
			for (int m = 0; m < 4; m++) {
				at[coordinate] = point[coordinate] + offsets[m] * h;
				sum += weights[n] * weights[m] * potential(p, step, at, rounded) / (h * h);
			}
		} else
			sum += weights[n] * potential(p, step, at, rounded) / h;
	}
	return sum;
}

static eskel_primitive random_primitive(uint64_t *state, real modes, real exponents)
{
	eskel_primitive p = {.alpha = 1};
	const double identity[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	real vector[3], axes[3][3];
	for (int i = 0; i < 3; i++) {
		p.centre[i] = (double)uniform(state, -20, 20);
		p.radii[i] = (double)uniform(state, 2, 9);
		vector[i] = uniform(state, -2, 2);
	}
	turn(identity, vector, axes);
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 3; i++)
			p.axes[k][i] = (double)axes[k][i];
	for (int i = 0; i < 2; i++)
		p.exponents[i] = (double)(1 + exponents * uniform(state, -1, 1));
	for (int i = 0; i < ESKEL_MODE_COUNT; i++)
		p.modes[i] = (double)(modes * uniform(state, -1, 1));
	return p;
}

/* Eight points whose unit coordinates are well off the planes, where differences would be of no use. */
static void random_points(uint64_t *state, const esk_form *form, esk_lanes point[3])
{
	for (int l = 0; l < ESK_LANES; l++) {
		double unit[3], world[3];
		for (int i = 0; i < 3; i++) {
			unit[i] = (double)uniform(state, 0.1L, 1.2L);
			unit[i] = synthetic_random(state) & 1 ? unit[i] : -unit[i];
		}
		deformations_undo(form, unit, world);
		for (int i = 0; i < 3; i++)
			point[i][l] = world[i];
	}
}

static void assert_near(double found, real expected, real scale, const char *what, int parameter, int coordinate)
{
	if (!(fabsl(found - expected) <= 1e-7L * (fabsl(expected) + scale)))
		fail_msg("%s by parameter %d, coordinate %d: %.12g, expected %.12Lg", what, parameter, coordinate,
			found, expected);
}

static void assert_derivatives(const eskel_primitive *p, uint64_t *state, size_t count)
{
	static esk_derivatives found;
	const real still[ESK_PARAMETERS_ALL] = {0};
	esk_form form;
	esk_lanes point[3];
	esk_form_make(p, &form);
	random_points(state, &form, point);
	esk_form_derive(&form, (const esk_lanes *)point, count, &found);
	bool rounded = count > ESK_PARAMETERS_SMOOTH || form.is_superquadric || form.steps == ESK_WARPED;
	for (int l = 0; l < ESK_LANES; l++) {
		const real at[3] = {point[0][l], point[1][l], point[2][l]};
		real value = potential(p, still, at, rounded), scale = 1 + fabsl(value);
		assert_near(found.value[l], value, scale, "the value", -1, -1);
		for (int i = 0; i < 3; i++)
			assert_near(found.gradient[i][l], slope(p, at, rounded, i, -1), scale, "the gradient", -1, i);
		for (int t = 0; t < (int)count; t++) {
			assert_near(found.value_by[t][l], slope(p, at, rounded, -1, t), scale, "the value", t, -1);
			for (int i = 0; i < 3; i++)
				assert_near(found.gradient_by[t][i][l], slope(p, at, rounded, i, t), scale,
					"the gradient", t, i);
		}
	}
}

static void derivatives_of_ellipsoids_are_those_of_the_definition(void **unused)
{
	(void)unused;
	uint64_t state = 1;
	for (int n = 0; n < 20; n++) {
		eskel_primitive p = random_primitive(&state, 0, 0);
		assert_derivatives(&p, &state, ESK_PARAMETERS_SMOOTH);
		assert_derivatives(&p, &state, ESK_PARAMETERS_USUAL);
	}
}

static void derivatives_of_bent_superquadrics_are_those_of_the_definition(void **unused)
{
	(void)unused;
	uint64_t state = 2;
	for (int n = 0; n < 40; n++) {
		eskel_primitive p = random_primitive(&state, 1, n % 2 ? 0.8L : 0);
		for (int i = ESKEL_MODE_BULGE_X; i < ESKEL_MODE_COUNT; i++)
			p.modes[i] = 0;
		assert_derivatives(&p, &state, n % 2 ? ESK_PARAMETERS_USUAL : ESK_PARAMETERS_SMOOTH);
	}
}

static void derivatives_by_all_modes_are_those_of_the_definition(void **unused)
{
	(void)unused;
	uint64_t state = 3;
	for (int n = 0; n < 40; n++) {
		eskel_primitive p = random_primitive(&state, 0.25L, n % 4 ? 0.8L : 0);
		assert_derivatives(&p, &state, ESK_PARAMETERS_ALL);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(derivatives_of_ellipsoids_are_those_of_the_definition),
		cmocka_unit_test(derivatives_of_bent_superquadrics_are_those_of_the_definition),
		cmocka_unit_test(derivatives_by_all_modes_are_those_of_the_definition),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
