#include "levels.h"

#include "memory.h"
#include "partition.h"
#include "split.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	const esk_levels_input *input;
	esk_levels *levels;
	esk_partition partition; /* of the last level */
	esk_labelling labelling; /* its labels */
	esk_segment *segments;   /* and its classes one after the other: class j is from first[j] to first[j + 1] */
	size_t first[ESKEL_LEVELS_MAX + 1];
	double least_ratios[ESKEL_LEVELS_MAX]; /* no split of the class has a lesser one */
	bool known[ESKEL_LEVELS_MAX];          /* the split of a class whose voxels have not changed since */
	esk_split splits[ESKEL_LEVELS_MAX];
} builder;

/* The class of least ratio, the lowest index on a tie; -1 when none can be split. */
static int32_t best_split(const builder *b)
{
	int32_t best = -1;
	for (uint32_t j = 0; j < b->levels->count; j++)
		if (b->known[j] && b->splits[j].possible && (best < 0 || b->splits[j].ratio < b->splits[best].ratio))
			best = (int32_t)j;
	return best;
}

/* The class that may have the least ratio among those whose split is neither known nor being computed; -1 when no split
 * can be better than the best that is known. */
static int32_t most_promising(const builder *b, uint64_t computing)
{
	const int32_t best = best_split(b);
	int32_t found = -1;
	for (uint32_t j = 0; j < b->levels->count; j++)
		if (!b->known[j] && !(computing >> j & 1) &&
			(best < 0 || b->least_ratios[j] <= b->splits[best].ratio) &&
			(found < 0 || b->least_ratios[j] < b->least_ratios[found]))
			found = (int32_t)j;
	return found;
}

/* Splits that threads compute at the same time. */
typedef struct {
	const builder *b;
	uint32_t count;
	int32_t classes[ESKEL_LEVELS_MAX];
	esk_split splits[ESKEL_LEVELS_MAX];
	eskel_status statuses[ESKEL_LEVELS_MAX];
} splitting;

static void split_one(void *context, size_t index)
{
	splitting *s = context;
	const builder *b = s->b;
	const int32_t j = s->classes[index];
	const uint32_t k = b->levels->count;
	s->statuses[index] = esk_split_class(b->segments + b->first[j], b->first[j + 1] - b->first[j],
		&b->levels->classes[ESKEL_NODES(k - 1) + (uint32_t)j], b->input->metric,
		k == 1 ? b->input->root_map : &b->input->metric->map, &s->splits[index]);
}

static void choose_splits(const builder *b, splitting *s)
{
	uint64_t computing = 0;
	*s = (splitting){.b = b};
	for (int32_t j; s->count < esk_team_size(b->input->team) && (j = most_promising(b, computing)) >= 0;) {
		computing |= (uint64_t)1 << j;
		s->classes[s->count++] = j;
	}
}

/* Finds the splits that can be the best. What several threads compute too much is forgotten, so that they find, or fail
 * with, what one does. */
static eskel_status split_classes(builder *b)
{
	splitting s;
	for (choose_splits(b, &s); s.count; choose_splits(b, &s)) {
		esk_team_run(b->input->team, s.count, split_one, &s);
		for (uint32_t i = 0; i < s.count && s.classes[i] == most_promising(b, 0); i++) {
			const int32_t j = s.classes[i];
			if (s.statuses[i])
				return s.statuses[i];
			b->splits[j] = s.splits[i];
			b->known[j] = true;
		}
	}
	return ESKEL_OK;
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

static void sum_moments(const esk_segment *segments, size_t count, esk_moments *moments)
{
	*moments = (esk_moments){0};
	for (size_t i = 0; i < count; i++)
		esk_moments_add(moments, &segments[i]);
}

/* The only class of the first level is all of the segments. */
static eskel_status add_first_level(builder *b)
{
	const esk_levels_input *input = b->input;
	b->segments = esk_memory_array(input->segment_count, sizeof *b->segments);
	if (!b->segments)
		return ESKEL_NO_MEMORY;
	memcpy(b->segments, input->segments, input->segment_count * sizeof *b->segments);
	for (uint32_t j = 1; j <= ESKEL_LEVELS_MAX; j++)
		b->first[j] = input->segment_count;
	sum_moments(b->segments, input->segment_count, b->levels->classes);
	b->levels->about[0] = (eskel_level){.level = 1, .split_class = -1};
	b->levels->about[0].intraclass_ratio = intraclass_ratio(b, b->levels->classes, 1);
	b->levels->count = 1;
	return ESKEL_OK;
}

/* Adds the level that starts lead to. Moments and splits of classes that come out as they were are kept. */
static eskel_status add_level(builder *b, const eskel_level *about, const esk_sums *starts)
{
	const uint32_t k = b->levels->count;
	esk_moments *classes = &b->levels->classes[ESKEL_NODES(k)];
	const esk_moments *before = &b->levels->classes[ESKEL_NODES(k - 1)];
	esk_segment *segments = NULL;
	size_t first[ESKEL_LEVELS_MAX + 1];
	eskel_status status = esk_partition_converge(&b->partition, starts, k + 1);
	if (!status)
		status = esk_partition_label(&b->partition, &b->labelling);
	if (!status)
		status = esk_labelling_collect(&b->labelling, &segments, first);
	if (status)
		return status;
	for (uint32_t j = 0; j <= k; j++) {
		const size_t count = first[j + 1] - first[j];
		const bool same = j < k && count == b->first[j + 1] - b->first[j] &&
				  !memcmp(segments + first[j], b->segments + b->first[j], count * sizeof *segments);
		if (same)
			classes[j] = before[j];
		else
			sum_moments(segments + first[j], count, &classes[j]);
		b->known[j] = b->known[j] && same;
		b->least_ratios[j] = esk_split_least_ratio(&classes[j], b->input->metric);
	}
	free(b->segments);
	b->segments = segments;
	memcpy(b->first, first, sizeof first);
	b->levels->about[k] = *about;
	b->levels->about[k].intraclass_ratio = intraclass_ratio(b, classes, k + 1);
	b->levels->count = k + 1;
	return ESKEL_OK;
}

static eskel_status build(builder *b)
{
	const esk_levels_input *input = b->input;
	eskel_status status = add_first_level(b);
	if (status)
		return status;
	for (;;) {
		const uint32_t k = b->levels->count;
		if (input->progress && !input->progress(input->context, k, input->levels))
			return ESKEL_CANCELLED;
		if (k == input->levels)
			return ESKEL_OK;
		esk_sums starts[ESKEL_LEVELS_MAX];
		eskel_level about = {.level = k + 1};
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
	eskel_status status =
		esk_partition_init(&b->partition, input->segments, input->segment_count, input->metric, input->team);
	if (!status)
		status = build(b);
	esk_partition_clear(&b->partition);
	esk_labelling_clear(&b->labelling);
	free(b->segments);
	free(b);
	return status;
}
