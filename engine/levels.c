#include "levels.h"

#include "memory.h"
#include "partition.h"
#include "split.h"

#include <stdlib.h>
#include <string.h>

/* What is known of the split of each class of the current level. */
typedef struct {
	bool known[ESKEL_LEVELS_MAX];
	esk_split of[ESKEL_LEVELS_MAX];
} splits;

static eskel_status split_all(
	const esk_levels_input *input, const esk_partition *partition, const esk_moments *classes, splits *s)
{
	esk_segment *segments = NULL;
	size_t first[ESKEL_LEVELS_MAX + 1];
	eskel_status status = esk_labelling_collect(&partition->labelling, &segments, first);
	const eskel_affine *map = partition->labelling.class_count == 1 ? input->root_map : &input->metric->map;
	for (uint32_t j = 0; !status && j < partition->labelling.class_count; j++) {
		if (s->known[j])
			continue;
		status = esk_split_class(
			segments + first[j], first[j + 1] - first[j], &classes[j], input->metric, map, &s->of[j]);
		s->known[j] = true;
	}
	free(segments);
	return status;
}

/* The class of least ratio, the lowest index on a tie; -1 when none can be split. */
static int32_t best_split(const splits *s, uint32_t count)
{
	int32_t best = -1;
	for (uint32_t j = 0; j < count; j++)
		if (s->of[j].possible && (best < 0 || s->of[j].ratio < s->of[best].ratio))
			best = (int32_t)j;
	return best;
}

static double intraclass_ratio(const esk_moments *classes, uint32_t count, double whole, const esk_metric *metric)
{
	double sum = 0;
	for (uint32_t j = 0; j < count; j++)
		sum += esk_moments_inertia(&classes[j], metric->form);
	return whole > 0 ? sum / whole : 0;
}

static eskel_status next_level(const esk_levels_input *input, esk_partition *partition, splits *s, esk_levels *levels)
{
	const uint32_t k = levels->count;
	const esk_moments *classes = &levels->classes[ESKEL_NODES(k - 1)];
	esk_moments *next = &levels->classes[ESKEL_NODES(k)];
	esk_sums starts[ESKEL_LEVELS_MAX];
	eskel_level about = {.level = k + 1};
	if (input->starts && k < input->starts->count) {
		about = input->starts->about[k];
		for (uint32_t j = 0; j <= k; j++)
			starts[j] = input->starts->classes[ESKEL_NODES(k) + j].sums;
	} else {
		eskel_status status = split_all(input, partition, classes, s);
		if (status)
			return status;
		int32_t best = best_split(s, k);
		if (best < 0)
			return ESKEL_EMPTY;
		for (uint32_t j = 0; j < k; j++)
			starts[j] = classes[j].sums;
		starts[best] = s->of[best].parts[0];
		starts[k] = s->of[best].parts[1];
		about.split_class = best;
		about.split_ratio = s->of[best].ratio;
		about.degenerate = s->of[best].degenerate;
	}
	bool *touched = partition->labelling.touched;
	memset(touched, 0, sizeof partition->labelling.touched);
	eskel_status status = esk_partition_converge(partition, starts, k + 1);
	if (status)
		return status;
	memcpy(next, classes, k * sizeof *next);
	esk_labelling_moments(&partition->labelling, touched, next);
	for (uint32_t j = 0; j <= k; j++)
		s->known[j] = s->known[j] && !touched[j];
	about.intraclass_ratio = intraclass_ratio(
		next, k + 1, esk_moments_inertia(&levels->classes[0], input->metric->form), input->metric);
	levels->about[k] = about;
	levels->count = k + 1;
	return ESKEL_OK;
}

static void first_level(const esk_levels_input *input, esk_partition *partition, esk_levels *levels)
{
	esk_labelling_moments(&partition->labelling, (const bool[ESKEL_LEVELS_MAX]){true}, levels->classes);
	levels->about[0] = (eskel_level){.level = 1, .split_class = -1};
	levels->about[0].intraclass_ratio = esk_moments_inertia(&levels->classes[0], input->metric->form) > 0 ? 1 : 0;
	levels->count = 1;
}

eskel_status esk_levels_compute(const esk_levels_input *input, esk_levels *levels)
{
	esk_partition partition = {0};
	splits *s = esk_memory_zeroed_array(1, sizeof *s);
	eskel_status status = s ? ESKEL_OK : ESKEL_NO_MEMORY;
	if (!status)
		status = esk_partition_init(&partition, input->segments, input->segment_count, input->metric);
	if (!status)
		first_level(input, &partition, levels);
	while (!status) {
		if (input->progress && !input->progress(input->context, levels->count, input->levels))
			status = ESKEL_CANCELLED;
		if (status || levels->count == input->levels)
			break;
		status = next_level(input, &partition, s, levels);
		if (status == ESKEL_EMPTY) {
			status = ESKEL_OK;
			break;
		}
	}
	esk_partition_clear(&partition);
	free(s);
	return status;
}
