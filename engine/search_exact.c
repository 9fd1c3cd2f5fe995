/* The exact search: the answer of comparing with every shape, without doing so.
 *
 * It walks coarse to fine like the paper's, but a shape is discarded only when a lower bound of its distance (bound.h)
 * exceeds the distance of the last shape in the answer so far. To have an answer from the start, the shapes that look
 * nearest are compared first. Then three steps apply ever tighter bounds: means over all levels, halves of each
 * level, sorted numbers. What is left is matched level by level, nearest bound first, each level's distance taking the place
 * of its bound, until the shape is discarded or its distance known.
 *
 * Where bound and answer are equal a shape stays in: ties are decided by key. */
#include "search.h"

#include "bound.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>

/* The nearest by the tightest bound of the nearest by the loosest are compared first. More of either discard more, but
 * cost more; with these the first threshold is seldom far above the last. */
enum { spare_seeds = 8, scouts_per_seed = 16 };

typedef struct {
	double bound;
	uint32_t id;
} candidate;

typedef struct {
	esk_search *search;
	esk_bound bound;
	float *bounds;         /* by id, after the scan; infinite for shapes that are out or compared */
	candidate *candidates; /* those that the scan leaves */
	size_t count;
} walk;

static double threshold(const walk *w)
{
	return esk_nearest_threshold(&w->search->answer);
}

static double bound_by_halves(const walk *w, uint32_t id)
{
	const esk_chunk *chunk = w->search->snapshot.directory->chunks[id / ESK_CHUNK_SLOTS];
	return esk_bound_by_halves(&w->bound, &chunk->columns, id % ESK_CHUNK_SLOTS);
}

static double bound_by_sorting(const walk *w, uint32_t id, double enough, double *levels)
{
	const esk_chunk *chunk = w->search->snapshot.directory->chunks[id / ESK_CHUNK_SLOTS];
	const uint32_t slot = id % ESK_CHUNK_SLOTS;
	return esk_bound_by_sorting(&w->bound, &chunk->columns, slot, chunk->shapes[slot], enough, levels);
}

/* Bounds every shape, and takes those of least bound as scouts. */
static void scan(walk *w, esk_nearest *scouts)
{
	const esk_snapshot *snapshot = &w->search->snapshot;
	for (uint32_t chunk = 0; chunk < snapshot->directory->chunk_count; chunk++) {
		const uint32_t slots = esk_snapshot_slots(snapshot, chunk);
		float *bounds = w->bounds + (size_t)chunk * ESK_CHUNK_SLOTS;
		if (esk_search_takes_any(w->search, chunk))
			esk_bound_scan(&w->bound, &snapshot->directory->chunks[chunk]->columns, slots, bounds);
		for (uint32_t slot = 0; slot < ESK_CHUNK_SLOTS; slot++) {
			const uint32_t id = esk_snapshot_id(chunk, slot);
			if (!esk_search_takes(w->search, chunk, slot))
				bounds[slot] = INFINITY;
			else if ((double)bounds[slot] <= esk_nearest_threshold(scouts))
				esk_nearest_offer(
					scouts, (esk_ranked){(double)bounds[slot], esk_snapshot_key(snapshot, id), id});
		}
	}
}

static void choose_seeds(const walk *w, const esk_nearest *scouts, esk_nearest *seeds)
{
	for (size_t s = 0; s < scouts->count; s++) {
		double levels[ESKEL_LEVELS_MAX];
		esk_ranked seed = scouts->items[s];
		seed.distance = bound_by_sorting(w, seed.id, esk_nearest_threshold(seeds), levels);
		esk_nearest_offer(seeds, seed);
	}
}

static void compare_seeds(walk *w, const esk_nearest *seeds)
{
	esk_search *search = w->search;
	for (size_t s = 0; s < seeds->count; s++) {
		const uint32_t id = seeds->items[s].id;
		const esk_shape *shape = esk_snapshot_shape(&search->snapshot, id);
		esk_search_answer(search, id, esk_query_distance(&search->query, shape, NULL));
		w->bounds[id] = INFINITY;
	}
	search->result->compared = seeds->count;
}

/* Ends a step that has left count candidates. */
static void end_step(walk *w, size_t count)
{
	w->count = count;
	esk_search_end_step(w->search, count + w->search->result->compared);
}

