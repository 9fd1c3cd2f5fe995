/* One pass of dynamic clustering: every voxel to the class of least score. */
#ifndef ESK_RELABEL_H
#define ESK_RELABEL_H

#include "envelope.h"
#include "labelling.h"
#include "team.h"

typedef struct {
	const esk_segment *segments; /* borrowed */
	size_t segment_count, pack_count, block_count;
	bool heavy;             /* sums may pass what doubles hold exactly */
	esk_scores before;      /* of the last pass; no classes when it does not matter any more */
	esk_envelope *envelope; /* of the last pass */
	esk_pack *packs;
	struct esk_outlook *outlooks; /* of the packs, see relabel.c */
	uint64_t *candidates;         /* of the packs: the ranks that may win there, a bit each */
	struct esk_block *blocks;
	esk_team *team; /* borrowed */
	size_t share_count;
	struct esk_share *shares; /* of the blocks, for threads */
} esk_relabeller;

/* Borrows segments and team. */
eskel_status esk_relabeller_init(
	esk_relabeller *relabeller, const esk_segment *segments, size_t segment_count, esk_team *team);
void esk_relabeller_clear(esk_relabeller *relabeller);

/* The next scores are unrelated to those before: a pass looks at every segment. */
void esk_relabeller_restart(esk_relabeller *relabeller);

/* A pass: the sums of every class, some of them perhaps empty. */
void esk_relabeller_run(esk_relabeller *relabeller, const esk_scores *scores, esk_sums sums[ESKEL_LEVELS_MAX]);

/* The labels of the last pass, in place of those in labelling. */
eskel_status esk_relabeller_label(const esk_relabeller *relabeller, esk_labelling *labelling);

#endif
