#include "partition.h"

#include <math.h>
#include <string.h>

eskel_status esk_partition_init(
	esk_partition *partition, const esk_segment *segments, size_t segment_count, const esk_metric *metric)
{
	*partition = (esk_partition){.metric = metric};
	eskel_status status = esk_labelling_init(&partition->labelling, segments, segment_count);
	if (!status)
		status = esk_relabeller_init(&partition->relabeller, &partition->labelling);
	if (status)
		esk_partition_clear(partition);
	return status;
}

void esk_partition_clear(esk_partition *partition)
{
	esk_relabeller_clear(&partition->relabeller);
	esk_labelling_clear(&partition->labelling);
}

eskel_status esk_partition_assign(esk_partition *partition, const esk_scores *scores)
{
	esk_relabeller_restart(&partition->relabeller);
	return esk_relabeller_run(&partition->relabeller, scores);
}

static bool is_same(const esk_sums *a, const esk_sums *b)
{
	return a->weight == b->weight && memcmp(a->first, b->first, sizeof a->first) == 0;
}

static bool are_same(const esk_sums *a, const esk_sums *b, uint32_t count)
{
	for (uint32_t j = 0; j < count; j++)
		if (!is_same(&a[j], &b[j]))
			return false;
	return true;
}

static double squared_distance(const esk_metric *metric, const esk_sums *sums, const double u[3])
{
	double d[3], sum = 0;
	for (int r = 0; r < 3; r++)
		d[r] = u[r] - (double)sums->first[r] / (double)sums->weight;
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			sum += (double)metric->form[r][c] * d[r] * d[c];
	return sum;
}

/* A voxel at an end of a piece. */
typedef struct {
	size_t segment;
	uint32_t piece;
	int32_t x;
} piece_end;

/* The voxel farthest from its centre, among classes of two voxels or more; the first one on a tie. Distance is convex
 * along a piece, so the ends of pieces suffice. */
static piece_end farthest_voxel(const esk_labelling *labelling, const esk_metric *metric)
{
	uint64_t voxels[ESKEL_LEVELS_MAX] = {0};
	for (esk_piece_cursor c = esk_labelling_first(labelling); c.valid; esk_labelling_next(labelling, &c))
		voxels[c.class_index] += esk_segment_voxels(&c.part);
	double farthest = -1;
	piece_end found = {0};
	for (esk_piece_cursor c = esk_labelling_first(labelling); c.valid; esk_labelling_next(labelling, &c))
		for (int i = 0; i < 2 && voxels[c.class_index] >= 2; i++) {
			const double u[3] = {i ? c.part.x_last : c.part.x_first, c.part.y, c.part.z};
			const double d = squared_distance(metric, &labelling->sums[c.class_index], u);
			if (d > farthest) {
				farthest = d;
				found = (piece_end){c.segment, c.piece, (int32_t)u[0]};
			}
		}
	return found;
}

/* Cuts the voxel off its piece and gives it to the class. */
static eskel_status give_voxel(esk_labelling *labelling, piece_end voxel, uint32_t class_index)
{
	const esk_slot slot = labelling->slots[voxel.segment];
	const esk_piece *old = labelling->pieces + slot.first;
	esk_piece pieces[ESKEL_LEVELS_MAX + 1];
	uint32_t count = 0;
	int32_t x_first = labelling->segments[voxel.segment].x_first;
	for (uint32_t i = 0; i < slot.count; i++) {
		const bool here = i == voxel.piece, at_first = here && voxel.x == x_first;
		const bool alone = at_first && old[i].x_last == x_first;
		if (at_first)
			pieces[count++] = (esk_piece){voxel.x, class_index};
		if (!alone)
			pieces[count++] = old[i];
		if (here && !at_first) {
			pieces[count - 1].x_last = voxel.x - 2;
			pieces[count++] = (esk_piece){voxel.x, class_index};
		}
		x_first = old[i].x_last + 2;
	}
	return esk_labelling_replace(labelling, voxel.segment, pieces, count);
}

/* Gives every empty class a voxel. *filled tells whether there was one. */
static eskel_status fill_empty_classes(esk_partition *partition, uint32_t count, bool *filled)
{
	esk_labelling *labelling = &partition->labelling;
	*filled = false;
	for (uint32_t j = 0; j < count; j++) {
		if (labelling->sums[j].weight)
			continue;
		eskel_status status = give_voxel(labelling, farthest_voxel(labelling, partition->metric), j);
		if (status)
			return status;
		esk_relabeller_restart(&partition->relabeller);
		*filled = true;
	}
	return ESKEL_OK;
}

/* Every pass lowers sum w V over the classes, or keeps it and moves tied voxels to lower indices, so that no partition
 * returns and the iteration ends: but for the rounding of the scores, where two partitions that are equally good to
 * the last bits could take turns. So the sums are also compared with a snapshot, taken again after 1, 2, 4, 8 ...
 * passes (Brent's cycle detection): an end is certain. A cycle in which classes keep coming out empty has no result. */
eskel_status esk_partition_converge(esk_partition *partition, const esk_sums *starts, uint32_t count)
{
	esk_sums before[ESKEL_LEVELS_MAX], now[ESKEL_LEVELS_MAX], snapshot[ESKEL_LEVELS_MAX];
	esk_scores scores = {.count = count};
	for (uint32_t j = 0; j < count; j++)
		esk_scores_set(&scores, j, partition->metric, &starts[j]);
	memcpy(before, starts, count * sizeof *starts);
	memcpy(snapshot, starts, count * sizeof *starts);
	esk_relabeller_restart(&partition->relabeller);
	for (uint64_t passes = 1;; passes++) {
		bool filled = false;
		eskel_status status = esk_relabeller_run(&partition->relabeller, &scores);
		if (!status)
			status = fill_empty_classes(partition, count, &filled);
		if (status)
			return status;
		memcpy(now, partition->labelling.sums, count * sizeof *now);
		if (are_same(now, before, count) || are_same(now, snapshot, count))
			return filled ? ESKEL_NUMERIC : ESKEL_OK;
		for (uint32_t j = 0; j < count; j++)
			if (!is_same(&now[j], &before[j]))
				esk_scores_set(&scores, j, partition->metric, &now[j]);
		memcpy(before, now, count * sizeof *now);
		if ((passes & (passes - 1)) == 0)
			memcpy(snapshot, now, count * sizeof *now);
	}
}
