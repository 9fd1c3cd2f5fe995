#include "partition.h"

#include <math.h>
#include <string.h>

eskel_status esk_partition_init(esk_partition *partition, const esk_segment *segments, size_t segment_count,
	const esk_metric *metric, esk_team *team)
{
	*partition = (esk_partition){.metric = metric};
	return esk_relabeller_init(&partition->relabeller, segments, segment_count, team);
}

void esk_partition_clear(esk_partition *partition)
{
	esk_relabeller_clear(&partition->relabeller);
}

void esk_partition_assign(esk_partition *partition, const esk_scores *scores)
{
	esk_relabeller_restart(&partition->relabeller);
	esk_relabeller_run(&partition->relabeller, scores, partition->sums);
}

eskel_status esk_partition_label(const esk_partition *partition, esk_labelling *labelling)
{
	return esk_relabeller_label(&partition->relabeller, labelling);
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

/* By z, then y, then x. */
static bool is_before(const esk_segment *a, const esk_segment *b)
{
	if (a->z != b->z)
		return a->z < b->z;
	return a->y != b->y ? a->y < b->y : a->x_first < b->x_first;
}

/* Gives a class the voxel farthest from its centre, among classes of two voxels or more; the first one on a tie.
 * Distance is convex along a part, so the ends of parts suffice. */
static eskel_status give_farthest_voxel(esk_partition *partition, esk_labelling *labelling, uint32_t class_index)
{
	esk_sums *sums = partition->sums;
	uint64_t voxels[ESKEL_LEVELS_MAX] = {0};
	for (size_t i = 0; i < labelling->count; i++)
		voxels[labelling->parts[i].class_index] += esk_segment_voxels(&labelling->parts[i].segment);
	double farthest = -1;
	size_t found = 0;
	esk_segment voxel = {0};
	for (size_t i = 0; i < labelling->count; i++) {
		const esk_part *part = &labelling->parts[i];
		for (int end = 0; end < 2 && voxels[part->class_index] >= 2; end++) {
			esk_segment here = part->segment;
			here.x_first = here.x_last = end ? here.x_last : here.x_first;
			const double u[3] = {here.x_first, here.y, here.z};
			const double d = squared_distance(partition->metric, &sums[part->class_index], u);
			if (d > farthest || (d == farthest && is_before(&here, &voxel))) {
				farthest = d;
				found = i;
				voxel = here;
			}
		}
	}
	esk_sums_remove(&sums[labelling->parts[found].class_index], &voxel);
	esk_sums_add(&sums[class_index], &voxel);
	return esk_labelling_give(labelling, found, voxel.x_first, class_index);
}

/* Gives every empty class a voxel. *filled tells whether there was one. */
static eskel_status fill_empty_classes(esk_partition *partition, uint32_t count, bool *filled)
{
	esk_labelling labelling = {0};
	eskel_status status = ESKEL_OK;
	*filled = false;
	for (uint32_t j = 0; j < count && !status; j++) {
		if (partition->sums[j].weight)
			continue;
		if (!*filled)
			status = esk_partition_label(partition, &labelling);
		if (!status)
			status = give_farthest_voxel(partition, &labelling, j);
		*filled = true;
	}
	esk_labelling_clear(&labelling);
	return status;
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
		esk_relabeller_run(&partition->relabeller, &scores, partition->sums);
		eskel_status status = fill_empty_classes(partition, count, &filled);
		if (status)
			return status;
		memcpy(now, partition->sums, count * sizeof *now);
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
