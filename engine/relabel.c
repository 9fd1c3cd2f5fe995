/* Most voxels keep their class from pass to pass, so a pass goes over blocks of neighbouring segments and in each
 *
 *	1. finds the candidates: classes that win somewhere in the block's box, as far as one comparison with the winner at
 *	   its centre tells. No other class matters there.
 *	2. skips settled segments. Leads of a winner over another class are linear along a piece, so no label changes before
 *	   scores have moved, relative to each other, by the segment's slack (cutter.h). The block's clock adds up how far
 *	   the candidates' scores have moved in its box; a new candidate makes it look at all segments again.
 *	3. has the others checked, and cut anew where that is needed.
 */
#include "relabel.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>

enum { BLOCK_SEGMENTS = 256 }; /* 128 to 256 are alike; smaller boxes do not pay for more looks at blocks */

typedef struct esk_block {
	double centre[3], half[3]; /* of a box around the segments */
	int64_t clock;
	int64_t due;         /* the least settled of its segments */
	uint64_t candidates; /* of the last pass, a bit a class */
} block;

static size_t block_end(const esk_relabeller *relabeller, size_t b)
{
	const size_t end = (b + 1) * BLOCK_SEGMENTS, all = relabeller->labelling->segment_count;
	return end < all ? end : all;
}

static void set_box(const esk_relabeller *relabeller, size_t b)
{
	const esk_segment *s = &relabeller->labelling->segments[b * BLOCK_SEGMENTS];
	int32_t least[3] = {s->x_first, s->y, s->z}, greatest[3] = {s->x_last, s->y, s->z};
	for (size_t i = b * BLOCK_SEGMENTS; i < block_end(relabeller, b); i++) {
		s = &relabeller->labelling->segments[i];
		const int32_t first[3] = {s->x_first, s->y, s->z}, last[3] = {s->x_last, s->y, s->z};
		for (int r = 0; r < 3; r++) {
			least[r] = first[r] < least[r] ? first[r] : least[r];
			greatest[r] = last[r] > greatest[r] ? last[r] : greatest[r];
		}
	}
	for (int r = 0; r < 3; r++) {
		relabeller->blocks[b].centre[r] = (least[r] + greatest[r]) / 2; /* of one parity, so exact */
		relabeller->blocks[b].half[r] = (greatest[r] - least[r]) / 2;
	}
}

eskel_status esk_relabeller_init(esk_relabeller *relabeller, esk_labelling *labelling)
{
	const size_t blocks = (labelling->segment_count + BLOCK_SEGMENTS - 1) / BLOCK_SEGMENTS;
	*relabeller = (esk_relabeller){
		.labelling = labelling,
		.block_count = blocks,
		.blocks = esk_memory_zeroed_array(blocks, sizeof *relabeller->blocks),
		.settled = esk_memory_array(labelling->segment_count, sizeof *relabeller->settled),
	};
	eskel_status status = relabeller->blocks && relabeller->settled ? ESKEL_OK : ESKEL_NO_MEMORY;
	if (!status)
		status = esk_cutter_init(&relabeller->cutter, labelling, relabeller->settled);
	if (status) {
		esk_relabeller_clear(relabeller);
		return status;
	}
	for (size_t b = 0; b < blocks; b++)
		set_box(relabeller, b);
	return ESKEL_OK;
}

void esk_relabeller_clear(esk_relabeller *relabeller)
{
	esk_cutter_clear(&relabeller->cutter);
	free(relabeller->blocks);
	free(relabeller->settled);
	*relabeller = (esk_relabeller){0};
}

void esk_relabeller_restart(esk_relabeller *relabeller)
{
	relabeller->before.count = 0;
}

