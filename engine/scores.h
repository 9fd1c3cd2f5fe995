/* Scores: which class a voxel belongs to, exactly.
 *
 * The squared distance of a voxel u to the centre g of a class, less u^T T u which is the same for every class, is
 * linear in u:
 *
 *	s(u) = c - 2 b . u    with b = T g, c = g^T T g = b . g
 *
 * b is rounded to a multiple of 2^-shift, and so is c, computed from the rounded b. What remains is integer
 * arithmetic below 2^53, which double does without rounding: labels do not depend on the order of operations, on
 * vector width or on the compiler, and ties are true ties. A voxel belongs to the class of least score, on a tie to
 * the one of least index.
 *
 * Along x a score is linear too. A class therefore wins an interval of a segment, or nothing: where it wins is an
 * intersection of half-lines. */
#ifndef ESK_SCORES_H
#define ESK_SCORES_H

#include "metric.h"

typedef struct {
	uint32_t count;
	double constant[ESKEL_LEVELS_MAX]; /* c */
	double slope[3][ESKEL_LEVELS_MAX]; /* -2 b */
} esk_scores;

/* Scores of the class with these sums, which are not empty. */
void esk_scores_set(esk_scores *scores, uint32_t index, const esk_metric *metric, const esk_sums *sums);

static inline double esk_scores_at(const esk_scores *s, uint32_t j, double x, double y, double z)
{
	return s->constant[j] + s->slope[1][j] * y + s->slope[2][j] * z + s->slope[0][j] * x;
}

#endif
