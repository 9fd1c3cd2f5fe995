/* The exact search: the answer of comparing with every shape, without doing so.
 *
 * It walks coarse to fine like the paper's, but a shape is discarded only when a lower bound of its distance (bound.h)
 * exceeds the distance of the last shape in the answer so far. Three steps apply ever tighter bounds: halves over all levels,
 * halves of each level, sorted numbers. What is left is matched level by level, nearest bound first, each level's distance
 * taking the place of its bound, until the shape is discarded or its distance known.
 *
 * To have an answer from the start, the shapes that look nearest take all steps before the others do.
 *
 * Where bound and answer are equal a shape stays in: ties are decided by key. */
#include "search.h"

#include "below.h"
#include "bound.h"
#include "memory.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* So many by the loosest bound, and of these so many by the next, go first, and one more in so many of the library. More of
 * either lower the first threshold, but cost more; with these it is seldom far above the last. */
enum { least_scouts = 48, scouts_one_in = 1024, least_seeds = 24, seeds_one_in = 16384 };

typedef struct {
	double bound;
	double sorted; /* of which so much by sorted numbers */
	uint32_t id;
} candidate;

typedef struct {
	esk_search *search;
	esk_bound bound;
	float *bounds;         /* by id, after the scan; infinite for shapes that are out or compared */
	candidate *candidates; /* those still in */
	size_t count, capacity;
} walk;

static double threshold(const walk *w)
{
	return esk_nearest_threshold(&w->search->answer);
}

/* Slots of a chunk. */
typedef struct {
	uint32_t chunk, count;
	uint16_t slots[ESK_CHUNK_SLOTS];
} few;

static void choose_slots(const walk *w, uint32_t chunk, double most, few *chosen)
{
	const float *bounds = w->bounds + (size_t)chunk * ESK_CHUNK_SLOTS;
	const float limit = most < FLT_MAX ? nextafterf((float)most, INFINITY) : FLT_MAX;
	chosen->chunk = chunk;
	chosen->count = esk_below(bounds, ESK_CHUNK_SLOTS, limit, chosen->slots);
}

/* Those of least bound go into scouts; which of equal ones does not matter. */
static void offer_scouts(const walk *w, uint32_t chunk, esk_nearest *scouts)
{
	few chosen;
	choose_slots(w, chunk, esk_nearest_threshold(scouts), &chosen);
	for (uint32_t i = 0; i < chosen.count; i++) {
		const uint32_t id = esk_snapshot_id(chunk, chosen.slots[i]);
		esk_nearest_offer(scouts, (esk_ranked){.distance = (double)w->bounds[id], .key = id, .id = id});
	}
}

/* Bounds every shape, and takes those of least bound as scouts. */
static void scan(walk *w, esk_nearest *scouts)
{
	const esk_snapshot *snapshot = &w->search->snapshot;
	for (uint32_t chunk = 0; chunk < snapshot->directory->chunk_count; chunk++) {
		const uint32_t slots = esk_snapshot_slots(snapshot, chunk);
		float *bounds = w->bounds + (size_t)chunk * ESK_CHUNK_SLOTS;
		if (w->bound.over_levels)
			esk_search_ask_columns(w->search, chunk + 1, false);
		if (esk_search_takes_any(w->search, chunk))
			esk_bound_scan(&w->bound, &snapshot->directory->chunks[chunk]->columns, slots, bounds);
		esk_search_leave_out(w->search, chunk, bounds);
		offer_scouts(w, chunk, scouts);
	}
}

/* Ends a step that has left count candidates. */
static void end_step(const walk *w, size_t count)
{
	esk_search_end_step(w->search, count + w->search->result->compared);
}

/* ---- halves */

static double bound_by_halves(const walk *w, uint32_t id)
{
	float bound;
	esk_bound_by_halves(&w->bound, &esk_snapshot_chunk(&w->search->snapshot, id)->columns,
		(uint16_t[]){id % ESK_CHUNK_SLOTS}, 1, &bound);
	return (double)bound;
}

