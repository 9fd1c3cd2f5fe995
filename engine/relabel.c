/* Most voxels keep their class from pass to pass, so a pass goes over blocks of neighbouring segments and in each
 *
 *	1. finds the candidates: classes that win somewhere in the block's box, as far as one comparison with the winner at
 *	   its centre tells. No other class matters there.
 *	2. skips settled segments. The slack of a segment is the least lead of a winner over the second best candidate at
 *	   the ends of its pieces. Leads are linear along a piece: no label changes before scores have moved, relative to
 *	   each other, by the slack. The block's clock adds up how far the candidates' scores have moved in its box; a new
 *	   candidate makes it look at all segments again.
 *	3. probes both ends of every piece of the others (probe.h). Where the piece's class wins at both ends it wins in
 *	   between, because a class wins an interval; most segments turn out right.
 *	4. cuts the wrong ones anew: between two places with different winners it puts the border where the one's score
 *	   overtakes the other's, and probes again. If a third class wins around that border, the probe finds it. Every
 *	   class that is found has its place in the segment, so after at most one probe a class all borders are right.
 */
#include "relabel.h"

#include "memory.h"
#include "probe.h"

#include <math.h>
#include <stdlib.h>

enum { BLOCK_SEGMENTS = 256 }; /* 128 to 256 are alike; smaller boxes do not pay for more looks at blocks */

typedef struct esk_block {
	double centre[3], half[3]; /* of a box around the segments */
	int64_t clock;
	int64_t due;               /* the least settled of its segments */
	uint64_t candidates;       /* of the last pass, a bit a class */
} block;

/* Segments of one block whose pieces are to be probed together. */
typedef struct esk_batch {
	esk_probes probes;
	size_t probe_count, segment_count;
	uint32_t owner[ESK_PROBE_ROOM]; /* of each probe: its segment's place in the arrays below */
	size_t segments[ESK_PROBES];
	size_t first[ESK_PROBES]; /* probe of the segment */
	double slack[ESK_PROBES];
} batch;

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
		.batch = esk_memory_zeroed_array(1, sizeof *relabeller->batch),
	};
	if (!relabeller->blocks || !relabeller->settled || !relabeller->batch) {
		esk_relabeller_clear(relabeller);
		return ESKEL_NO_MEMORY;
	}
	for (size_t b = 0; b < blocks; b++)
		set_box(relabeller, b);
	return ESKEL_OK;
}

void esk_relabeller_clear(esk_relabeller *relabeller)
{
	free(relabeller->blocks);
	free(relabeller->settled);
	free(relabeller->batch);
	*relabeller = (esk_relabeller){0};
}

void esk_relabeller_restart(esk_relabeller *relabeller)
{
	relabeller->before.count = 0;
}

/* ---------------------------------------------------------------------------------------------- probing */

static inline void put(batch *b, size_t i, int32_t x_first, const esk_segment *s, const esk_piece *piece)
{
	b->probes.x_first[i] = x_first;
	b->probes.x_last[i] = piece->x_last;
	b->probes.y[i] = s->y;
	b->probes.z[i] = s->z;
	b->probes.expected[i] = (int32_t)piece->class_index;
	b->owner[i] = (uint32_t)b->segment_count;
}

/* Most segments have one piece or two. Putting two in any case, which every slot has room for, saves a branch that
 * would be mispredicted half of the time; a second one too many is overwritten by the next segment. */
static void push(batch *b, const esk_labelling *labelling, size_t segment)
{
	const esk_segment *s = &labelling->segments[segment];
	const esk_slot *slot = &labelling->slots[segment];
	const esk_piece *piece = labelling->pieces + slot->first;
	const size_t first = b->probe_count;
	b->segments[b->segment_count] = segment;
	b->first[b->segment_count] = first;
	b->slack[b->segment_count] = 0x1p52;
	put(b, first, s->x_first, s, piece);
	for (uint32_t p = 1; p < slot->count || p == 1; p++)
		put(b, first + p, piece[p - 1].x_last + 2, s, piece + p);
	b->probe_count += slot->count;
	b->segment_count++;
}

/* The last x at which class a, which wins at x, has a lower score than class b, which wins further on. */
static int32_t crossing(const esk_scores *scores, const esk_segment *s, int32_t x, uint32_t a, uint32_t b)
{
	const double lead = esk_scores_at(scores, b, x, s->y, s->z) - esk_scores_at(scores, a, x, s->y, s->z);
	const double loss = 2 * (scores->slope[0][a] - scores->slope[0][b]); /* a voxel */
	return x + 2 * (int32_t)(((int64_t)lead - 1) / (int64_t)loss);
}

