/* The proof that a polynomial has no zero outside of a cube.
 *
 * A point outside of it is B s / w with s on the surface of the cube |s| <= 1 and 0 <= w <= 1, w = 0 being infinity. There
 * P has the sign of Q(s, w) = w^D P(B s / w), a polynomial: on each of the six faces one of three variables, two of s
 * from -1 to 1 and w from 0 to 1. In the Bernstein basis its values lie between its least and its greatest coefficient, and
 * those at corners are values. So a box of positive coefficients is done, one with a corner that is not positive refutes,
 * and any other is cut in halves. */
#include "algebraic.h"

#include <math.h>
#include <string.h>

enum { SIDE = ESK_ALGEBRAIC_DEGREE_MAX + 1, CUTS_MAX = 9, BOXES_MAX = 4000 };

/* Q must be this much above 0: r^D - 1 is 1 - 3^-D at the least, and 1/3000 in its stead would be a surface hanging by a
 * thread. */
static const double least = 1e-3;

typedef struct {
	double at[SIDE][SIDE][SIDE];
} box;

static double choose(int n, int k)
{
	double product = 1;
	for (int i = 1; i <= k; i++)
		product = product * (n - k + i) / i;
	return product;
}

/* b[i] = sum of a_p times the coefficient of x^p in the Bernstein basis of [0, 1]: C(i, p) / C(n, p). */
static void power_to_bernstein(int n, const double *a, double *b)
{
	for (int i = 0; i <= n; i++) {
		b[i] = 0;
		for (int p = 0; p <= i; p++)
			b[i] += a[p] * choose(i, p) / choose(n, p);
	}
}

/* From powers of s in [-1, 1] to those of t in [0, 1], s = 2 t - 1. */
static void recentre(int n, double *a)
{
	double moved[SIDE] = {0};
	for (int p = 0; p <= n; p++) {
		double term = a[p];
		for (int q = p; q >= 0; q--) /* (2 t)^q (-1)^(p - q) C(p, q) */
			moved[q] += term * choose(p, q) * (double)(1 << q) * ((p - q) % 2 ? -1 : 1);
	}
	memcpy(a, moved, (size_t)(n + 1) * sizeof *a);
}

/* One axis of a box, in place. */
static void change_axis(box *b, int n, int axis, bool is_centred)
{
	for (int i = 0; i <= n; i++)
		for (int j = 0; j <= n; j++) {
			double line[SIDE], changed[SIDE];
			double *first = axis == 0 ? &b->at[0][i][j] : axis == 1 ? &b->at[i][0][j] : &b->at[i][j][0];
			const int step = axis == 0 ? SIDE * SIDE : axis == 1 ? SIDE : 1;
			for (int k = 0; k <= n; k++)
				line[k] = first[k * step];
			if (is_centred)
				recentre(n, line);
			power_to_bernstein(n, line, changed);
			for (int k = 0; k <= n; k++)
				first[k * step] = changed[k];
		}
}

/* Q on the face where the coordinate is sign: at[power of the next coordinate][of the one after][of w]. */
static void make_face(const esk_algebraic *algebraic, int coordinate, int sign, box *face)
{
	const int n = (int)algebraic->degree;
	const double *next = algebraic->coefficients;
	memset(face, 0, sizeof *face);
	for (int i = n; i >= 0; i--)
		for (int j = n - i; j >= 0; j--)
			for (int k = n - i - j; k >= 0; k--) {
				const int power[3] = {i, j, k};
				double term = *next++;
				for (int p = 0; p < i + j + k; p++)
					term *= ESK_ALGEBRAIC_BOX;
				if (sign < 0 && power[coordinate] % 2)
					term = -term;
				face->at[power[(coordinate + 1) % 3]][power[(coordinate + 2) % 3]][n - i - j - k] +=
					term;
			}
	change_axis(face, n, 0, true);
	change_axis(face, n, 1, true);
	change_axis(face, n, 2, false);
}

/* The half of a box on an axis (de Casteljau). */
static void cut(const box *whole, int n, int axis, int half, box *part)
{
	const int step = axis == 0 ? SIDE * SIDE : axis == 1 ? SIDE : 1;
	*part = *whole;
	for (int i = 0; i <= n; i++)
		for (int j = 0; j <= n; j++) {
			double *line = axis == 0   ? &part->at[0][i][j]
				       : axis == 1 ? &part->at[i][0][j]
						   : &part->at[i][j][0];
			for (int round = 1; round <= n; round++)
				for (int k = 0; k <= n - round; k++) {
					const int to = half ? k : n - k, from = half ? k + 1 : n - k - 1;
					line[to * step] = 0.5 * (line[to * step] + line[from * step]);
				}
		}
}

typedef enum { POSITIVE, NOT_POSITIVE, OPEN } verdict;

static verdict judge(const box *b, int n)
{
	double smallest = INFINITY;
	for (int i = 0; i <= n; i++)
		for (int j = 0; j <= n; j++)
			for (int k = 0; k <= n; k++)
				if (!(b->at[i][j][k] >= smallest))
					smallest = b->at[i][j][k];
	if (smallest > least)
		return POSITIVE;
	for (int corner = 0; corner < 8; corner++)
		if (!(b->at[corner & 1 ? n : 0][corner & 2 ? n : 0][corner & 4 ? n : 0] > least))
			return NOT_POSITIVE;
	return OPEN;
}

/* Cuts along the axes in turn; budget is of boxes to look at. */
static bool is_positive(const box *b, int n, int cuts, int *budget)
{
	const verdict found = judge(b, n);
	if (found != OPEN)
		return found == POSITIVE;
	if (cuts == 3 * CUTS_MAX || (*budget -= 2) < 0)
		return false;
	for (int half = 0; half < 2; half++) {
		box part;
		cut(b, n, cuts % 3, half, &part);
		if (!is_positive(&part, n, cuts + 1, budget))
			return false;
	}
	return true;
}

bool esk_algebraic_is_bounded(const esk_algebraic *algebraic)
{
	const size_t terms = esk_algebraic_term_count(algebraic->degree);
	int budget = BOXES_MAX;
	for (size_t t = 0; t < terms; t++)
		if (!(fabs(algebraic->coefficients[t]) < 1e12)) /* also refuses NaN */
			return false;
	if (!(algebraic->coefficients[terms - 1] < 0))
		return false;
	for (int face = 0; face < 6; face++) {
		box b;
		make_face(algebraic, face / 2, face % 2 ? 1 : -1, &b);
		if (!is_positive(&b, (int)algebraic->degree, 0, &budget))
			return false;
	}
	return true;
}