static void ask_rows(const walk *w, const few *chosen)
{
	const eskel_signature_kind kind = w->search->query.signature;
	const esk_columns *columns = &w->search->snapshot.directory->chunks[chosen->chunk]->columns;
	for (uint32_t i = 0; w->bound.over_levels && i < chosen->count; i++) {
		const uint32_t slot = chosen->slots[i];
		esk_search_ask_halves(w->search, esk_snapshot_id(chosen->chunk, slot), 1, ESK_SUMMED_LEVELS);
		__builtin_prefetch(&columns->slacks[kind][slot]);
		__builtin_prefetch(&columns->level_counts[slot]);
		__builtin_prefetch(&columns->log_volumes[slot]);
	}
}

/* Adds to the candidates those that stay in; false when memory ran out. What the scan has looked at, it does
 * not look at again. */
static bool discard_few(walk *w, const few *chosen)
{
	float bounds[ESK_CHUNK_SLOTS];
	esk_chunk *chunk = w->search->snapshot.directory->chunks[chosen->chunk];
	void *candidates = w->candidates;
	if (!esk_memory_reserve(&candidates, &w->capacity, w->count + chosen->count, sizeof *w->candidates))
		return false;
	w->candidates = candidates;
	if (w->bound.over_levels)
		esk_bound_by_halves(&w->bound, &chunk->columns, chosen->slots, chosen->count, bounds);
	for (uint32_t i = 0; i < chosen->count; i++) {
		const uint32_t id = esk_snapshot_id(chosen->chunk, chosen->slots[i]);
		const candidate c = {(double)(w->bound.over_levels ? bounds[i] : w->bounds[id]), 0, id};
		if (c.bound <= threshold(w))
			w->candidates[w->count++] = c;
	}
	return true;
}

/* What the scan leaves is listed and discarded by halves chunk by chunk, so that the rows of one are on their way while
 * those of the one before are looked at. */
static bool discard_by_halves(walk *w)
{
	const uint32_t chunks = w->search->snapshot.directory->chunk_count;
	size_t scanned = 0;
	few both[2];
	w->count = 0;
	for (uint32_t c = 0; c <= chunks; c++) {
		if (c < chunks) {
			choose_slots(w, c, threshold(w), &both[c % 2]);
			ask_rows(w, &both[c % 2]);
			scanned += both[c % 2].count;
		}
		if (c > 0 && !discard_few(w, &both[(c - 1) % 2]))
			return false;
	}
	end_step(w, scanned);
	end_step(w, w->count);
	return true;
}

/* ---- sorted numbers */

enum { LEVELS_AT_ONCE = 4 };

/* Those whose bound by the sorted numbers of these levels and the halves of the deeper ones allows it stay in. */
static void discard_by_levels(walk *w, uint32_t first, uint32_t last)
{
	size_t kept = 0;
	for (size_t n = 0; n < w->count; n++) {
		if (n + 2 * ESK_SEARCH_AHEAD < w->count)
			esk_search_ask_place(w->search, w->candidates[n + 2 * ESK_SEARCH_AHEAD].id);
		if (n + ESK_SEARCH_AHEAD < w->count) {
			const uint32_t ahead = w->candidates[n + ESK_SEARCH_AHEAD].id;
			esk_search_ask_numbers(w->search, ahead, w->search->query.summed ? first : last, last);
			if (last < ESK_SUMMED_LEVELS)
				esk_search_ask_halves(w->search, ahead, last + 1, ESK_SUMMED_LEVELS);
		}
		candidate c = w->candidates[n];
		const esk_chunk *chunk = esk_snapshot_chunk(&w->search->snapshot, c.id);
		const uint32_t slot = c.id % ESK_CHUNK_SLOTS;
		c.bound = esk_bound_by_sorting(
			&w->bound, &chunk->columns, slot, chunk->shapes[slot], first, last, &c.sorted);
		if (c.bound <= threshold(w))
			w->candidates[kept++] = c;
	}
	w->count = kept;
}

