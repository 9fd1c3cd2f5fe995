/* Both ends of every piece are probed (probe.h). Where the piece's class wins at both ends it wins in between, because a
 * class wins an interval; most segments turn out right. The others are cut anew: between two places with different
 * winners the border is put where the one's score overtakes the other's, and they are probed again. If a third class
 * wins around that border, the probe finds it. Every class that is found has its place in the segment, so after at most
 * one probe a class all borders are right. */
#include "cutter.h"

#include "memory.h"
#include "probe.h"

#include <stdlib.h>

/* Segments whose pieces are to be probed together. */
typedef struct esk_batch {
	esk_probes probes;
	size_t probe_count, segment_count;
	uint32_t owner[ESK_PROBE_ROOM]; /* of each probe: its segment's place in the arrays below */
	size_t segments[ESK_PROBES];
	size_t first[ESK_PROBES]; /* probe of the segment */
	double slack[ESK_PROBES];
} batch;

eskel_status esk_cutter_init(esk_cutter *cutter, esk_labelling *labelling, int64_t *settled)
{
	batch *b = esk_memory_zeroed_array(1, sizeof *b);
	if (!b)
		return ESKEL_NO_MEMORY;
	*cutter = (esk_cutter){.labelling = labelling, .settled = settled, .batch = b};
	return ESKEL_OK;
}

void esk_cutter_clear(esk_cutter *cutter)
{
	free(cutter->batch);
	*cutter = (esk_cutter){0};
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

/* Probes the batch and empties it. Segments that were wrong are kept in segments[*kept], to be probed again. */
static eskel_status flush(esk_cutter *cutter, const esk_scores *scores, const esk_scores *near, int64_t clock,
	size_t *segments, size_t *kept)
{
	batch *b = cutter->batch;
	uint32_t wrong[ESK_PROBES];
	size_t wrong_count = 0;
	esk_probes_run(&b->probes, b->probe_count, near);
	for (size_t i = 0; i < b->probe_count; i++) {
		double *slack = &b->slack[b->owner[i]];
		*slack = b->probes.slack[i] < *slack ? b->probes.slack[i] : *slack;
	}
	for (size_t n = 0; n < b->segment_count; n++) {
		cutter->settled[b->segments[n]] = clock + (int64_t)b->slack[n];
		wrong[wrong_count] = (uint32_t)n;
		wrong_count += b->slack[n] < 0;
	}
	for (size_t n = 0; n < wrong_count; n++) {
		const size_t segment = b->segments[wrong[n]], first = b->first[wrong[n]];
		eskel_status status = recut(cutter->labelling, segment, scores, &b->probes, first,
			first + cutter->labelling->slots[segment].count);
		if (status)
			return status;
		segments[(*kept)++] = segment;
	}
	b->probe_count = 0;
	b->segment_count = 0;
	return ESKEL_OK;
}

eskel_status esk_cutter_run(esk_cutter *cutter, const esk_scores *scores, const esk_scores *near, int64_t clock,
	size_t *segments, size_t count)
{
	const esk_slot *slots = cutter->labelling->slots;
	for (size_t kept = 0; count; count = kept, kept = 0) {
		for (size_t i = 0; i < count; i++) {
			if (cutter->batch->probe_count + slots[segments[i]].count > ESK_PROBES) {
				eskel_status status = flush(cutter, scores, near, clock, segments, &kept);
				if (status)
					return status;
			}
			push(cutter->batch, cutter->labelling, segments[i]);
		}
		eskel_status status = flush(cutter, scores, near, clock, segments, &kept);
		if (status)
			return status;
	}
	return ESKEL_OK;
}
