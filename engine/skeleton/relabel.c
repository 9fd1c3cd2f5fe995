/* A pass sums up every class anew over packs of segments (envelope.h); between passes no labels are kept, only where which
 * classes can win. Scores move little from pass to pass, so
 *
 *	1. a block of neighbouring packs finds its candidates in every pass: the classes that win somewhere in its box, as
 *	   far as one comparison with the winner at its centre tells. No other class matters there.
 *	2. each pack has candidates of its own among them, found in its smaller box, and some more that come within a margin
 *	   of winning. As long as scores have not moved, relative to each other, by the least lead over a class that is left
 *	   out, no such class can win there. The block's clock adds up how far its candidates' scores have moved in its box;
 *	   a new candidate makes all packs of the block look again.
 *	3. a pack with one candidate belongs to it as a whole, and takes no more time until it is due. The others are divided.
 *
 * Threads go over shares of the blocks. Sums are exact, so it does not matter which thread adds what. */
#include "relabel.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	BLOCK_PACKS = 32,  /* 16 to 32 are alike */
	SHARE_BLOCKS = 16, /* at least: 4096 segments take some 40 us, several times what sharing costs */
	NO_CLASS = ESKEL_LEVELS_MAX,
};

/* The margin in movements of the last pass: with less, packs look again more often, with more they have more candidates;
 * 1 to 2 are alike. */
static const double margin = 1.5;

typedef struct esk_outlook {
	esk_box box;
	esk_sums sums;  /* of all voxels */
	int64_t due;    /* when the block's clock is there, candidates are to be found again */
	uint32_t alone; /* the class that all voxels are counted for in the share's alone, or NO_CLASS */
} outlook;

typedef struct esk_block {
	esk_box box;
	int64_t clock;
	int64_t due;         /* the least of its packs */
	uint64_t candidates; /* of the last pass, a bit a class */
} block;

typedef struct esk_share {
	size_t first, end;                /* blocks */
	esk_sums alone[ESKEL_LEVELS_MAX]; /* of the packs with one candidate, by class */
	esk_tally tally;                  /* of the other packs in the last pass, by rank */
} share;

static size_t least_of(size_t a, size_t b)
{
	return a < b ? a : b;
}

static size_t block_end(const esk_relabeller *relabeller, size_t b)
{
	return least_of((b + 1) * BLOCK_PACKS, relabeller->pack_count);
}

static void add_sums(esk_sums *sums, const esk_sums *more)
{
	sums->weight += more->weight;
	for (int r = 0; r < 3; r++)
		sums->first[r] += more->first[r];
}

static void remove_sums(esk_sums *sums, const esk_sums *less)
{
	sums->weight -= less->weight;
	for (int r = 0; r < 3; r++)
		sums->first[r] -= less->first[r];
}

static void set_pack(esk_relabeller *relabeller, size_t p)
{
	const esk_segment *segments = relabeller->segments + p * ESK_PACK;
	const size_t count = least_of(ESK_PACK, relabeller->segment_count - p * ESK_PACK);
	outlook *o = &relabeller->outlooks[p];
	block *b = &relabeller->blocks[p / BLOCK_PACKS];
	relabeller->packs[p] = esk_pack_of(segments, count);
	*o = (outlook){.box = esk_pack_box(&relabeller->packs[p]), .alone = NO_CLASS};
	for (size_t i = 0; i < count; i++)
		esk_sums_add(&o->sums, &segments[i]);
	b->box = p % BLOCK_PACKS ? esk_box_join(&b->box, &o->box) : o->box;
}

/* Whether a tally may pass 2^53: sum w |u_r| <= sum w max |u_r|. */
static bool is_heavy(const esk_relabeller *relabeller)
{
	double weight = 0, farthest = 1;
	for (size_t p = 0; p < relabeller->pack_count; p++)
		weight += (double)relabeller->outlooks[p].sums.weight;
	for (size_t b = 0; b < relabeller->block_count; b++)
		for (int r = 0; r < 3; r++) {
			const esk_box *box = &relabeller->blocks[b].box;
			farthest = fmax(farthest, fabs(box->centre[r]) + box->half[r]);
		}
	return weight * farthest >= 0x1p52;
}

/* Two shares a thread, as some packs take longer than others. */
static bool share_blocks(esk_relabeller *relabeller)
{
	const size_t blocks = relabeller->block_count, threads = esk_team_size(relabeller->team);
	const size_t most = blocks / SHARE_BLOCKS, wanted = threads > 1 ? 2 * threads : 1;
	const size_t shares = most < 2 ? 1 : least_of(most, wanted);
	relabeller->shares = esk_memory_array(shares, sizeof *relabeller->shares);
	for (size_t i = 0; i < shares && relabeller->shares; i++) {
		share *s = &relabeller->shares[i];
		s->first = blocks * i / shares;
		s->end = blocks * (i + 1) / shares;
		memset(s->alone, 0, sizeof s->alone);
	}
	relabeller->share_count = shares;
	return relabeller->shares;
}