/* Breadth first, so that what each pass reads is known before. */
static void discard_by_sorting(walk *w)
{
	const esk_query *query = &w->search->query;
	const uint32_t depth = query->deepest < query->shape->level_count ? query->deepest : query->shape->level_count;
	if (!query->summed)
		discard_by_levels(w, 1, depth);
	for (uint32_t first = 1; query->summed && first <= depth; first += LEVELS_AT_ONCE)
		discard_by_levels(w, first, first + LEVELS_AT_ONCE - 1 < depth ? first + LEVELS_AT_ONCE - 1 : depth);
}

/* ---- matching */

static void match_levels(walk *w, uint32_t id)
{
	const esk_query *query = &w->search->query;
	const esk_shape *shape = esk_snapshot_shape(&w->search->snapshot, id);
	const uint32_t depth = esk_query_depth(query, shape);
	double levels[ESKEL_LEVELS_MAX];
	esk_bound_levels(&w->bound, shape, levels);
	for (uint32_t k = query->summed ? 1 : depth; k <= depth; k++) {
		levels[k - 1] = esk_query_level(query, shape, k);
		if (k < depth && esk_bound_of_levels(query, shape, levels) > threshold(w))
			return;
	}
	esk_search_answer(w->search, id, esk_query_combine(query, shape, levels), levels);
	w->search->result->compared++;
}

static int by_bound(const void *a, const void *b)
{
	const candidate *x = a, *y = b;
	if (x->bound != y->bound)
		return x->bound < y->bound ? -1 : 1;
	return x->id < y->id ? -1 : x->id > y->id;
}

static void match_candidates(walk *w)
{
	if (w->count > 1)
		qsort(w->candidates, w->count, sizeof *w->candidates, by_bound);
	for (size_t n = 0; n < w->count && w->candidates[n].bound <= threshold(w); n++)
		match_levels(w, w->candidates[n].id);
}

/* ---- the shapes that look nearest */

static bool match_seeds(walk *w, const esk_nearest *scouts)
{
	esk_nearest seeds = {0};
	if (!esk_nearest_init(
		    &seeds, w->search->answer.wanted + least_seeds + w->search->participant_count / seeds_one_in))
		return false;
	for (size_t s = 0; s < scouts->count; s++) {
		esk_ranked scout = scouts->items[s];
		scout.distance = bound_by_halves(w, scout.id);
		esk_nearest_offer(&seeds, scout);
	}
	w->candidates = esk_memory_array(seeds.count, sizeof *w->candidates);
	w->capacity = seeds.count;
	for (size_t s = 0; w->candidates && s < seeds.count; s++) {
		w->candidates[w->count++] = (candidate){seeds.items[s].distance, 0, seeds.items[s].id};
		w->bounds[seeds.items[s].id] = INFINITY;
	}
	esk_nearest_clear(&seeds);
	if (!w->candidates)
		return false;
	discard_by_sorting(w);
	match_candidates(w);
	return true;
}

eskel_status esk_search_exact(esk_search *search)
{
	eskel_status status = ESKEL_NO_MEMORY;
	esk_nearest scouts = {0};
	walk w = {.search = search};
	w.bounds = esk_memory_array(search->snapshot.directory->chunk_count, ESK_CHUNK_SLOTS * sizeof *w.bounds);
	if (!w.bounds || !esk_nearest_init(&scouts,
				 2 * search->answer.wanted + least_scouts + search->participant_count / scouts_one_in))
		goto cleanup;
	esk_bound_init(&w.bound, &search->query);
	scan(&w, &scouts);
	if (!match_seeds(&w, &scouts) || !discard_by_halves(&w))
		goto cleanup;
	discard_by_sorting(&w);
	end_step(&w, w.count);
	match_candidates(&w);
	search->result->proven = true;
	status = ESKEL_OK;
cleanup:
	esk_nearest_clear(&scouts);
	free(w.bounds);
	free(w.candidates);
	return status;
}
