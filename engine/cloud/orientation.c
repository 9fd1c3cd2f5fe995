/* One object may be stored with its index axes in any of 48 orders and directions, and its affine differs in the last
 * bits between formats (float in NIfTI, decimal text in NRRD and MetaImage, noise of 1e-17 in place of 0 where a
 * program multiplied rotations). The id of a shape is a digest of its cloud, so all these must give one affine.
 *
 * Linear part: rounded to float, what NIfTI holds, and within a column to the float spacing of its largest entry, so
 * that noise about 0 becomes 0. Over the longest axis of 65535 voxels that moves a voxel by less than 1/100 of one.
 * Orientation: of the 48 signed permutations the one whose columns point most along +x, +y, +z: the largest sum of
 * the diagonal's direction cosines. A tie (45 degrees) goes to the lexicographically largest matrix. Both criteria
 * look at the candidate matrix only, so the input's axis order cannot matter, and the choice for a canonical matrix
 * is itself.
 * Offset: rounded to 1/1024 of the power of two at or below the largest matrix entry, about a thousandth of a voxel:
 * coarser than what flipping a float affine across the grid loses, so only a value that happens to lie that close
 * to a rounding boundary can still differ.
 */
#include "orientation.h"

#include "elementary.h"

#include <math.h>
#include <string.h>

static const int permutations[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

/* Adding 0 turns -0 into +0. */
static double round_to_multiple(double value, double step)
{
	return rint(value / step) * step + 0.0;
}

static double power_of_two_below(double value)
{
	return ldexp(1, ilogb(value));
}

static void round_linear_part(eskel_affine *affine)
{
	for (int c = 0; c < 3; c++) {
		double largest = 0;
		for (int r = 0; r < 3; r++) {
			affine->m[r][c] = esk_elementary_round_to_float(affine->m[r][c]);
			largest = fmax(largest, fabs(affine->m[r][c]));
		}
		double spacing = ldexp(power_of_two_below(largest), -23); /* a float has 23 bits after the first */
		for (int r = 0; r < 3; r++)
			affine->m[r][c] = round_to_multiple(affine->m[r][c], spacing);
	}
}

static double closeness_to_ras(const eskel_affine *affine)
{
	double sum = 0;
	for (int a = 0; a < 3; a++) {
		double x = affine->m[0][a], y = affine->m[1][a], z = affine->m[2][a];
		sum += affine->m[a][a] / sqrt(x * x + y * y + z * z);
	}
	return sum;
}

static int compare_linear_parts(const eskel_affine *a, const eskel_affine *b)
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			if (a->m[r][c] != b->m[r][c])
				return a->m[r][c] < b->m[r][c] ? -1 : 1;
	return 0;
}

void esk_orientation_choose(eskel_affine *affine, esk_orientation *orientation)
{
	const double no_shift[3] = {0, 0, 0};
	round_linear_part(affine);
	double best_closeness = -INFINITY;
	eskel_affine best = *affine;
	for (int candidate = 0; candidate < 48; candidate++) {
		esk_orientation o;
		memcpy(o.axis, permutations[candidate / 8], sizeof o.axis);
		for (int a = 0; a < 3; a++)
			o.reversed[a] = candidate >> a & 1;
		eskel_affine turned = esk_orientation_apply(&o, affine, no_shift);
		double closeness = closeness_to_ras(&turned);
		if (closeness < best_closeness ||
			(closeness == best_closeness && compare_linear_parts(&turned, &best) <= 0))
			continue;
		best_closeness = closeness;
		best = turned;
		*orientation = o;
	}
}

eskel_affine esk_orientation_apply(
	const esk_orientation *orientation, const eskel_affine *affine, const double origin[3])
{
	eskel_affine out;
	double largest = 0;
	for (int r = 0; r < 3; r++) {
		out.m[r][3] = affine->m[r][3];
		for (int a = 0; a < 3; a++) {
			int c = orientation->axis[a];
			double entry = affine->m[r][c];
			out.m[r][a] = (orientation->reversed[a] ? -entry : entry) + 0.0;
			out.m[r][3] += entry * origin[c];
			largest = fmax(largest, fabs(entry));
		}
	}
	double step = power_of_two_below(largest) / 1024;
	for (int r = 0; r < 3; r++)
		out.m[r][3] = round_to_multiple(out.m[r][3], step);
	return out;
}

bool esk_orientation_is_canonical(const eskel_affine *affine)
{
	if (eskel_affine_check(affine, NULL) != ESKEL_OK)
		return false;
	const double no_shift[3] = {0, 0, 0};
	eskel_affine rounded = *affine;
	esk_orientation o;
	esk_orientation_choose(&rounded, &o);
	eskel_affine canonical = esk_orientation_apply(&o, &rounded, no_shift);
	return memcmp(&canonical, affine, sizeof canonical) == 0;
}
