/* On the unit sphere of a, the potential of b is a quadratic form, in the axes of which it is
 *	g(w) = sum_i l_i w_i^2 + 2 b_i w_i + constant.
 * It is critical where (l_i - m) w_i = -b_i with sum_i (b_i / (l_i - m))^2 = 1: at most six m. The curves where g = 0 divide
 * the sphere; the regions at the ends of the tree of regions are discs, with one curve as the boundary of each. Two
 * quadrics have no more than two curves, so each bounds such a disc; in the disc is a critical point, and on the way from
 * there to the extremum of the other sign the first zero lies on its curve. */
#include "seam_start.h"

#include "eigen.h"

#include <string.h>

enum { HALVINGS = 48, SAMPLES = 32 };

/* A coefficient of zero, as between ellipsoids with a common axis, hides critical points; so small a one does not move them. */
static const double least_coefficient = 1e-9;

typedef struct {
	esk_eigen axes;
	double linear[3], scale;
} form;

static bool make_form(const esk_ellipsoid *a, const esk_ellipsoid *b, form *f)
{
	double map[3][3], square[3][3], centre[3]; /* from the sphere of a to that of b */
	esk_ellipsoid_unit(b, a->centre, centre);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			map[i][j] = esk_triple_dot(b->duals[i], a->axes[j]);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			square[i][j] = map[0][i] * map[0][j] + map[1][i] * map[1][j] + map[2][i] * map[2][j];
	if (esk_eigen_symmetric((const double(*)[3])square, &f->axes) != ESKEL_OK)
		return false;
	f->scale = f->axes.values[0];
	double pulled[3];
	for (int i = 0; i < 3; i++)
		pulled[i] = map[0][i] * centre[0] + map[1][i] * centre[1] + map[2][i] * centre[2];
	for (int i = 0; i < 3; i++) {
		f->linear[i] = esk_triple_dot(f->axes.axes[i], pulled);
		const double least = least_coefficient * f->scale;
		if (!(fabs(f->linear[i]) >= least))
			f->linear[i] = f->linear[i] < 0 ? -least : least;
	}
	return true;
}

/* sum_i (b_i / (l_i - m))^2 - 1, and half its derivative. */
static double secular(const form *f, double m, double *slope)
{
	double sum = -1;
	*slope = 0;
	for (int i = 0; i < 3; i++) {
		const double inverse = 1 / (f->axes.values[i] - m), part = f->linear[i] * inverse;
		sum += part * part;
		*slope += part * part * inverse;
	}
	return sum;
}

/* Between low and high, where the function, or its slope, changes its sign. */
static double halve(const form *f, double low, double high, bool by_slope, bool rises)
{
	for (int i = 0; i < HALVINGS; i++) {
		const double middle = (low + high) / 2;
		double slope;
		const double sum = secular(f, middle, &slope);
		if (((by_slope ? slope : sum) > 0) == rises)
			high = middle;
		else
			low = middle;
	}
	return (low + high) / 2;
}

/* The multipliers m, the least first, the greatest last. */
static int find_multipliers(const form *f, double *m)
{
	const double *l = f->axes.values, reach = 2 * esk_triple_length(f->linear);
	int count = 0;
	m[count++] = halve(f, l[2] - reach, l[2], false, true);
	for (int i = 2; i > 0; i--) {
		if (!(l[i - 1] - l[i] > 1e-6 * f->scale))
			continue;
		double slope;
		const double lowest = halve(f, l[i], l[i - 1], true, true);
		if (!(secular(f, lowest, &slope) < 0))
			continue;
		m[count++] = halve(f, l[i], lowest, false, false);
		m[count++] = halve(f, lowest, l[i - 1], false, true);
	}
	m[count++] = halve(f, l[0], l[0] + reach, false, false);
	return count;
}

static void unit_of(const form *f, double m, double unit[3])
{
	double w[3];
	for (int i = 0; i < 3; i++)
		w[i] = -f->linear[i] / (f->axes.values[i] - m);
	const double length = esk_triple_length(w);
	for (int i = 0; i < 3; i++)
		unit[i] = (w[0] * f->axes.axes[0][i] + w[1] * f->axes.axes[1][i] + w[2] * f->axes.axes[2][i]) / length;
}

static double value_at(const esk_ellipsoid *a, const esk_ellipsoid *b, const double unit[3], double point[3])
{
	esk_ellipsoid_point(a, unit, point);
	return esk_ellipsoid_value(b, point);
}

/* On the arc between two directions, as a share of the chord; by another way where they are opposite. */
static void go(const double from[3], const double to[3], double share, double unit[3])
{
	double length = 0;
	for (int i = 0; i < 3; i++) {
		unit[i] = from[i] + share * (to[i] - from[i]);
		length += unit[i] * unit[i];
	}
	length = sqrt(length);
	for (int i = 0; i < 3; i++)
		unit[i] /= length;
}

/* A direction in the middle between two. */
static void find_middle(const double from[3], const double to[3], double middle[3])
{
	const double dot = esk_triple_dot(from, to);
	if (dot > -0.999) {
		go(from, to, 0.5, middle);
		return;
	}
	const int least = fabs(from[0]) < fabs(from[1]) ? (fabs(from[0]) < fabs(from[2]) ? 0 : 2)
							: (fabs(from[1]) < fabs(from[2]) ? 1 : 2);
	double length = 0;
	for (int i = 0; i < 3; i++) {
		middle[i] = (i == least) - from[least] * from[i];
		length += middle[i] * middle[i];
	}
	for (int i = 0; i < 3; i++)
		middle[i] /= sqrt(length);
}

/* The first zero on the way. */
static void find_zero(
	const esk_ellipsoid *a, const esk_ellipsoid *b, const double from[3], const double to[3], double point[3])
{
	double middle[3], unit[3];
	find_middle(from, to, middle);
	const bool sign = value_at(a, b, from, point) < 0;
	double low = 0, high = 2;
	for (int i = 1; i < 2 * SAMPLES; i++) {
		const double at = (double)i / SAMPLES;
		go(at < 1 ? from : middle, at < 1 ? middle : to, at < 1 ? at : at - 1, unit);
		if ((value_at(a, b, unit, point) < 0) != sign) {
			high = at;
			break;
		}
		low = at;
	}
	for (int i = 0; i < HALVINGS; i++) {
		const double at = (low + high) / 2;
		go(at < 1 ? from : middle, at < 1 ? middle : to, at < 1 ? at : at - 1, unit);
		if ((value_at(a, b, unit, point) < 0) == sign)
			low = at;
		else
			high = at;
	}
}

bool esk_seam_find(const esk_ellipsoid *a, const esk_ellipsoid *b, esk_seam_starts *starts)
{
	form f;
	double m[ESK_STARTS_MOST], units[ESK_STARTS_MOST][3], values[ESK_STARTS_MOST], point[3];
	if (!make_form(a, b, &f))
		return false;
	const int count = find_multipliers(&f, m);
	int least = 0, greatest = 0;
	for (int i = 0; i < count; i++) {
		unit_of(&f, m[i], units[i]);
		values[i] = value_at(a, b, units[i], point);
		least = values[i] < values[least] ? i : least;
		greatest = values[i] > values[greatest] ? i : greatest;
	}
	*starts = (esk_seam_starts){.least = values[least], .greatest = values[greatest]};
	if (!(starts->least < 0 && starts->greatest > 0))
		return starts->least >= 0 || starts->greatest <= 0;
	for (int i = 0; i < count; i++)
		find_zero(a, b, units[i], units[values[i] < 0 ? greatest : least], starts->points[starts->count++]);
	return true;
}
