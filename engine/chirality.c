/* */
#include "overlap.h"
#include "placement.h"
#include "superposition.h"

#include <math.h>

static const double least_score = 0.05;
static const double least_cost = 1e-10;

static uint32_t at_most(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

/* The least over candidates of |f_a - f_b|^2 / (|f_a|^2 + |f_b|^2). */
static double least_difference(
	const eskel_placement *a, const eskel_placement *b, uint32_t level, const esk_lanes candidates[3][3])
{
	double overlaps[ESK_LANES], greatest = 0;
	double squares = a->overlap[level - 1] + b->overlap[level - 1];
	size_t first = ESKEL_NODES(level - 1);
	esk_overlap_find(&a->classes[first], &b->classes[first], level, candidates, overlaps);
	for (int l = 0; l < ESK_LANES; l++)
		greatest = fmax(greatest, overlaps[l]);
	return fmax(squares - 2 * greatest, 0) / squares;
}

static void judge(eskel_chirality *c)
{
	if (fmax(c->proper, c->improper) <= least_cost)
		return;
	c->score = (c->improper - c->proper) / (c->improper + c->proper);
	if (fabs(c->score) >= least_score)
		c->verdict = c->score > 0 ? ESKEL_CHIRALITY_SAME : ESKEL_CHIRALITY_MIRRORED;
}

eskel_status eskel_chirality_compare(const eskel_placement *a, const eskel_placement *b, eskel_chirality *chirality)
{
	eskel_chirality c = {.verdict = ESKEL_CHIRALITY_UNDECIDED};
	uint32_t levels = at_most(a->level_count, b->level_count);
	if (levels >= ESK_DETERMINANT_FIRST_LEVEL) {
		c.determinant_level = at_most(levels, ESK_DETERMINANT_LAST_LEVEL);
		eskel_status status =
			esk_determinant_pair(&a->tetrahedra, &b->tetrahedra, c.determinant_level, c.determinant);
		if (status != ESKEL_OK)
			return status;
		c.has_determinant = true;
	}
	if (levels >= ESK_SUPERPOSITION_FIRST_LEVEL) {
		esk_candidate_poses candidates;
		esk_superposition_candidates(a->classes, b->classes, levels, &candidates);
		c.proper = least_difference(a, b, levels, (const esk_lanes(*)[3])candidates.proper);
		c.improper = least_difference(a, b, levels, (const esk_lanes(*)[3])candidates.improper);
		judge(&c);
	}
	*chirality = c;
	return ESKEL_OK;
}