eskel_status esk_relabeller_init(
	esk_relabeller *relabeller, const esk_segment *segments, size_t segment_count, esk_team *team)
{
	const size_t packs = (segment_count + ESK_PACK - 1) / ESK_PACK,
		     blocks = (packs + BLOCK_PACKS - 1) / BLOCK_PACKS;
	*relabeller = (esk_relabeller){
		.segments = segments,
		.segment_count = segment_count,
		.pack_count = packs,
		.block_count = blocks,
		.envelope = esk_memory_array(1, sizeof *relabeller->envelope),
		.packs = esk_memory_array(packs, sizeof *relabeller->packs),
		.outlooks = esk_memory_array(packs, sizeof *relabeller->outlooks),
		.candidates = esk_memory_array(packs, sizeof *relabeller->candidates),
		.blocks = esk_memory_zeroed_array(blocks, sizeof *relabeller->blocks),
		.team = team,
	};
	if (!relabeller->envelope || !relabeller->packs || !relabeller->outlooks || !relabeller->candidates ||
		!relabeller->blocks || !share_blocks(relabeller)) {
		esk_relabeller_clear(relabeller);
		return ESKEL_NO_MEMORY;
	}
	relabeller->envelope->count = 0;
	for (size_t p = 0; p < packs; p++)
		set_pack(relabeller, p);
	relabeller->heavy = is_heavy(relabeller);
	return ESKEL_OK;
}

void esk_relabeller_clear(esk_relabeller *relabeller)
{
	free(relabeller->envelope);
	free(relabeller->packs);
	free(relabeller->outlooks);
	free(relabeller->candidates);
	free(relabeller->blocks);
	free(relabeller->shares);
	*relabeller = (esk_relabeller){0};
}

void esk_relabeller_restart(esk_relabeller *relabeller)
{
	relabeller->before.count = 0;
}

/* ---- candidates */

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
			at_centre += slope * b->box.centre[r];
			around += fabs(slope) * b->box.half[r];
		}
		const double movement = fabs(at_centre) + around;
		second = movement > greatest ? greatest : movement > second ? movement : second;
		greatest = movement > greatest ? movement : greatest;
	}
	return (int64_t)greatest + (int64_t)second;
}

/* Finds the candidates of a pack among these ranks: those of either half of its box, as long boxes have many. */
static void look_again(esk_relabeller *relabeller, share *mine, size_t p, uint64_t ranks, int64_t clock, double within)
{
	const esk_envelope *e = relabeller->envelope;
	outlook *o = &relabeller->outlooks[p];
	double least_lead = 0x1p60;
	esk_box half = o->box;
	half.half[0] /= 2;
	half.centre[0] -= half.half[0];
	uint64_t found = esk_envelope_candidates(e, &half, within, &least_lead);
	half.centre[0] += 2 * half.half[0];
	found = ranks & (found | esk_envelope_candidates(e, &half, within, &least_lead));
	relabeller->candidates[p] = found;
	o->due = clock + (int64_t)least_lead;
	if (o->alone != NO_CLASS)
		remove_sums(&mine->alone[o->alone], &o->sums);
	o->alone = found & (found - 1) ? NO_CLASS : e->class_index[__builtin_ctzll(found)];
	if (o->alone != NO_CLASS)
		add_sums(&mine->alone[o->alone], &o->sums);
}

static uint64_t classes_of(const esk_envelope *e, uint64_t ranks)
{
	uint64_t classes = 0;
	for (; ranks; ranks &= ranks - 1)
		classes |= (uint64_t)1 << e->class_index[__builtin_ctzll(ranks)];
	return classes;
}

/* Brings the candidates of the packs of a block up to date. */
static void update_block(
	esk_relabeller *relabeller, share *mine, size_t index, const esk_scores *scores, bool same_ranks)
{
	block *b = &relabeller->blocks[index];
	double ignored = INFINITY;
	const uint64_t ranks = esk_envelope_candidates(relabeller->envelope, &b->box, 0, &ignored);
	const uint64_t candidates = classes_of(relabeller->envelope, ranks);
	const bool all =
		relabeller->before.count != scores->count || (candidates & ~b->candidates) || b->clock > INT64_MAX / 4;
	for (size_t p = index * BLOCK_PACKS; p < block_end(relabeller, index) && !all && !same_ranks; p++)
		relabeller->candidates[p] = esk_envelope_follow(relabeller->envelope, relabeller->candidates[p]);
	const int64_t moved = relabeller->before.count ? movement_in(b, &relabeller->before, scores) : 0;
	b->clock = all ? 0 : b->clock + moved;
	b->candidates = candidates;
	if (!all && b->due > b->clock)
		return;
	b->due = INT64_MAX;
	for (size_t p = index * BLOCK_PACKS; p < block_end(relabeller, index); p++) {
		outlook *o = &relabeller->outlooks[p];
		if (all || o->due <= b->clock)
			look_again(relabeller, mine, p, ranks, b->clock, margin * (double)moved);
		b->due = o->due < b->due ? o->due : b->due;
	}
}

