#include "levels.h"

#include "memory.h"
#include "partition.h"
#include "split.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	const esk_levels_input *input;
	esk_levels *levels;
	esk_partition partition;      /* of the last level */
	bool known[ESKEL_LEVELS_MAX]; /* the split of a class whose voxels have not changed since */
	esk_split splits[ESKEL_LEVELS_MAX];
} builder;

static eskel_status split_classes(builder *b)
{
	const esk_levels_input *input = b->input;
	const uint32_t k = b->levels->count;
	const esk_moments *classes = &b->levels->classes[ESKEL_NODES(k - 1)];
	const eskel_affine *map = k == 1 ? input->root_map : &input->metric->map;
	esk_segment *segments = NULL;
	size_t first[ESKEL_LEVELS_MAX + 1];
	eskel_status status = esk_labelling_collect(&b->partition.labelling, &segments, first);
	for (uint32_t j = 0; !status && j < k; j++) {
		if (b->known[j])
			continue;
		status = esk_split_class(
			segments + first[j], first[j + 1] - first[j], &classes[j], input->metric, map, &b->splits[j]);
		b->known[j] = true;
	}
	free(segments);
	return status;
}

/* The class of least ratio, the lowest index on a tie; -1 when none can be split. */
static int32_t best_split(const builder *b)
{
	int32_t best = -1;
	for (uint32_t j = 0; j < b->levels->count; j++)
		if (b->splits[j].possible && (best < 0 || b->splits[j].ratio < b->splits[best].ratio))
			best = (int32_t)j;
	return best;
}

/* The next level starts from this level's classes, one of them split. about->split_class is -1 if there is no next
 * level. */
static eskel_status start_by_splitting(builder *b, eskel_level *about, esk_sums *starts)
{
	const uint32_t k = b->levels->count;
	eskel_status status = split_classes(b);
	if (status)
		return status;
	about->split_class = best_split(b);
	if (about->split_class < 0)
		return ESKEL_OK;
	const esk_split *split = &b->splits[about->split_class];
	for (uint32_t j = 0; j < k; j++)
		starts[j] = b->levels->classes[ESKEL_NODES(k - 1) + j].sums;
	starts[about->split_class] = split->parts[0];
	starts[k] = split->parts[1];
	about->split_ratio = split->ratio;
	about->degenerate = split->degenerate;
	return ESKEL_OK;
}

/* The next level starts from the centres of other levels. */
static void start_from(const esk_levels *others, uint32_t k, eskel_level *about, esk_sums *starts)
{
	*about = others->about[k];
	for (uint32_t j = 0; j <= k; j++)
		starts[j] = others->classes[ESKEL_NODES(k) + j].sums;
}

static double intraclass_ratio(const builder *b, const esk_moments *classes, uint32_t count)
{
	const int64_t(*form)[3] = b->input->metric->form;
	const double whole = esk_moments_inertia(b->levels->classes, form);
	double sum = 0;
	for (uint32_t j = 0; j < count; j++)
		sum += esk_moments_inertia(&classes[j], form);
	return whole > 0 ? sum / whole : 0;
}

static void add_first_level(builder *b)
{
	esk_labelling_moments(&b->partition.labelling, (const bool[ESKEL_LEVELS_MAX]){true}, b->levels->classes);
	b->levels->about[0] = (eskel_level){.level = 1, .split_class = -1};
	b->levels->about[0].intraclass_ratio = intraclass_ratio(b, b->levels->classes, 1);
	b->levels->count = 1;
}

/* Adds the level that starts lead to. Moments and splits of classes that come out as they were are kept. */
static eskel_status add_level(builder *b, const eskel_level *about, const esk_sums *starts)
{
	const uint32_t k = b->levels->count;
	bool *touched = b->partition.labelling.touched;
	esk_moments *classes = &b->levels->classes[ESKEL_NODES(k)];
	memset(touched, 0, sizeof b->partition.labelling.touched);
	eskel_status status = esk_partition_converge(&b->partition, starts, k + 1);
	if (status)
		return status;
	memcpy(classes, &b->levels->classes[ESKEL_NODES(k - 1)], k * sizeof *classes);
	esk_labelling_moments(&b->partition.labelling, touched, classes);
	for (uint32_t j = 0; j <= k; j++)
		b->known[j] = b->known[j] && !touched[j];
	b->levels->about[k] = *about;
	b->levels->about[k].intraclass_ratio = intraclass_ratio(b, classes, k + 1);
	b->levels->count = k + 1;
	return ESKEL_OK;
}

static eskel_status build(builder *b)
{
	const esk_levels_input *input = b->input;
	add_first_level(b);
	for (;;) {
		const uint32_t k = b->levels->count;
		if (input->progress && !input->progress(input->context, k, input->levels))
			return ESKEL_CANCELLED;
		if (k == input->levels)
			return ESKEL_OK;
		esk_sums starts[ESKEL_LEVELS_MAX];
		eskel_level about = {.level = k + 1};
		eskel_status status = ESKEL_OK;
		if (input->starts && k < input->starts->count)
			start_from(input->starts, k, &about, starts);
		else
			status = start_by_splitting(b, &about, starts);
		if (!status && about.split_class < 0)
			return ESKEL_OK;
		if (!status)
			status = add_level(b, &about, starts);
		if (status)
			return status;
	}
}

eskel_status esk_levels_compute(const esk_levels_input *input, esk_levels *levels)
{
	builder *b = esk_memory_zeroed_array(1, sizeof *b);
	if (!b)
		return ESKEL_NO_MEMORY;
	b->input = input;
	b->levels = levels;
	eskel_status status = esk_partition_init(&b->partition, input->segments, input->segment_count, input->metric);
	if (!status)
		status = build(b);
	esk_partition_clear(&b->partition);
	free(b);
	return status;
}
