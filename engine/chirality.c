/* Handedness: is a shape like another one, or like its mirror image (section 5.5)?
 *
 * The verdict weighs how well b can be laid on a by a rotation against how well by a reflection (superposition.c). The
 * paper's determinants are reported beside it, and decide nothing: over signature-matched classes they agree with
 * anatomy in about three of four pairs of bones. */
#include "placement.h"
#include "superposition.h"

#include <math.h>

/* Above every wrong sign among 505 pairs of bones and brain regions (the worst was 0.046). */
static const double least_score = 0.05;
/* In cube roots of the volume, a level. Affines are rounded to float, so equal shapes may differ by 1e-7 or so in either
 * hand, and the ratio of two rounding errors means nothing. About what one voxel in a million changes. */
static const double least_cost = 1e-6;

static uint32_t at_most(uint32_t a, uint32_t b)
{
	return a < b ? a : b;
}

static void judge(uint32_t levels, eskel_chirality *c)
{
	if (fmax(c->proper, c->improper) <= least_cost * levels)
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
		esk_superposition_costs(a->classes, b->classes, levels, &c.proper, &c.improper);
		judge(levels - ESK_SUPERPOSITION_FIRST_LEVEL + 1, &c);
	}
	*chirality = c;
	return ESKEL_OK;
}