static bool list_candidates(walk *w)
{
	const size_t ids = (size_t)w->search->snapshot.directory->chunk_count * ESK_CHUNK_SLOTS;
	size_t count = 0;
	for (size_t id = 0; id < ids; id++)
		count += (double)w->bounds[id] <= threshold(w);
	w->candidates = esk_memory_array(count, sizeof *w->candidates);
	if (!w->candidates)
		return false;
	end_step(w, count);
	for (size_t id = 0, n = 0; n < count; id++)
		if ((double)w->bounds[id] <= threshold(w))
			w->candidates[n++] = (candidate){(double)w->bounds[id], (uint32_t)id};
	return true;
}

/* The levels that count between the query and most shapes. */
static uint32_t first_level(const walk *w)
{
	return w->search->query.summed ? 1 : w->search->query.deepest;
}

/* Of summed levels the first few decide about most shapes. */
static void ask_first_sorted(const walk *w, uint32_t id)
{
	esk_search_ask_halves(w->search, id, first_level(w), w->search->query.deepest);
	esk_search_ask_shape(w->search, id, first_level(w), w->search->query.summed ? 6 : w->search->query.deepest);
}

static void discard_by_halves(walk *w)
{
	size_t kept = 0;
	for (size_t n = 0; n < w->count; n++) {
		if (n + ESK_SEARCH_AHEAD < w->count)
			esk_search_ask_halves(w->search, w->candidates[n + ESK_SEARCH_AHEAD].id, first_level(w),
				w->search->query.deepest);
		candidate c = w->candidates[n];
		c.bound = bound_by_halves(w, c.id);
		if (c.bound <= threshold(w))
			w->candidates[kept++] = c;
	}
	end_step(w, kept);
}

static void discard_by_sorting(walk *w)
{
	size_t kept = 0;
	double levels[ESKEL_LEVELS_MAX];
	for (size_t n = 0; n < w->count; n++) {
		if (n + 2 * ESK_SEARCH_AHEAD < w->count)
			esk_search_ask_place(w->search, w->candidates[n + 2 * ESK_SEARCH_AHEAD].id);
		if (n + ESK_SEARCH_AHEAD < w->count)
			ask_first_sorted(w, w->candidates[n + ESK_SEARCH_AHEAD].id);
		candidate c = w->candidates[n];
		c.bound = bound_by_sorting(w, c.id, threshold(w), levels);
		if (c.bound <= threshold(w))
			w->candidates[kept++] = c;
	}
	end_step(w, kept);
}

static void match_levels(walk *w, uint32_t id)
{
	const esk_query *query = &w->search->query;
	const esk_shape *shape = esk_snapshot_shape(&w->search->snapshot, id);
	const uint32_t depth = esk_query_depth(query, shape);
	double levels[ESKEL_LEVELS_MAX];
	bound_by_sorting(w, id, (double)INFINITY, levels);
	for (uint32_t k = query->summed ? 1 : depth; k <= depth; k++) {
		levels[k - 1] = esk_query_level(query, shape, k);
		if (k < depth && esk_bound_of_levels(query, shape, levels) > threshold(w))
			return;
	}
	esk_search_answer(w->search, id, esk_query_combine(query, shape, levels));
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

eskel_status esk_search_exact(esk_search *search)
{
	const size_t seed_count = search->answer.wanted + spare_seeds;
	eskel_status status = ESKEL_NO_MEMORY;
	esk_nearest scouts = {0}, seeds = {0};
	walk w = {.search = search};
	w.bounds = esk_memory_array(search->snapshot.directory->chunk_count, ESK_CHUNK_SLOTS * sizeof *w.bounds);
	if (!w.bounds || !esk_nearest_init(&scouts, scouts_per_seed * seed_count) ||
		!esk_nearest_init(&seeds, seed_count))
		goto cleanup;
	esk_bound_init(&w.bound, &search->query);
	scan(&w, &scouts);
	choose_seeds(&w, &scouts, &seeds);
	compare_seeds(&w, &seeds);
	if (!list_candidates(&w))
		goto cleanup;
	discard_by_halves(&w);
	discard_by_sorting(&w);
	match_candidates(&w);
	search->result->proven = true;
	status = ESKEL_OK;
cleanup:
	esk_nearest_clear(&scouts);
	esk_nearest_clear(&seeds);
	free(w.bounds);
	free(w.candidates);
	return status;
}
