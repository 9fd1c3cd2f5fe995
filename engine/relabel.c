/* Most voxels keep their class from pass to pass, so a pass
 *
 *	1. skips settled segments. The slack of a segment is the least lead of a winner over the second best class at the
 *	   ends of its pieces. Leads are linear along a piece: no label changes before scores have moved, relative to each
 *	   other, by the slack. The clock adds up the movements.
 *	2. probes both ends of every piece of the others (probe.h). Where the piece's class wins at both ends it wins in
 *	   between, because a class wins an interval; most segments turn out right.
 *	3. cuts the wrong ones anew: between two places with different winners it puts the border where the one's score
 *	   overtakes the other's, and probes again. If a third class wins around that border, the probe finds it. Every
 *	   class that is found has its place in the segment, so after at most one probe a class all borders are right.
 */
#include "relabel.h"

#include "memory.h"
#include "probe.h"

#include <stdlib.h>
#include <string.h>

/* Segments whose pieces are to be probed together. */
typedef struct esk_batch {
	esk_probes probes;
	size_t probe_count, segment_count;
	uint32_t owner[ESK_PROBE_ROOM]; /* of each probe: its segment's place in the arrays below */
	size_t segments[ESK_PROBES];
	size_t first[ESK_PROBES]; /* probe of the segment */
	double slack[ESK_PROBES];
} batch;

eskel_status esk_relabeller_init(esk_relabeller *relabeller, esk_labelling *labelling)
{
	int64_t *settled = esk_memory_zeroed_array(labelling->segment_count, sizeof *settled);
	size_t *list = esk_memory_array(labelling->segment_count, sizeof *list);
	batch *b = esk_memory_zeroed_array(1, sizeof *b);
	if (!settled || !list || !b) {
		free(settled);
		free(list);
		free(b);
		return ESKEL_NO_MEMORY;
	}
	*relabeller = (esk_relabeller){.labelling = labelling, .settled = settled, .list = list, .batch = b};
	return ESKEL_OK;
}

void esk_relabeller_clear(esk_relabeller *relabeller)
{
	free(relabeller->settled);
	free(relabeller->list);
	free(relabeller->batch);
	*relabeller = (esk_relabeller){0};
}

void esk_relabeller_restart(esk_relabeller *relabeller)
{
	relabeller->clock = 0;
	memset(relabeller->settled, 0, relabeller->labelling->segment_count * sizeof *relabeller->settled);
}

/* Movements and slacks are below 2^53: the clock cannot overflow between two looks at this bound. */
void esk_relabeller_advance(esk_relabeller *relabeller, int64_t movement)
{
	relabeller->clock += movement;
	if (relabeller->clock > INT64_MAX / 2)
		esk_relabeller_restart(relabeller);
}

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

/* Probes the batch and empties it. Segments that were wrong go to list[*kept], to be probed again. */
static eskel_status flush(batch *b, esk_relabeller *relabeller, const esk_scores *scores, size_t *kept)
{
	esk_labelling *labelling = relabeller->labelling;
	uint32_t wrong[ESK_PROBES];
	size_t wrong_count = 0;
	esk_probes_run(&b->probes, b->probe_count, scores);
	for (size_t i = 0; i < b->probe_count; i++) {
		double *slack = &b->slack[b->owner[i]];
		*slack = b->probes.slack[i] < *slack ? b->probes.slack[i] : *slack;
	}
	for (size_t n = 0; n < b->segment_count; n++) {
		relabeller->settled[b->segments[n]] = relabeller->clock + (int64_t)b->slack[n];
		wrong[wrong_count] = (uint32_t)n;
		wrong_count += b->slack[n] < 0;
	}
	for (size_t n = 0; n < wrong_count; n++) {
		const size_t segment = b->segments[wrong[n]], first = b->first[wrong[n]];
		eskel_status status =
			recut(labelling, segment, scores, &b->probes, first, first + labelling->slots[segment].count);
		if (status)
			return status;
		relabeller->list[(*kept)++] = segment;
	}
	b->probe_count = 0;
	b->segment_count = 0;
	return ESKEL_OK;
}

/* Segments that are not settled; written without a branch, as about half of them are. */
static size_t list_unsettled(const esk_relabeller *relabeller)
{
	const size_t segments = relabeller->labelling->segment_count;
	const int64_t *settled = relabeller->settled, clock = relabeller->clock;
	size_t *list = relabeller->list, count = 0;
	for (size_t i = 0; i < segments; i++) {
		list[count] = i;
		count += settled[i] <= clock;
	}
	return count;
}

eskel_status esk_relabeller_run(esk_relabeller *relabeller, const esk_scores *scores)
{
	const esk_labelling *labelling = relabeller->labelling;
	batch *b = relabeller->batch;
	relabeller->labelling->class_count = scores->count;
	for (size_t count = list_unsettled(relabeller), kept = 0; count; count = kept, kept = 0) {
		for (size_t i = 0; i < count; i++) {
			const size_t segment = relabeller->list[i];
			if (b->probe_count + labelling->slots[segment].count > ESK_PROBES) {
				eskel_status status = flush(b, relabeller, scores, &kept);
				if (status)
					return status;
			}
			push(b, labelling, segment);
		}
		eskel_status status = flush(b, relabeller, scores, &kept);
		if (status)
			return status;
	}
	return ESKEL_OK;
}
