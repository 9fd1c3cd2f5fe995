/* Cutting segments where the winner among the classes changes. */
#ifndef ESK_CUTTER_H
#define ESK_CUTTER_H

#include "labelling.h"
#include "scores.h"

typedef struct {
	esk_labelling *labelling; /* borrowed */
	int64_t *settled;         /* [segment_count], borrowed: see esk_cutter_run */
	struct esk_batch *batch;
} esk_cutter;

eskel_status esk_cutter_init(esk_cutter *cutter, esk_labelling *labelling, int64_t *settled);
void esk_cutter_clear(esk_cutter *cutter);

/* Gives every voxel of these segments the class of least score. near holds the scores of all classes that win there, in
 * any order: a score carries its class. The slack of a segment is the least lead of a winner over the second best class
 * at the ends of its pieces; settled becomes clock plus slack. segments is overwritten. */
eskel_status esk_cutter_run(esk_cutter *cutter, const esk_scores *scores, const esk_scores *near, int64_t clock,
	size_t *segments, size_t count);

#endif
