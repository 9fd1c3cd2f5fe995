/* Scores: which class a voxel belongs to, exactly.
 *
 * The squared distance of a voxel u to the centre g of a class, less u^T T u which is the same for every class, is
 * linear in u:
 *
 *	c - 2 b . u    with b = T g, c = g^T T g = b . g
 *
 * b is rounded to a multiple of 2^-shift (metric.h), and so is c, computed from the rounded b; what remains is integer.
 * The score of class j is
 *
 *	s(u) = 64 (c - 2 b . u) 2^shift + j
 *
 * so that no two classes ever tie: a voxel belongs to the class of least score, which is the nearest one, and among
 * equally near ones the one of least index. All intermediates are integers below 2^51. Double arithmetic does them
 * without rounding, in any order, with or without fused multiplication, so labels do not depend on the compiler, the
 * vector width or the machine. Slopes are multiples of 128, so that a score tells its class, score mod 64, halfway
 * between voxels too.
 *
 * Along x a score is linear too. Where a class wins along a segment is an intersection of half-lines: one interval, or
 * nothing. */
#ifndef ESK_SCORES_H
#define ESK_SCORES_H

#include "metric.h"

typedef struct {
	uint32_t count;
	double constant[ESKEL_LEVELS_MAX]; /* 64 c 2^shift + j */
	double slope[3][ESKEL_LEVELS_MAX]; /* -128 b 2^shift */
} esk_scores;

/* The score of class index with these sums, which are not empty. */
void esk_scores_set(esk_scores *scores, uint32_t index, const esk_metric *metric, const esk_sums *sums);

/* Scores of two classes: 1 where normal . u > threshold, 0 elsewhere. All numbers below 2^43. */
void esk_scores_set_plane(esk_scores *scores, const int64_t normal[3], int64_t threshold);

static inline double esk_scores_at(const esk_scores *s, uint32_t j, double x, double y, double z)
{
	return s->constant[j] + s->slope[0][j] * x + s->slope[1][j] * y + s->slope[2][j] * z;
}

#endif