/* The scores of the candidates, and their bits. All numbers are integers below 2^53: the greatest difference of two scores in the box bounds them. */
static uint64_t find_candidates(const block *b, const esk_scores *scores, esk_scores *near)
{
	double at_centre[ESKEL_LEVELS_MAX];
	uint32_t winner = 0;
	for (uint32_t j = 0; j < scores->count; j++) {
		at_centre[j] = esk_scores_at(scores, j, b->centre[0], b->centre[1], b->centre[2]);
		winner = at_centre[j] < at_centre[winner] ? j : winner;
	}
	uint64_t candidates = 0;
	near->count = 0;
	for (uint32_t j = 0; j < scores->count; j++) {
		double least_lead = at_centre[j] - at_centre[winner]; /* of the winner over j, in the box */
		for (int r = 0; r < 3; r++)
			least_lead -= fabs(scores->slope[r][j] - scores->slope[r][winner]) * b->half[r];
		near->constant[near->count] = scores->constant[j];
		for (int r = 0; r < 3; r++)
			near->slope[r][near->count] = scores->slope[r][j];
		near->count += least_lead <= 0;
		candidates |= (uint64_t)(least_lead <= 0) << j;
	}
	return candidates;
}

/* How far the scores of two candidates of the last pass may have moved relative to each other in the box: the sum of
 * the two greatest movements. */
static int64_t movement_in(const block *b, const esk_scores *before, const esk_scores *now)
{
	double greatest = 0, second = 0;
	for (uint64_t candidates = b->candidates; candidates; candidates &= candidates - 1) {
		const int j = __builtin_ctzll(candidates);
		double at_centre = now->constant[j] - before->constant[j], around = 0;
		for (int r = 0; r < 3; r++) {
			double slope = now->slope[r][j] - before->slope[r][j];
			at_centre += slope * b->centre[r];
			around += fabs(slope) * b->half[r];
		}
		const double movement = fabs(at_centre) + around;
		second = movement > greatest ? greatest : movement > second ? movement : second;
		greatest = movement > greatest ? movement : greatest;
	}
	return (int64_t)greatest + (int64_t)second;
}

/* Segments that are not settled; written without a branch, as about half of them are. */
static size_t list_unsettled(const esk_relabeller *relabeller, size_t index, size_t list[BLOCK_SEGMENTS])
{
	const int64_t clock = relabeller->blocks[index].clock;
	size_t count = 0;
	for (size_t i = index * BLOCK_SEGMENTS; i < block_end(relabeller, index); i++) {
		list[count] = i;
		count += relabeller->settled[i] <= clock;
	}
	return count;
}

static void unsettle(esk_relabeller *relabeller, size_t index)
{
	relabeller->blocks[index].clock = 0;
	relabeller->blocks[index].due = 0;
	for (size_t i = index * BLOCK_SEGMENTS; i < block_end(relabeller, index); i++)
		relabeller->settled[i] = 0;
}

static int64_t least_settled(const esk_relabeller *relabeller, size_t index)
{
	int64_t least = INT64_MAX;
	for (size_t i = index * BLOCK_SEGMENTS; i < block_end(relabeller, index); i++)
		least = relabeller->settled[i] < least ? relabeller->settled[i] : least;
	return least;
}

static eskel_status label_block(esk_relabeller *relabeller, size_t index, const esk_scores *scores)
{
	block *b = &relabeller->blocks[index];
	esk_scores near;
	const uint64_t candidates = find_candidates(b, scores, &near);
	if (!relabeller->before.count || (candidates & ~b->candidates) || b->clock > INT64_MAX / 2)
		unsettle(relabeller, index);
	else
		b->clock += movement_in(b, &relabeller->before, scores);
	b->candidates = candidates;
	if (b->due > b->clock)
		return ESKEL_OK;
	size_t list[BLOCK_SEGMENTS];
	eskel_status status = esk_cutter_run(
		&relabeller->cutter, scores, &near, b->clock, list, list_unsettled(relabeller, index, list));
	b->due = least_settled(relabeller, index);
	return status;
}

eskel_status esk_relabeller_run(esk_relabeller *relabeller, const esk_scores *scores)
{
	relabeller->labelling->class_count = scores->count;
	for (size_t b = 0; b < relabeller->block_count; b++) {
		eskel_status status = label_block(relabeller, b, scores);
		if (status)
			return status;
	}
	relabeller->before = *scores;
	return ESKEL_OK;
}
