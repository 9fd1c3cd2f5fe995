/* The exact search: the answer of comparing with every shape, without doing so.
 *
 * It walks coarse to fine like the paper's, but a shape is discarded only when a lower bound of its distance (bound.h)
 * exceeds the distance of the last shape in the answer so far. Three steps apply ever tighter bounds; after each of the
 * first two, the most promising shapes are compared, so that the next step has an answer to discard against.
 * What is left is matched level by level, nearest bound first, each level's distance taking the place of its bound, until
 * the shape is discarded or its distance known.
 *
 * Where bound and answer are equal a shape stays in: ties are decided by key. */
#include "search.h"

#include "bound.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>

/* Compared beyond those wanted after a step, in the hope that the answer is among them. */
enum { spare_seeds = 8 };

typedef struct {
	double bound; /* infinite once compared */
	uint32_t id;
} candidate;

typedef struct {
	esk_search *search;
	esk_bound bound;
	candidate *candidates;
	size_t count;
} walk;

static esk_shape shape_of(const walk *w, const candidate *c)
{
	return esk_snapshot_shape(&w->search->snapshot, c->id);
}

static void scan(walk *w)
{
	const esk_search *search = w->search;
	for (uint32_t chunk = 0; chunk < search->snapshot.directory->chunk_count; chunk++) {
		const uint32_t slots = esk_snapshot_slots(&search->snapshot, chunk);
		float bounds[ESK_CHUNK_SLOTS];
		esk_bound_scan(&w->bound, search->snapshot.directory->chunks[chunk]->columns, slots, bounds);
		for (uint32_t slot = 0; slot < slots; slot++)
			if (esk_search_takes(search, chunk, slot))
				w->candidates[w->count++] =
					(candidate){(double)bounds[slot], esk_snapshot_id(chunk, slot)};
	}
}

/* Compares the candidates of least bound, as many as are wanted and some to spare. */
static bool compare_seeds(walk *w)
{
	esk_search *search = w->search;
	esk_nearest seeds;
	if (!esk_nearest_init(&seeds, search->answer.wanted + spare_seeds))
		return false;
	for (size_t n = 0; n < w->count; n++)
		if (w->candidates[n].bound <= esk_nearest_threshold(&seeds))
			esk_nearest_offer(
				&seeds, (esk_ranked){w->candidates[n].bound,
						esk_snapshot_key(&search->snapshot, w->candidates[n].id), (uint32_t)n});
	for (size_t s = 0; s < seeds.count; s++) {
		candidate *seed = &w->candidates[seeds.items[s].id];
		esk_search_answer(search, seed->id, esk_query_distance(&search->query, shape_of(w, seed), NULL));
		seed->bound = (double)INFINITY;
		search->result->compared++;
	}
	esk_nearest_clear(&seeds);
	return true;
}

static void discard(walk *w)
{
	const double threshold = esk_nearest_threshold(&w->search->answer);
	size_t kept = 0;
	for (size_t n = 0; n < w->count; n++)
		if (w->candidates[n].bound <= threshold)
			w->candidates[kept++] = w->candidates[n];
	w->count = kept;
	esk_search_end_step(w->search, kept + w->search->result->compared);
}

/* Levels that are matched replace their bounds one by one. */
static void match_levels(walk *w, const candidate *c)
{
	const esk_query *query = &w->search->query;
	const esk_shape other = shape_of(w, c);
	const uint32_t depth = esk_query_depth(query, other);
	double levels[ESKEL_LEVELS_MAX];
	esk_bound_by_sorting(&w->bound, other, levels);
	for (uint32_t k = query->summed ? 1 : depth; k <= depth; k++) {
		levels[k - 1] = esk_query_level(query, other, k);
		if (k < depth && esk_bound_of_levels(query, other, levels) > esk_nearest_threshold(&w->search->answer))
			return;
	}
	esk_search_answer(w->search, c->id, esk_query_combine(query, other, levels));
	w->search->result->compared++;
}

static int by_bound(const void *a, const void *b)
{
	const candidate *x = a, *y = b;
	return x->bound < y->bound ? -1 : x->bound > y->bound;
}

static eskel_status run(walk *w)
{
	scan(w);
	if (!compare_seeds(w))
		return ESKEL_NO_MEMORY;
	discard(w);
	for (size_t n = 0; n < w->count; n++)
		w->candidates[n].bound = esk_bound_by_means(&w->bound, shape_of(w, &w->candidates[n]));
	if (!compare_seeds(w))
		return ESKEL_NO_MEMORY;
	discard(w);
	for (size_t n = 0; n < w->count; n++) {
		double levels[ESKEL_LEVELS_MAX];
		w->candidates[n].bound = esk_bound_by_sorting(&w->bound, shape_of(w, &w->candidates[n]), levels);
	}
	discard(w);
	if (w->count > 1)
		qsort(w->candidates, w->count, sizeof *w->candidates, by_bound);
	for (size_t n = 0; n < w->count; n++) {
		if (w->candidates[n].bound > esk_nearest_threshold(&w->search->answer))
			break;
		match_levels(w, &w->candidates[n]);
	}
	w->search->result->proven = true;
	return ESKEL_OK;
}

eskel_status esk_search_exact(esk_search *search)
{
	walk w = {.search = search};
	w.candidates = esk_memory_array(search->participant_count, sizeof *w.candidates);
	if (!w.candidates)
		return ESKEL_NO_MEMORY;
	esk_bound_init(&w.bound, &search->query);
	eskel_status status = run(&w);
	free(w.candidates);
	return status;
}
