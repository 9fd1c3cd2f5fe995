/* The paper's search (section 5.3): compare at level 1, discard the farthest 90 %, compare the rest at level 2, and so
 * on, until few are left; compare those to full depth.
 *
 * Read literally, "until 10 or less remain" overshoots: of 116 shapes 12 and then 2 would be left. So a step never
 * keeps fewer than 10, nor fewer than are wanted. A shape that lacks a step's level is compared at the deepest level that
 * both have. Nothing is proven unless all were compared: a discarded shape may be nearer in the end. */
#include "search.h"

#include "bound.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { least_kept = 10, kept_one_in = 10 };

typedef struct {
	esk_search *search;
	esk_bound bound;
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

/* A distance's bits, all but the last 15: they order as distances do, which are not negative. */
enum { bins = 1 << 16, bin_shift = 15 };

static uint32_t bin(float distance)
{
	uint32_t bits;
	memcpy(&bits, &distance, sizeof bits);
	return bits >> bin_shift;
}

/* All D_1 with the size term, rounded to float, and how many of those that take part are in each bin. */
static void scan(const walk *w, float *distances, uint32_t *counts)
{
	const esk_search *search = w->search;
	for (uint32_t c = 0; c < search->snapshot.directory->chunk_count; c++, distances += ESK_CHUNK_SLOTS) {
		const esk_columns *columns = &search->snapshot.directory->chunks[c]->columns;
		const uint32_t slots = esk_snapshot_slots(&search->snapshot, c);
		if (!esk_search_takes_any(search, c))
			continue;
		first_distances(&search->query, columns, slots, distances);
		for (uint32_t slot = 0; slot < slots; slot++)
			distances[slot] = (float)((double)distances[slot] +
						  esk_query_size_term(&search->query, columns->log_volumes[slot]));
		for (uint32_t slot = 0; slot < slots; slot++)
			counts[bin(distances[slot])] += esk_search_takes(search, c, slot);
	}
}

static double step_distance(const walk *w, uint32_t id, uint32_t level);

/* Lists those in bins before last, and in *last_count items behind them those in the last bin. */
static void list(walk *w, const float *distances, uint32_t last, size_t room)
{
	const esk_snapshot *snapshot = &w->search->snapshot;
	size_t end = room;
	for (uint32_t c = 0; c < snapshot->directory->chunk_count; c++, distances += ESK_CHUNK_SLOTS) {
		const uint32_t slots = esk_search_takes_any(w->search, c) ? esk_snapshot_slots(snapshot, c) : 0;
		for (uint32_t slot = 0; slot < slots; slot++) {
			const uint32_t its = bin(distances[slot]), id = esk_snapshot_id(c, slot);
			if (its > last || !esk_search_takes(w->search, c, slot))
				continue;
			esk_ranked *item = its < last ? &w->all[w->count++] : &w->all[--end];
			*item = (esk_ranked){(double)distances[slot], esk_snapshot_key(snapshot, id), id};
		}
	}
}

/* The first step reads every shape. Which of them stay needs no sorting: counting how many distances fall in each of many
 * bins tells in which bin the last to stay is, and only those in that bin are told apart. */
static eskel_status take_first_step(walk *w)
{
	const size_t keep = step_keeps(w, w->search->participant_count);
	const size_t ids = (size_t)w->search->snapshot.directory->chunk_count * ESK_CHUNK_SLOTS;
	float *distances = esk_memory_array(ids, sizeof *distances);
	uint32_t *counts = esk_memory_zeroed_array(bins, sizeof *counts), last = 0;
	size_t room = 0;
	eskel_status status = ESKEL_NO_MEMORY;
	if (!distances || !counts)
		goto cleanup;
	scan(w, distances, counts);
	while ((room += counts[last]) < keep)
		last++;
	w->all = esk_memory_array(room, sizeof *w->all);
	if (!w->all)
		goto cleanup;
	list(w, distances, last, room);
	for (size_t n = w->count; n < room; n++)
		w->all[n].distance = step_distance(w, w->all[n].id, 1);
	esk_ranked_select(w->all + w->count, room - w->count, keep - w->count);
	w->count = keep;
	status = ESKEL_OK;
cleanup:
	free(distances);
	free(counts);
	return status;
}

static uint32_t step_level(const esk_query *query, uint32_t their_levels, uint32_t level)
{
	if (level > query->shape->level_count)
		level = query->shape->level_count;
	return level < their_levels ? level : their_levels;
}

static double step_distance(const walk *w, uint32_t id, uint32_t level)
{
	const esk_query *query = &w->search->query;
	const esk_shape *other = esk_snapshot_shape(&w->search->snapshot, id);
	return esk_query_level(query, other, step_level(query, other->level_count, level)) +
	       esk_query_size_term(query, other->log_volume);
}

static double step_bound(const walk *w, uint32_t id, uint32_t level)
{
	const esk_columns *columns = &w->search->snapshot.directory->chunks[id / ESK_CHUNK_SLOTS]->columns;
	const uint32_t slot = id % ESK_CHUNK_SLOTS;
	level = step_level(&w->search->query, columns->level_counts[slot], level);
	return esk_bound_of_level(&w->bound, columns, slot, level) +
	       esk_query_size_term(&w->search->query, columns->log_volumes[slot]);
}

/* Puts their distances in place of the bounds of all up to n. */
static void measure(walk *w, esk_ranked *all, size_t n, uint32_t level)
{
	for (size_t i = 0; i < n; i++) {
		if (i + 2 * ESK_SEARCH_AHEAD < n)
			esk_search_ask_place(w->search, all[i + 2 * ESK_SEARCH_AHEAD].id);
		if (i + ESK_SEARCH_AHEAD < n)
			esk_search_ask_shape(w->search, all[i + ESK_SEARCH_AHEAD].id, level, level);
		all[i].distance = step_distance(w, all[i].id, level);
	}
}

/* Only those are measured whose bounds are not above the distances of as many others as stay. */
static void take_step(walk *w, uint32_t level)
{
	const size_t keep = step_keeps(w, w->count);
	for (size_t n = 0; n < w->count; n++) {
		if (n + ESK_SEARCH_AHEAD < w->count)
			esk_search_ask_halves(w->search, w->all[n + ESK_SEARCH_AHEAD].id, level, level);
		w->all[n].distance = step_bound(w, w->all[n].id, level);
	}
	esk_ranked_select(w->all, w->count, keep);
	measure(w, w->all, keep, level);
	const double farthest = esk_ranked_last(w->all, keep)->distance;
	size_t count = keep;
	for (size_t n = keep; n < w->count; n++)
		if (w->all[n].distance <= farthest)
			w->all[count++] = w->all[n];
	measure(w, w->all + keep, count - keep, level);
	esk_ranked_select(w->all, count, keep);
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
	esk_bound_init(&w.bound, &search->query);
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
