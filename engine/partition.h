/* Partitions of a cloud by dynamic clustering (section 2.4.1, Lloyd's iteration) over segments instead of voxels. */
#ifndef ESK_PARTITION_H
#define ESK_PARTITION_H

#include "scores.h"

typedef struct {
	int32_t x_last; /* pieces of a segment follow each other: each begins 2 after the one before */
	uint32_t class_index;
} esk_piece;

typedef struct {
	const esk_metric *metric;    /* borrowed */
	const esk_segment *segments; /* borrowed */
	size_t segment_count;
	uint32_t class_count;
	esk_sums sums[ESKEL_LEVELS_MAX]; /* of the classes */
	size_t *first_piece;             /* [segment_count + 1] */
	esk_piece *pieces;
	size_t piece_capacity;
} esk_partition;

/* Borrows segments and metric. No classes yet. */
eskel_status esk_partition_init(
	esk_partition *partition, const esk_segment *segments, size_t segment_count, const esk_metric *metric);
void esk_partition_clear(esk_partition *partition);

/* Gives every voxel the class of least score. Classes may come out empty. */
eskel_status esk_partition_assign(esk_partition *partition, const esk_scores *scores);

/* Repeats "centres of the classes, then voxels to the nearest centre" until no centre changes. Starts from the centres
 * of starts[count], of which none is empty; there are at least count voxels. An emptied class takes the voxel farthest
 * from its centre among the classes of two voxels or more (the first one on a tie). */
eskel_status esk_partition_converge(esk_partition *partition, const esk_sums *starts, uint32_t count);

/* The moments of every class. */
void esk_partition_moments(const esk_partition *partition, esk_moments *moments);

/* The segments of every class, class after class: those of class j are (*segments)[first[j]] up to first[j + 1]. */
eskel_status esk_partition_collect(
	const esk_partition *partition, esk_segment **segments, size_t first[ESKEL_LEVELS_MAX + 1]);

#endif
