/* Normal equations in the monomials of the class's frame, where coordinates are about 1, and their Cholesky factors. Our own,
 * not LAPACK's: these run on the BLAS, whose kernels give other last bits on other processors (eigen.c). */
#include "algebraic.h"

#include "memory.h"
#include "triple.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TERMS = ESK_ALGEBRAIC_TERMS_MAX, GRID = 5, WEIGHTS = 14 };

/* P(0) = -1 all but exactly. */
static const double weight_of_centre = 1e4;
/* What the ellipsoid's mean square counts against that of the boundary points: at first less than a percent of its usual
 * share, in the end all. */
static const double least_weight = 1e-4, weight_step = 4;
/* A point of a side has at least this share of what P may be off there. All of them on the wrong side count as so many times
 * the boundary; rounds of this settle mostly in three or four. */
static const double margin = 0.05, weight_of_sides = 30;
enum { ROUNDS = 6 };
/* Where P is drawn to r^D - 1: well inside and outside of any boundary point. */
static const double radii[] = {0.4, 2, 3};

/* Sum of row row^T (the lower triangle) and of row target. */
typedef struct {
	double matrix[TERMS][TERMS], right[TERMS];
} normal_equations;

void esk_algebraic_place(const eskel_primitive *primitive, esk_algebraic *algebraic)
{
	memcpy(algebraic->centre, primitive->centre, sizeof algebraic->centre);
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			algebraic->to_frame[r][c] = primitive->axes[r][c] / primitive->radii[r];
}

/* The monomials at a point, in the order of algebraic.h. */
static void make_row(unsigned degree, const double u[3], double *row)
{
	double powers[3][ESK_ALGEBRAIC_DEGREE_MAX + 1];
	const int n = (int)degree;
	for (int c = 0; c < 3; c++) {
		powers[c][0] = 1;
		for (int p = 1; p <= n; p++)
			powers[c][p] = powers[c][p - 1] * u[c];
	}
	for (int i = n; i >= 0; i--)
		for (int j = n - i; j >= 0; j--)
			for (int k = n - i - j; k >= 0; k--)
				*row++ = powers[0][i] * powers[1][j] * powers[2][k];
}

static void add_row(normal_equations *e, size_t terms, const double *row, double target, double weight)
{
	for (size_t i = 0; i < terms; i++) {
		const double weighted = weight * row[i];
		for (size_t j = 0; j <= i; j++)
			e->matrix[i][j] += weighted * row[j];
		e->right[i] += weighted * target;
	}
}

/* What P may be off at this distance from the centre: r^D + 1. A point far out counts no more than others. */
static double size_at(unsigned degree, double r)
{
	double power = 1;
	for (unsigned p = 0; p < degree; p++)
		power *= r;
	return power + 1;
}

/* The row of a point in the world, and the size there. */
static double make_world_row(const esk_algebraic *a, const double point[3], double *row)
{
	double u[3];
	for (int r = 0; r < 3; r++) {
		u[r] = 0;
		for (int c = 0; c < 3; c++)
			u[r] += a->to_frame[r][c] * (point[c] - a->centre[c]);
	}
	make_row(a->degree, u, row);
	return size_at(a->degree, esk_triple_length(u));
}

/* P = 0 at the boundary points, in the mean, and P(0) = -1. */
static void add_boundary(const esk_algebraic *a, const esk_algebraic_points *points, normal_equations *e)
{
	const size_t terms = esk_algebraic_term_count(a->degree);
	double row[TERMS];
	for (size_t p = 0; p < points->count; p++) {
		const double size = make_world_row(a, points->points[p], row);
		add_row(e, terms, row, 0, 1 / (size * size * (double)points->count));
	}
	make_row(a->degree, (const double[3]){0, 0, 0}, row);
	add_row(e, terms, row, -1, weight_of_centre);
}

/* The points of the sides that P has not on theirs, by the margin; is there any? */
static bool add_wrong_sides(const esk_algebraic *a, const esk_algebraic_points *points, normal_equations *e)
{
	const size_t terms = esk_algebraic_term_count(a->degree);
	bool any = false;
	double row[TERMS];
	for (size_t p = 0; p < points->side_count; p++) {
		const double size = make_world_row(a, points->sides[p], row), sign = points->are_inside[p] ? -1 : 1;
		double value = 0;
		for (size_t t = 0; t < terms; t++)
			value += row[t] * a->coefficients[t];
		if (sign * value >= margin * size)
			continue;
		add_row(e, terms, row, sign * margin * size,
			weight_of_sides / (size * size * (double)points->side_count));
		any = true;
	}
	return any;
}