/* ---- labels */

/* The parts that the winners have of count segments, at most a pack. Returns how many. */
enum { MOST_PARTS = ESK_PACK * ESKEL_LEVELS_MAX };

static size_t divide(const esk_envelope *e, const esk_segment *segments, size_t count, esk_part parts[MOST_PARTS])
{
	esk_stretch stretches[ESKEL_LEVELS_MAX];
	const esk_pack pack = esk_pack_of(segments, count);
	const esk_box box = esk_pack_box(&pack);
	double ignored = INFINITY;
	const uint64_t candidates = esk_envelope_candidates(e, &box, 0, &ignored);
	esk_envelope_divide(e, &pack, candidates, stretches);
	size_t found = 0;
	for (size_t i = 0; i < count; i++) {
		const esk_stretch *s = stretches;
		for (uint64_t rest = candidates; rest; rest &= rest - 1, s++) {
			if (s->end[i] <= s->first[i])
				continue;
			esk_part *part = &parts[found++];
			*part = (esk_part){segments[i], e->class_index[__builtin_ctzll(rest)]};
			part->segment.x_last = part->segment.x_first + 2 * ((int32_t)s->end[i] - 1);
			part->segment.x_first += 2 * (int32_t)s->first[i];
		}
	}
	return found;
}

eskel_status esk_relabeller_label(const esk_relabeller *relabeller, esk_labelling *labelling)
{
	esk_part parts[MOST_PARTS];
	labelling->count = 0;
	for (size_t i = 0; i < relabeller->segment_count; i += ESK_PACK) {
		const size_t count = least_of(ESK_PACK, relabeller->segment_count - i);
		const size_t found = divide(relabeller->envelope, relabeller->segments + i, count, parts);
		if (!esk_labelling_add(labelling, parts, found))
			return ESKEL_NO_MEMORY;
	}
	return ESKEL_OK;
}

/* ---- passes */

/* The sums of all classes from the parts of all segments: slower, and right for any weights. */
static void sum_parts(const esk_relabeller *relabeller, esk_sums *sums)
{
	esk_part parts[MOST_PARTS];
	for (size_t i = 0; i < relabeller->segment_count; i += ESK_PACK) {
		const size_t count = least_of(ESK_PACK, relabeller->segment_count - i);
		const size_t found = divide(relabeller->envelope, relabeller->segments + i, count, parts);
		for (size_t n = 0; n < found; n++)
			esk_sums_add(&sums[parts[n].class_index], &parts[n].segment);
	}
}

static int64_t total(const double lanes[ESK_PACK])
{
	double sum = 0;
	for (int i = 0; i < ESK_PACK; i++)
		sum += lanes[i];
	return (int64_t)sum;
}

typedef struct {
	esk_relabeller *relabeller;
	const esk_scores *scores;
	bool same_ranks;
} pass;

static void run_share(void *context, size_t index)
{
	const pass *p = context;
	esk_relabeller *relabeller = p->relabeller;
	share *mine = &relabeller->shares[index];
	memset(mine->tally.weight, 0, p->scores->count * sizeof *mine->tally.weight);
	memset(mine->tally.first, 0, p->scores->count * sizeof *mine->tally.first);
	for (size_t b = mine->first; b < mine->end; b++) {
		const size_t first = b * BLOCK_PACKS;
		update_block(relabeller, mine, b, p->scores, p->same_ranks);
		esk_envelope_tally(relabeller->envelope, relabeller->packs + first, relabeller->candidates + first,
			block_end(relabeller, b) - first, &mine->tally);
	}
}

static void add_share(const esk_envelope *e, const share *mine, esk_sums *sums)
{
	for (uint32_t i = 0; i < e->count; i++) {
		esk_sums *s = &sums[e->class_index[i]];
		add_sums(s, &mine->alone[e->class_index[i]]);
		s->weight += (uint64_t)total(mine->tally.weight[i]);
		for (int r = 0; r < 3; r++)
			s->first[r] += total(mine->tally.first[i][r]);
	}
}

void esk_relabeller_run(esk_relabeller *relabeller, const esk_scores *scores, esk_sums sums[ESKEL_LEVELS_MAX])
{
	const bool same_ranks = esk_envelope_set(relabeller->envelope, scores);
	memset(sums, 0, scores->count * sizeof *sums);
	if (relabeller->heavy) {
		sum_parts(relabeller, sums);
	} else {
		pass all = {relabeller, scores, same_ranks};
		esk_team_run(relabeller->team, relabeller->share_count, run_share, &all);
		for (size_t i = 0; i < relabeller->share_count; i++)
			add_share(relabeller->envelope, &relabeller->shares[i], sums);
	}
	relabeller->before = *scores;
}
