/* The paper's search (section 5.3): compare at level 1, discard the farthest 90 %, compare the rest at level 2, and so
 * on, until few are left; compare those to full depth.
 *
 * Read literally, "until 10 or less remain" overshoots: of 116 shapes 12 and then 2 would be left. So a step never
 * keeps fewer than 10 (or as many as are asked for), nor fewer than are wanted. A shape that lacks a step's level is
 * compared at the deepest level that both have. Nothing is proven unless all were compared: a discarded shape may be
 * nearer in the end.
 *
 * Which shapes a step keeps is decided to the last bit, but for the first two steps, which look at many, few distances are
 * computed: levels 1 and 2 are scanned as codes (scan.h), which tell a distance within a small width, and only shapes
 * within a width of the last to stay are measured. */
#include "search.h"

#include "below.h"
#include "memory.h"
#include "scan.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
	esk_search *search;
	esk_scan scans[2];  /* of levels 1 and 2 */
	esk_candidate *all; /* those still in */
	size_t count;
	float largest_scale; /* of those listed, where scales count */
	esk_ranked *measured;
	size_t measured_count, measured_capacity;
} walk;

/* How many of count shapes a step keeps. */
static size_t step_keeps(const walk *w, size_t count)
{
	const double part = (double)count * w->search->keep;
	size_t keep = (size_t)ceil(part - 1e-9 * part); /* 0.1 of 30 is a little more than 3 */
	if (keep < w->search->minimum)
		keep = w->search->minimum;
	if (keep < w->search->answer.wanted)
		keep = w->search->answer.wanted;
	return keep < count ? keep : count;
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

/* ---- measuring */

/* False when memory ran out. */
static bool measure(walk *w, const esk_candidate *some, size_t count, uint32_t level)
{
	void *measured = w->measured;
	if (!esk_memory_reserve(&measured, &w->measured_capacity, count, sizeof *w->measured))
		return false;
	w->measured = measured;
	for (size_t i = 0; i < count; i++) {
		if (i + 2 * ESK_SEARCH_AHEAD < count)
			esk_search_ask_place(w->search, some[i + 2 * ESK_SEARCH_AHEAD].id);
		if (i + ESK_SEARCH_AHEAD < count)
			esk_search_ask_level(w->search, some[i + ESK_SEARCH_AHEAD].id, level);
		const uint32_t id = some[i].id;
		w->measured[i] = (esk_ranked){.distance = step_distance(w, id, level),
			.key = esk_snapshot_key(&w->search->snapshot, id),
			.id = id};
	}
	w->measured_count = count;
	return true;
}

/* Appends the nearest so many of those measured to all. */
static void keep_measured(walk *w, size_t keep)
{
	esk_ranked_select(w->measured, w->measured_count, keep);
	for (size_t i = 0; i < keep; i++)
		w->all[w->count++] = (esk_candidate){(float)w->measured[i].distance, w->measured[i].id};
}

/* ---- levels 1 and 2 */

/* How far above lower the distances of those can be that are near the last to stay. */
static float width_at(const walk *w, uint32_t level, float last)
{
	const float differences = (float)(level * esk_numbers(w->search->query.signature));
	return esk_scan_width(&w->scans[level - 1], differences, 2 * last, w->largest_scale);
}

/* Keeps the nearest. Let last be the keep-th smallest lower: the keep-th smallest distance is then between last and last
 * plus width, and only those whose intervals reach into that one are measured. Written without branches, because which way
 * they would go cannot be foreseen. */
static bool keep_nearest(walk *w, size_t keep, float last, uint32_t level)
{
	const float width = width_at(w, level, last);
	size_t certain = 0, open = 0;
	esk_candidate *doubtful = esk_memory_array(w->count + 1, sizeof *doubtful);
	if (!doubtful)
		return false;
	for (size_t i = 0; i < w->count; i++) {
		const esk_candidate c = w->all[i];
		const bool is_certain = c.lower + width < last, is_open = c.lower <= last + width;
		w->all[certain] = c;
		certain += is_certain;
		doubtful[open] = c;
		open += is_open & !is_certain;
	}
	w->count = certain;
	const bool good = measure(w, doubtful, open, level);
	if (good)
		keep_measured(w, keep - certain);
	free(doubtful);
	return good;
}

static float exactly(const walk *w, uint32_t id, uint32_t level)
{
	return (float)step_distance(w, id, level) * (1 - 0x1p-20f);
}

/* D_1 of every slot of a chunk. */
static void scan_first(const walk *w, uint32_t c, uint32_t slots, float *lower)
{
	esk_chunk *chunk = w->search->snapshot.directory->chunks[c];
	const esk_query *query = &w->search->query;
	esk_scan_columns(&w->scans[0], &chunk->columns, chunk->columns.first_level[query->signature], false,
		query->rows[0], slots, lower);
	for (uint32_t slot = 0; !esk_columns_are_plain(&chunk->columns, 1) && slot < slots; slot++)
		if (chunk->columns.odd[slot] && esk_search_takes(w->search, c, slot))
			lower[slot] = exactly(w, esk_snapshot_id(c, slot), 1);
}

/* Lists those of a chunk that take part and may be as near as enough. */
static void list_chunk(walk *w, uint32_t c, float enough)
{
	const esk_columns *columns = &w->search->snapshot.directory->chunks[c]->columns;
	const uint32_t slots = esk_snapshot_slots(&w->search->snapshot, c);
	float lower[ESK_CHUNK_SLOTS];
	uint16_t places[ESK_CHUNK_SLOTS];
	scan_first(w, c, slots, lower);
	esk_search_leave_out(w->search, c, lower);
	const uint32_t found = esk_below(lower, ESK_CHUNK_SLOTS, enough, places);
	for (uint32_t i = 0; i < found; i++)
		w->all[w->count++] = (esk_candidate){lower[places[i]], esk_snapshot_id(c, places[i])};
	for (uint32_t i = 0; w->scans[0].has_unit && i < found; i++)
		w->largest_scale = fmaxf(w->largest_scale, columns->scales[places[i]]);
}

/* Lists those of every so-manieth chunk. */
static void list(walk *w, float enough, uint32_t stride)
{
	w->count = 0;
	w->largest_scale = 0;
	for (uint32_t c = 0; c < w->search->snapshot.directory->chunk_count; c += stride) {
		esk_search_ask_columns(w->search, c + stride, true);
		if (esk_search_takes_any(w->search, c))
			list_chunk(w, c, enough);
	}
}

/* How near the shapes are that stay, guessed from those of some chunks, so that few others are listed. Shapes that were added
 * together are often alike, so the guess is generous. */
static float guess(walk *w, size_t keep)
{
	enum { least_chunks = 8, sampled = 64 };
	const uint32_t chunks = w->search->snapshot.directory->chunk_count, stride = chunks / sampled;
	if (chunks < least_chunks)
		return FLT_MAX;
	list(w, FLT_MAX, stride < 2 ? 2 : stride);
	const size_t rank = (size_t)(1.3 * (double)keep / (double)w->search->participant_count * (double)w->count);
	return rank < w->count ? esk_candidates_nth(w->all, w->count, rank) : FLT_MAX;
}

static bool take_first_step(walk *w)
{
	const size_t keep = step_keeps(w, w->search->participant_count);
	w->all = esk_memory_array(w->search->participant_count + ESK_CHUNK_SLOTS, sizeof *w->all);
	if (!w->all)
		return false;
	const float enough = keep < w->search->participant_count ? guess(w, keep) : FLT_MAX;
	list(w, enough, 1);
	float last = w->count < keep ? FLT_MAX : esk_candidates_nth(w->all, w->count, keep - 1);
	if (enough < FLT_MAX && last + width_at(w, 1, last) > enough) {
		list(w, FLT_MAX, 1);
		last = esk_candidates_nth(w->all, w->count, keep - 1);
	}
	return keep == w->count || keep_nearest(w, keep, last, 1);
}

/* The slots of one chunk among those still in, from begin on; returns where they end. */
static size_t take_chunk(const walk *w, size_t begin, uint16_t slots[ESK_CHUNK_SLOTS])
{
	const uint32_t first = w->all[begin].id / ESK_CHUNK_SLOTS * ESK_CHUNK_SLOTS;
	const esk_columns *columns = &esk_snapshot_chunk(&w->search->snapshot, first)->columns;
	size_t end = begin;
	for (; end < w->count && end - begin < ESK_CHUNK_SLOTS && w->all[end].id - first < ESK_CHUNK_SLOTS; end++) {
		const uint16_t slot = (uint16_t)(w->all[end].id - first);
		__builtin_prefetch(esk_columns_second(columns, slot, w->scans[1].signature));
		__builtin_prefetch(&columns->log_volumes[slot]);
		slots[end - begin] = slot;
	}
	return end;
}

/* D_2 of those from begin on, which lie in one chunk. */
static void scan_second(walk *w, const uint16_t *slots, size_t begin, uint32_t count)
{
	esk_columns *columns = &esk_snapshot_chunk(&w->search->snapshot, w->all[begin].id)->columns;
	float lower[ESK_CHUNK_SLOTS];
	esk_scan_pairs(&w->scans[1], columns, w->search->query.rows[1], slots, count, lower);
	for (uint32_t i = 0; i < count; i++)
		w->all[begin + i].lower = lower[i];
	for (uint32_t i = 0; !esk_columns_are_plain(columns, 2) && i < count; i++)
		if (columns->odd[slots[i]] || columns->level_counts[slots[i]] < 2)
			w->all[begin + i].lower = exactly(w, w->all[begin + i].id, 2);
}

/* While those of one chunk are looked at, the rows of the next are on their way. */
static bool take_second_step(walk *w)
{
	uint16_t slots[2][ESK_CHUNK_SLOTS];
	size_t begin = 0, end = take_chunk(w, 0, slots[0]);
	for (int turn = 0; begin < w->count; turn = !turn) {
		const size_t next = end < w->count ? take_chunk(w, end, slots[!turn]) : end;
		scan_second(w, slots[turn], begin, (uint32_t)(end - begin));
		begin = end;
		end = next;
	}
	const size_t keep = step_keeps(w, w->count);
	return keep_nearest(w, keep, esk_candidates_nth(w->all, w->count, keep - 1), 2);
}

/* ---- deeper levels */

static bool take_step(walk *w, uint32_t level)
{
	const size_t keep = step_keeps(w, w->count);
	if (!measure(w, w->all, w->count, level))
		return false;
	w->count = 0;
	keep_measured(w, keep);
	return true;
}

static void compare(walk *w)
{
	for (size_t n = 0; n < w->count; n++) {
		const uint32_t id = w->all[n].id;
		const esk_shape *shape = esk_snapshot_shape(&w->search->snapshot, id);
		double levels[ESKEL_LEVELS_MAX];
		const double distance =
			esk_query_distance(&w->search->query, shape, w->search->query.summed ? levels : NULL);
		esk_search_answer(w->search, id, distance, levels);
	}
	w->search->result->compared = w->count;
	w->search->result->proven = w->count == w->search->participant_count;
}

/* Notes how many a step has left in, and whether the watched shape is one of them. */
static void end_step(const walk *w)
{
	esk_search *search = w->search;
	esk_search_end_step(search, w->count);
	for (size_t i = 0; search->watch && i < w->count; i++)
		if (esk_snapshot_key(&search->snapshot, w->all[i].id) == search->watched_key)
			search->result->watched_steps = search->result->step_count;
}

eskel_status esk_search_pruned(esk_search *search)
{
	walk w = {.search = search};
	const bool halved = search->query.signature == ESKEL_SIGNATURE_LOG;
	w.scans[0] = esk_scan_make(&search->query, 1);
	w.scans[1] = esk_scan_make(&search->query, halved ? 0.5f : 1);
	bool good = take_first_step(&w);
	if (good && w.count < search->participant_count)
		end_step(&w);
	for (uint32_t level = 2; good && step_keeps(&w, w.count) < w.count; level++) {
		good = level == 2 && search->query.shape->level_count >= 2 ? take_second_step(&w)
									   : take_step(&w, level);
		if (good)
			end_step(&w);
	}
	if (good)
		compare(&w);
	free(w.all);
	free(w.measured);
	return good ? ESKEL_OK : ESKEL_NO_MEMORY;
}
