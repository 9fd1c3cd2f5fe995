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

/* Moves the voxel farthest from its centre, among classes of two voxels or more, to the empty class. Only these sums
 * change, not the labels: the voxel is now the centre of that class, so the next pass moves it. Distance is convex
 * along a piece, so its ends suffice. */
static void fill_empty_class(const esk_partition *partition, esk_sums *sums, uint32_t empty)
{
	const esk_labelling *labelling = &partition->labelling;
	uint64_t voxels[ESKEL_LEVELS_MAX] = {0};
	for (esk_piece_cursor c = esk_labelling_first(labelling); c.valid; esk_labelling_next(labelling, &c))
		voxels[c.class_index] += esk_segment_voxels(&c.part);
	double farthest = -1;
	esk_segment voxel = {0};
	uint32_t from = 0;
	for (esk_piece_cursor c = esk_labelling_first(labelling); c.valid; esk_labelling_next(labelling, &c))
		for (int end = 0; end < 2; end++) {
			int32_t x = end ? c.part.x_last : c.part.x_first;
			double d = squared_distance(
				partition->metric, &sums[c.class_index], (double[3]){x, c.part.y, c.part.z});
			if (voxels[c.class_index] >= 2 && d > farthest) {
				farthest = d;
				from = c.class_index;
				voxel = (esk_segment){x, x, c.part.y, c.part.z, c.part.weight};
			}
		}
	esk_sums_add(&sums[empty], &voxel);
	esk_sums_remove(&sums[from], &voxel);
}

/* Brings the scores of classes whose centre changed up to date. Returns how far two classes' scores may have moved
 * relative to each other anywhere in the box: the sum of the two greatest changes of a score. */
static int64_t update_scores(const esk_metric *metric, const esk_sums *before, const esk_sums *now, esk_scores *scores)
{
	double greatest = 0, second = 0;
	for (uint32_t j = 0; j < scores->count; j++) {
		if (is_same(&before[j], &now[j]))
			continue;
		double constant = scores->constant[j], slope[3], change;
		for (int r = 0; r < 3; r++)
			slope[r] = scores->slope[r][j];
		esk_scores_set(scores, j, metric, &now[j]);
		change = fabs(scores->constant[j] - constant);
		for (int r = 0; r < 3; r++)
			change += fabs(scores->slope[r][j] - slope[r]) * metric->half[r];
		if (change > greatest) {
			second = greatest;
			greatest = change;
		} else if (change > second)
			second = change;
	}
	return (int64_t)(greatest + second);
}

/* Every pass lowers sum w V over the classes, or keeps it and moves tied voxels to lower indices, so that no partition
 * returns and the iteration ends: but for the rounding of the scores, where two partitions equally good to 2^-30 of
 * the object's size could take turns. So the sums are also compared with a snapshot, taken again after 1, 2, 4, 8 ...
 * passes (Brent's cycle detection): an end is certain. */
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
		eskel_status status = esk_relabeller_run(&partition->relabeller, &scores);
		if (status)
			return status;
		memcpy(now, partition->labelling.sums, count * sizeof *now);
		for (uint32_t j = 0; j < count; j++)
			if (!now[j].weight)
				fill_empty_class(partition, now, j);
		if (are_same(now, before, count) || are_same(now, snapshot, count))
			return ESKEL_OK;
		esk_relabeller_advance(&partition->relabeller, update_scores(partition->metric, before, now, &scores));
		memcpy(before, now, count * sizeof *now);
		if ((passes & (passes - 1)) == 0)
			memcpy(snapshot, now, count * sizeof *now);
	}
}
