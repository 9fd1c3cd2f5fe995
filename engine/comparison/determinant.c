#include "determinant.h"

#include "distance.h"

#include <math.h>
#include <string.h>

/* det of the rows (1, p), (1, q), (1, r), (1, s): (q - p) x (r - p) . (s - p). */
static double determinant(const double *p, const double *q, const double *r, const double *s)
{
	double u[3], v[3], w[3];
	for (int i = 0; i < 3; i++) {
		u[i] = q[i] - p[i];
		v[i] = r[i] - p[i];
		w[i] = s[i] - p[i];
	}
	return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
	       (u[0] * v[1] - u[1] * v[0]) * w[2];
}

static double determinant_of(const esk_tetrahedra *of, uint32_t level, const uint8_t four[4])
{
	const double(*centres)[3] = &of->centres[ESKEL_NODES(level - 1)];
	return determinant(centres[four[0]], centres[four[1]], centres[four[2]], centres[four[3]]);
}

/* The first of equals, in lexicographic order. */
static void find_largest(esk_tetrahedra *tetrahedra, uint32_t level)
{
	double largest = -1;
	uint8_t t[4];
	for (t[0] = 0; t[0] < level; t[0]++)
		for (t[1] = (uint8_t)(t[0] + 1); t[1] < level; t[1]++)
			for (t[2] = (uint8_t)(t[1] + 1); t[2] < level; t[2]++)
				for (t[3] = (uint8_t)(t[2] + 1); t[3] < level; t[3]++) {
					double size = fabs(determinant_of(tetrahedra, level, t));
					if (size > largest) {
						largest = size;
						memcpy(tetrahedra->largest[level - 1], t, sizeof t);
					}
				}
}

static eskel_status take_shape(esk_tetrahedra *tetrahedra, const eskel_skeleton *skeleton, uint32_t levels)
{
	eskel_signature *signature = NULL;
	eskel_status status = eskel_signature_new(skeleton, &signature);
	if (status != ESKEL_OK)
		return status;
	signature->level_count = levels;
	status = esk_shape_new(signature, &tetrahedra->shape);
	eskel_signature_free(signature);
	return status;
}

eskel_status esk_tetrahedra_init(esk_tetrahedra *tetrahedra, const eskel_skeleton *skeleton)
{
	uint32_t levels = skeleton->level_count;
	if (levels > ESK_DETERMINANT_LAST_LEVEL)
		levels = ESK_DETERMINANT_LAST_LEVEL;
	eskel_status status = take_shape(tetrahedra, skeleton, levels);
	if (status != ESKEL_OK)
		return status;
	for (size_t n = 0; n < ESKEL_NODES(levels); n++)
		memcpy(tetrahedra->centres[n], skeleton->nodes[n].centre, sizeof tetrahedra->centres[n]);
	for (uint32_t k = ESK_DETERMINANT_FIRST_LEVEL; k <= levels; k++)
		find_largest(tetrahedra, k);
	return ESKEL_OK;
}

void esk_tetrahedra_clear(esk_tetrahedra *tetrahedra)
{
	esk_shape_release(tetrahedra->shape);
	tetrahedra->shape = NULL;
}

eskel_status esk_determinant_pair(
	const esk_tetrahedra *a, const esk_tetrahedra *b, uint32_t level, double determinants[2])
{
	/* Section 5.2: the paper's signature, and homothetic objects match. */
	const eskel_distance_options by_paper = {.signature = ESKEL_SIGNATURE_PAPER, .size = ESKEL_SIZE_FREE};
	eskel_match match;
	eskel_status status = esk_match_shapes(a->shape, b->shape, &by_paper, level, &match);
	if (status != ESKEL_OK)
		return status;
	const uint8_t *four = a->largest[level - 1];
	uint8_t matched[4];
	for (int i = 0; i < 4; i++)
		matched[i] = (uint8_t)match.other[four[i]];
	determinants[0] = determinant_of(a, level, four);
	determinants[1] = determinant_of(b, level, matched);
	return ESKEL_OK;
}