/* In the direction of a point of a grid on a face of the cube. */
static void add_direction(unsigned degree, const double direction[3], normal_equations *e)
{
	const double length = esk_triple_length(direction);
	const size_t shells = sizeof radii / sizeof *radii;
	for (size_t s = 0; s < shells; s++) {
		const double size = size_at(degree, radii[s]);
		double u[3], row[TERMS];
		for (int c = 0; c < 3; c++)
			u[c] = direction[c] / length * radii[s];
		make_row(degree, u, row);
		add_row(e, esk_algebraic_term_count(degree), row, size - 2,
			1 / (size * size * (double)shells * 6 * GRID * GRID));
	}
}

static void add_ellipsoid(unsigned degree, normal_equations *e)
{
	for (int face = 0; face < 6; face++)
		for (int i = 0; i < GRID; i++)
			for (int j = 0; j < GRID; j++) {
				double direction[3];
				direction[face / 2] = face % 2 ? 1 : -1;
				direction[(face / 2 + 1) % 3] = (2.0 * i + 1 - GRID) / GRID;
				direction[(face / 2 + 2) % 3] = (2.0 * j + 1 - GRID) / GRID;
				add_direction(degree, direction, e);
			}
}

/* L L^T = the matrix, in its lower triangle; false where it is not positive. */
static bool factor(normal_equations *e, size_t terms)
{
	for (size_t i = 0; i < terms; i++)
		for (size_t j = 0; j <= i; j++) {
			double left = e->matrix[i][j];
			for (size_t k = 0; k < j; k++)
				left -= e->matrix[i][k] * e->matrix[j][k];
			if (i == j && !(left > 0))
				return false;
			e->matrix[i][j] = i == j ? sqrt(left) : left / e->matrix[j][j];
		}
	return true;
}

static void substitute(const normal_equations *e, size_t terms, double *solution)
{
	for (size_t i = 0; i < terms; i++) {
		double left = e->right[i];
		for (size_t k = 0; k < i; k++)
			left -= e->matrix[i][k] * solution[k];
		solution[i] = left / e->matrix[i][i];
	}
	for (size_t i = terms; i-- > 0;) {
		double left = solution[i];
		for (size_t k = i + 1; k < terms; k++)
			left -= e->matrix[k][i] * solution[k];
		solution[i] = left / e->matrix[i][i];
	}
}

/* Boundary + weight * ellipsoid, solved; P(0) is brought to -1. */
static bool solve(const normal_equations *boundary, const normal_equations *ellipsoid, double weight,
	normal_equations *sum, esk_algebraic *a)
{
	const size_t terms = esk_algebraic_term_count(a->degree);
	for (size_t i = 0; i < terms; i++) {
		for (size_t j = 0; j <= i; j++)
			sum->matrix[i][j] = boundary->matrix[i][j] + weight * ellipsoid->matrix[i][j];
		sum->right[i] = boundary->right[i] + weight * ellipsoid->right[i];
	}
	if (!factor(sum, terms))
		return false;
	substitute(sum, terms, a->coefficients);
	const double depth = -a->coefficients[terms - 1];
	for (size_t i = 0; i < terms; i++)
		a->coefficients[i] /= depth;
	return depth > 0 && esk_algebraic_is_bounded(a);
}

/* With the least weight of the ellipsoid at which P is bounded; ESKEL_NUMERIC. */
static eskel_status solve_bounded(
	const normal_equations *boundary, const normal_equations *ellipsoid, normal_equations *sum, esk_algebraic *a)
{
	double weight = least_weight;
	for (int i = 0; i < WEIGHTS; i++, weight *= weight_step)
		if (solve(boundary, ellipsoid, weight, sum, a))
			return ESKEL_OK;
	return ESKEL_NUMERIC;
}

static bool is_fittable(unsigned degree, const double (*points)[3], size_t count)
{
	if (count == 0 || (degree != 2 && degree != 4 && degree != 6))
		return false;
	for (size_t p = 0; p < count; p++)
		for (int c = 0; c < 3; c++)
			if (!isfinite(points[p][c]))
				return false;
	return true;
}

eskel_status esk_algebraic_fit(
	const eskel_primitive *primitive, unsigned degree, const esk_algebraic_points *points, esk_algebraic *algebraic)
{
	if (!is_fittable(degree, points->points, points->count))
		return ESKEL_INVALID;
	esk_algebraic made = {.degree = degree};
	normal_equations *e =
		esk_memory_zeroed_array(4, sizeof *e); /* boundary, ellipsoid, their sum, and with sides */
	if (!e)
		return ESKEL_NO_MEMORY;
	esk_algebraic_place(primitive, &made);
	add_boundary(&made, points, &e[0]);
	add_ellipsoid(degree, &e[1]);
	eskel_status status = solve_bounded(&e[0], &e[1], &e[2], &made);
	for (int round = 0; round < ROUNDS && !status; round++) {
		e[3] = e[0];
		if (!add_wrong_sides(&made, points, &e[3]))
			break;
		status = solve_bounded(&e[3], &e[1], &e[2], &made);
	}
	free(e);
	if (!status)
		*algebraic = made;
	return status;
}
