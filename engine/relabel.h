/* One pass of dynamic clustering: every voxel to the class of least score. */
#ifndef ESK_RELABEL_H
#define ESK_RELABEL_H

#include "labelling.h"
#include "scores.h"

typedef struct {
	esk_labelling *labelling; /* borrowed */
	int64_t clock;            /* how far scores have moved, see relabel.c */
	int64_t *settled;         /* [segment_count] while clock is less, no label of the segment can change */
	size_t *list;             /* [segment_count] that a pass looks at */
	struct esk_batch *batch;
} esk_relabeller;

eskel_status esk_relabeller_init(esk_relabeller *relabeller, esk_labelling *labelling);
void esk_relabeller_clear(esk_relabeller *relabeller);

/* The next pass looks at every segment: the scores are unrelated to those before. */
void esk_relabeller_restart(esk_relabeller *relabeller);

/* Scores have moved since the last pass: by at most this relative to each other, anywhere in the cloud. */
void esk_relabeller_advance(esk_relabeller *relabeller, int64_t movement);

/* A pass. The labelling then has scores->count classes, some of them perhaps empty. */
eskel_status esk_relabeller_run(esk_relabeller *relabeller, const esk_scores *scores);

#endif
