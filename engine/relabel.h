/* One pass of dynamic clustering: every voxel to the class of least score. */
#ifndef ESK_RELABEL_H
#define ESK_RELABEL_H

#include "cutter.h"

typedef struct {
	esk_labelling *labelling; /* borrowed */
	esk_scores before;        /* of the last pass; no classes when it does not matter any more */
	size_t block_count;
	struct esk_block *blocks; /* see relabel.c */
	int64_t *settled; /* [segment_count] no label of the segment can change while its block's clock is less */
	esk_cutter cutter;
} esk_relabeller;

eskel_status esk_relabeller_init(esk_relabeller *relabeller, esk_labelling *labelling);
void esk_relabeller_clear(esk_relabeller *relabeller);

/* The next scores are unrelated to those before: a pass looks at every segment. */
void esk_relabeller_restart(esk_relabeller *relabeller);

/* A pass. The labelling then has scores->count classes, some of them perhaps empty. */
eskel_status esk_relabeller_run(esk_relabeller *relabeller, const esk_scores *scores);

#endif
