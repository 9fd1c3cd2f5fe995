/* Three nested Horner schemes, for the values and their derivatives at once. */
#include "algebraic.h"

#include <string.h>

size_t esk_algebraic_term_count(unsigned degree)
{
	return (size_t)(degree + 1) * (degree + 2) * (degree + 3) / 6;
}

/* Values of a polynomial, and their derivatives by x, y and z. */
typedef struct {
	esk_lanes value, by_x, by_y, by_z;
} slopes;

ESK_IN_LANES void to_unit(const esk_algebraic *algebraic, const esk_lanes point[3], esk_lanes unit[3])
{
	const double(*m)[3] = algebraic->to_frame;
	ESK_EACH_LANE (l) {
		const double x = point[0][l] - algebraic->centre[0], y = point[1][l] - algebraic->centre[1];
		const double z = point[2][l] - algebraic->centre[2];
		for (int i = 0; i < 3; i++)
			unit[i][l] = m[i][0] * x + m[i][1] * y + m[i][2] * z;
	}
}

/* Of the next degree + 1 coefficients, the polynomial in z: values and derivatives by z. */
ESK_IN_LANES void add_z(const double *coefficients, int degree, const esk_lanes z, esk_lanes value, esk_lanes by_z)
{
	esk_lanes r = {0}, slope = {0};
	for (int k = 0; k <= degree; k++)
		ESK_EACH_LANE (l) {
			slope[l] = slope[l] * z[l] + r[l];
			r[l] = r[l] * z[l] + coefficients[k];
		}
	ESK_EACH_LANE (l) {
		value[l] += r[l];
		by_z[l] += slope[l];
	}
}

/* The polynomial in x whose coefficients are polynomials in y whose coefficients are polynomials in z. */
ESK_IN_LANES void evaluate(const esk_algebraic *algebraic, const esk_lanes u[3], slopes *p)
{
	const double *next = algebraic->coefficients;
	const int degree = (int)algebraic->degree;
	memset(p, 0, sizeof *p);
	for (int i = degree; i >= 0; i--) {
		slopes q = {{0}, {0}, {0}, {0}};
		for (int j = degree - i; j >= 0; j--) {
			ESK_EACH_LANE (l) {
				q.by_y[l] = q.by_y[l] * u[1][l] + q.value[l];
				q.by_z[l] *= u[1][l];
				q.value[l] *= u[1][l];
			}
			add_z(next, degree - i - j, u[2], q.value, q.by_z);
			next += degree - i - j + 1;
		}
		ESK_EACH_LANE (l) {
			p->by_x[l] = p->by_x[l] * u[0][l] + p->value[l];
			p->by_y[l] = p->by_y[l] * u[0][l] + q.by_y[l];
			p->by_z[l] = p->by_z[l] * u[0][l] + q.by_z[l];
			p->value[l] = p->value[l] * u[0][l] + q.value[l];
		}
	}
}

ESK_EVERY_WIDTH void esk_algebraic_gradients(
	const esk_algebraic *algebraic, const esk_lanes point[3], esk_lanes values, esk_lanes gradients[3])
{
	const double(*m)[3] = algebraic->to_frame;
	esk_lanes unit[3];
	slopes p;
	to_unit(algebraic, point, unit);
	evaluate(algebraic, (const esk_lanes *)unit, &p);
	memcpy(values, p.value, sizeof(esk_lanes));
	for (int i = 0; i < 3; i++)
		ESK_EACH_LANE (l)
			gradients[i][l] = m[0][i] * p.by_x[l] + m[1][i] * p.by_y[l] + m[2][i] * p.by_z[l];
}

void esk_algebraic_values(const esk_algebraic *algebraic, const esk_lanes point[3], esk_lanes values)
{
	esk_lanes gradients[3];
	esk_algebraic_gradients(algebraic, point, values, gradients);
}
