/* Partitions of a cloud by dynamic clustering (section 2.4.1, Lloyd's iteration), over segments instead of voxels. */
#ifndef ESK_PARTITION_H
#define ESK_PARTITION_H

#include "relabel.h"

typedef struct {
	const esk_metric *metric; /* borrowed */
	esk_relabeller relabeller;
	esk_sums sums[ESKEL_LEVELS_MAX]; /* of the classes */
} esk_partition;

/* Borrows segments, metric and team. */
eskel_status esk_partition_init(esk_partition *partition, const esk_segment *segments, size_t segment_count,
	const esk_metric *metric, esk_team *team);
void esk_partition_clear(esk_partition *partition);

/* Gives every voxel the class of least score. Classes may come out empty. */
void esk_partition_assign(esk_partition *partition, const esk_scores *scores);

/* Repeats "centres of the classes, then voxels to the nearest centre" until no centre changes. Starts from the centres
 * of starts[count], of which none is empty; there are at least count voxels. An emptied class takes the voxel farthest
 * from its centre among the classes of two voxels or more (on a tie the first one by z, then y, then x). */
eskel_status esk_partition_converge(esk_partition *partition, const esk_sums *starts, uint32_t count);

/* The labels that assign or converge ended with. labelling is empty, or reused. */
eskel_status esk_partition_label(const esk_partition *partition, esk_labelling *labelling);

#endif
