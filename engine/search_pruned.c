/* The paper's search (section 5.3): compare at level 1, discard the farthest 90 %, compare the rest at level 2, and so
 * on, until few are left; compare those to full depth.
 *
 * Read literally, "until 10 or less remain" overshoots: of 116 shapes 12 and then 2 would be left. So a step never
 * keeps fewer than 10, nor fewer than are wanted. A shape that lacks a step's level is compared at the deepest level that
 * both have. Nothing is proven unless all were compared: a discarded shape may be nearer in the end. */
#include "search.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { least_kept = 10, kept_one_in = 10 };

typedef struct {
	esk_search *search;
	esk_ranked *all; /* those still in */
	size_t count;
} walk;

/* How many of count shapes a step keeps. */
static size_t step_keeps(const walk *w, size_t count)
{
	size_t keep = count / kept_one_in + (count % kept_one_in != 0);
	if (keep < least_kept)
		keep = least_kept;
	if (keep < w->search->answer.wanted)
		keep = w->search->answer.wanted;
	return keep < count ? keep : count;
}

/* D_1 of every slot. With one class a side there is nothing to match: these are the sums of esk_query_level, by column. */
static void first_distances(const esk_query *query, const esk_columns *columns, uint32_t count, float *distances)
{
	const float *units = query->size_counts ? columns->scales : NULL;
	memset(distances, 0, count * sizeof *distances);
	for (uint32_t c = 0; c < esk_numbers(query->signature); c++) {
		float lengths[ESK_CHUNK_SLOTS];
		const float *column = columns->first_level + c * columns->capacity;
		if (query->signature == ESKEL_SIGNATURE_PAPER) {
			esk_shape_lengths(column, count, 1, lengths);
			column = lengths;
		}
		esk_columns_add_differences(column, query->signature == ESKEL_SIGNATURE_PAPER ? units : NULL,
			query->rows[0][c], query->euclidean, count, distances);
	}
	for (uint32_t slot = 0; query->euclidean && slot < count; slot++)
		distances[slot] = sqrtf(distances[slot]);
}

/* The first step reads every shape. It holds at most twice what it keeps: whenever that is full, the nearer half stays,
 * and sets what a shape must not exceed to be listed at all. */
static eskel_status take_first_step(walk *w)
{
	const esk_search *search = w->search;
	const size_t keep = step_keeps(w, search->participant_count), room = 2 * keep;
	double farthest = (double)INFINITY;
	w->all = esk_memory_array(room, sizeof *w->all);
	if (!w->all)
		return ESKEL_NO_MEMORY;
	for (uint32_t c = 0; c < search->snapshot.directory->chunk_count; c++) {
		const esk_columns *columns = &search->snapshot.directory->chunks[c]->columns;
		const uint32_t slots = esk_snapshot_slots(&search->snapshot, c);
		float distances[ESK_CHUNK_SLOTS];
		first_distances(&search->query, columns, slots, distances);
		for (uint32_t slot = 0; slot < slots; slot++) {
			const uint32_t id = esk_snapshot_id(c, slot);
			const double distance = (double)distances[slot] +
						esk_query_size_term(&search->query, columns->log_volumes[slot]);
			if (distance > farthest || !esk_search_takes(search, c, slot))
				continue;
			if (w->count == room) {
				esk_ranked_select(w->all, w->count, keep);
				w->count = keep;
				farthest = esk_ranked_last(w->all, keep)->distance;
			}
			w->all[w->count++] = (esk_ranked){distance, esk_snapshot_key(&search->snapshot, id), id};
		}
	}
	esk_ranked_select(w->all, w->count, keep);
	w->count = keep;
	return ESKEL_OK;
}

static double step_distance(const esk_query *query, const esk_shape *other, uint32_t level)
{
	if (level > query->shape->level_count)
		level = query->shape->level_count;
	if (level > other->level_count)
		level = other->level_count;
	return esk_query_level(query, other, level) + esk_query_size_term(query, other->log_volume);
}

static void take_step(walk *w, uint32_t level)
{
	for (size_t n = 0; n < w->count; n++)
		w->all[n].distance =
			step_distance(&w->search->query, esk_snapshot_shape(&w->search->snapshot, w->all[n].id), level);
	const size_t keep = step_keeps(w, w->count);
	esk_ranked_select(w->all, w->count, keep);
	w->count = keep;
}

static void compare(walk *w)
{
	for (size_t n = 0; n < w->count; n++) {
		const uint32_t id = w->all[n].id;
		const esk_shape *shape = esk_snapshot_shape(&w->search->snapshot, id);
		esk_search_answer(w->search, id, esk_query_distance(&w->search->query, shape, NULL));
	}
	w->search->result->compared = w->count;
	w->search->result->proven = w->count == w->search->participant_count;
}

eskel_status esk_search_pruned(esk_search *search)
{
	walk w = {.search = search};
	eskel_status status = take_first_step(&w);
	if (status == ESKEL_OK) {
		if (w.count < search->participant_count)
			esk_search_end_step(search, w.count);
		for (uint32_t level = 2; step_keeps(&w, w.count) < w.count; level++) {
			take_step(&w, level);
			esk_search_end_step(search, w.count);
		}
		compare(&w);
	}
	free(w.all);
	return status;
}