/* New pieces for a segment from the winners at the ends of its old ones, probes first .. end - 1. */
static eskel_status recut(esk_labelling *labelling, size_t segment, const esk_scores *scores, const esk_probes *probes,
	size_t first, size_t end)
{
	const esk_segment *s = &labelling->segments[segment];
	esk_piece pieces[ESKEL_LEVELS_MAX];
	uint32_t count = 0, winner = (uint32_t)probes->winner_first[first];
	int32_t x = s->x_first;
	for (size_t i = 2 * first; i < 2 * end; i++) {
		const bool last = i % 2;
		const uint32_t next = (uint32_t)(last ? probes->winner_last : probes->winner_first)[i / 2];
		if (next != winner)
			pieces[count++] = (esk_piece){crossing(scores, s, x, winner, next), winner};
		winner = next;
		x = (last ? probes->x_last : probes->x_first)[i / 2];
	}
	pieces[count++] = (esk_piece){s->x_last, winner};
	return esk_labelling_replace(labelling, segment, pieces, count);
}

/* Probes the batch and empties it. Segments that were wrong are kept in list[*kept], to be probed again. */
static eskel_status flush(
	esk_relabeller *relabeller, const esk_scores *scores, int64_t clock, size_t list[BLOCK_SEGMENTS], size_t *kept)
{
	batch *b = relabeller->batch;
	uint32_t wrong[ESK_PROBES];
	size_t wrong_count = 0;
	esk_probes_run(&b->probes, b->probe_count, &relabeller->near);
	for (size_t i = 0; i < b->probe_count; i++) {
		double *slack = &b->slack[b->owner[i]];
		*slack = b->probes.slack[i] < *slack ? b->probes.slack[i] : *slack;
	}
	for (size_t n = 0; n < b->segment_count; n++) {
		relabeller->settled[b->segments[n]] = clock + (int64_t)b->slack[n];
		wrong[wrong_count] = (uint32_t)n;
		wrong_count += b->slack[n] < 0;
	}
	for (size_t n = 0; n < wrong_count; n++) {
		const size_t segment = b->segments[wrong[n]], first = b->first[wrong[n]];
		eskel_status status = recut(relabeller->labelling, segment, scores, &b->probes, first,
			first + relabeller->labelling->slots[segment].count);
		if (status)
			return status;
		list[(*kept)++] = segment;
	}
	b->probe_count = 0;
	b->segment_count = 0;
	return ESKEL_OK;
}

/* Brings the labels of these segments, which are of one block, up to date. */
static eskel_status label_segments(
	esk_relabeller *relabeller, const esk_scores *scores, int64_t clock, size_t list[BLOCK_SEGMENTS], size_t count)
{
	const esk_slot *slots = relabeller->labelling->slots;
	for (size_t kept = 0; count; count = kept, kept = 0) {
		for (size_t i = 0; i < count; i++) {
			if (relabeller->batch->probe_count + slots[list[i]].count > ESK_PROBES) {
				eskel_status status = flush(relabeller, scores, clock, list, &kept);
				if (status)
					return status;
			}
			push(relabeller->batch, relabeller->labelling, list[i]);
		}
		eskel_status status = flush(relabeller, scores, clock, list, &kept);
		if (status)
			return status;
	}
	return ESKEL_OK;
}

/* ---------------------------------------------------------------------------------------------- blocks */

/* The scores of the candidates, and their bits. The order of classes in near is of no account: a score carries its
 * class. All numbers are integers below 2^53: the greatest difference of two scores in the box bounds them. */
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
	const uint64_t candidates = find_candidates(b, scores, &relabeller->near);
	if (!relabeller->before.count || (candidates & ~b->candidates) || b->clock > INT64_MAX / 2)
		unsettle(relabeller, index);
	else
		b->clock += movement_in(b, &relabeller->before, scores);
	b->candidates = candidates;
	if (b->due > b->clock)
		return ESKEL_OK;
	size_t list[BLOCK_SEGMENTS];
	eskel_status status =
		label_segments(relabeller, scores, b->clock, list, list_unsettled(relabeller, index, list));
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
