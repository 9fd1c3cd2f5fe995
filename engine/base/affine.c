#include "affine.h"

#include "error.h"

#include <math.h>

static const double shortest_column_mm = 1e-4, longest_column_mm = 1e4;
static const double least_relative_determinant = 1e-3;

double eskel_affine_determinant(const eskel_affine *a)
{
	const double(*m)[4] = a->m;
	return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
	       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

eskel_status eskel_affine_check(const eskel_affine *affine, eskel_error *error)
{
	double product = 1;
	for (int c = 0; c < 4; c++) {
		for (int r = 0; r < 3; r++) {
			if (!isfinite(affine->m[r][c]))
				return esk_error_set(error, ESKEL_BAD_GEOMETRY,
					"the affine's entry in row %d, column %d is not finite", r, c);
		}
		if (c == 3)
			break;
		double length = sqrt(affine->m[0][c] * affine->m[0][c] + affine->m[1][c] * affine->m[1][c] +
				     affine->m[2][c] * affine->m[2][c]);
		if (!(length >= shortest_column_mm && length <= longest_column_mm))
			return esk_error_set(error, ESKEL_BAD_GEOMETRY,
				"the voxel spacing along axis %d is %g mm, expected %g to %g mm", c, length,
				shortest_column_mm, longest_column_mm);
		product *= length;
	}
	double relative = fabs(eskel_affine_determinant(affine)) / product;
	if (!(relative >= least_relative_determinant))
		return esk_error_set(error, ESKEL_BAD_GEOMETRY,
			"the affine is singular: |det| is %g of the product of its column lengths, expected at least "
			"%g",
			relative, least_relative_determinant);
	return ESKEL_OK;
}

void esk_affine_apply(const eskel_affine *affine, const double index[3], double world[3])
{
	double out[3];
	for (int r = 0; r < 3; r++)
		out[r] = affine->m[r][0] * index[0] + affine->m[r][1] * index[1] + affine->m[r][2] * index[2] +
			 affine->m[r][3];
	for (int r = 0; r < 3; r++)
		world[r] = out[r];
}

void esk_affine_congruence(const eskel_affine *affine, const double covariance[3][3], double out[3][3])
{
	double half[3][3], whole[3][3];
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			half[r][c] = affine->m[r][0] * covariance[0][c] + affine->m[r][1] * covariance[1][c] +
				     affine->m[r][2] * covariance[2][c];
	for (int r = 0; r < 3; r++)
		for (int c = r; c < 3; c++)
			whole[r][c] = half[r][0] * affine->m[c][0] + half[r][1] * affine->m[c][1] +
				      half[r][2] * affine->m[c][2];
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			out[r][c] = r <= c ? whole[r][c] : whole[c][r];
}
