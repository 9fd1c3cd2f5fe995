#include "determinant.h"

#include <math.h>

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

static double determinant_of(const eskel_skeleton *skeleton, uint32_t level, const uint32_t four[4])
{
	const eskel_node *nodes = skeleton->nodes + ESKEL_NODES(level - 1);
	return determinant(nodes[four[0]].centre, nodes[four[1]].centre, nodes[four[2]].centre, nodes[four[3]].centre);
}

/* The first of equals, in lexicographic order. */
static void largest_tetrahedron(const eskel_skeleton *skeleton, uint32_t level, uint32_t four[4])
{
	double largest = -1;
	uint32_t t[4];
	for (t[0] = 0; t[0] < level; t[0]++)
		for (t[1] = t[0] + 1; t[1] < level; t[1]++)
			for (t[2] = t[1] + 1; t[2] < level; t[2]++)
				for (t[3] = t[2] + 1; t[3] < level; t[3]++) {
					double size = fabs(determinant_of(skeleton, level, t));
					if (size > largest) {
						largest = size;
						for (int i = 0; i < 4; i++)
							four[i] = t[i];
					}
				}
}

eskel_status esk_determinant_pair(
	const eskel_skeleton *a, const eskel_skeleton *b, uint32_t level, double determinants[2])
{
	/* Section 5.2: the paper's signature, and homothetic objects match. */
	const eskel_distance_options by_paper = {.signature = ESKEL_SIGNATURE_PAPER, .size = ESKEL_SIZE_FREE};
	eskel_signature *signature_a = NULL, *signature_b = NULL;
	eskel_match match;
	eskel_status status = eskel_signature_new(a, &signature_a);
	if (status == ESKEL_OK)
		status = eskel_signature_new(b, &signature_b);
	if (status == ESKEL_OK)
		status = eskel_match_level(signature_a, signature_b, &by_paper, level, &match);
	if (status == ESKEL_OK) {
		uint32_t four[4], matched[4];
		largest_tetrahedron(a, level, four);
		for (int i = 0; i < 4; i++)
			matched[i] = match.other[four[i]];
		determinants[0] = determinant_of(a, level, four);
		determinants[1] = determinant_of(b, level, matched);
	}
	eskel_signature_free(signature_a);
	eskel_signature_free(signature_b);
	return status;
}
