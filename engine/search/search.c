/* A search from the caller's options to the answer; search_pruned.c and search_exact.c do the work in between.
 *
 * It sees the library as it was when the search began (snapshot.h). */
#include "search.h"

#include "lanes.h"
#include "library.h"
#include "memory.h"
#include "neighbourhood.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	default_limit = 5,
	default_minimum = 10,
	/* So many of the nearest are scaled, and so many more than are wanted. */
	least_shortlist = 40,
	beyond_limit = 35,
};
static const double default_keep = 0.1;

static void choose_slots(
	const esk_snapshot *snapshot, uint32_t c, const eskel_search_options *options, uint64_t slots[ESK_CHUNK_WORDS])
{
	esk_chunk *chunk = snapshot->directory->chunks[c];
	uint64_t found[ESK_CHUNK_WORDS];
	esk_snapshot_visible(snapshot, c, slots);
	if (options->keys) {
		esk_chunk_find(chunk, esk_snapshot_slots(snapshot, c), options->keys, options->key_block_count, found);
		for (uint32_t word = 0; word < ESK_CHUNK_WORDS; word++)
			slots[word] &= found[word];
	}
	if (options->leave_out) {
		eskel_key_block out[2];
		const size_t blocks = eskel_key_blocks_add(out, 0, options->left_out_key, 1);
		esk_chunk_find(chunk, esk_snapshot_slots(snapshot, c), out, blocks, found);
		for (uint32_t word = 0; word < ESK_CHUNK_WORDS; word++)
			slots[word] &= ~found[word];
	}
}

static eskel_status choose_participants(esk_search *search, const eskel_search_options *options)
{
	enum { ahead = 8 };
	const uint32_t chunks = search->snapshot.directory->chunk_count;
	search->participants = esk_memory_array(chunks, sizeof *search->participants);
	if (!search->participants)
		return ESKEL_NO_MEMORY;
	for (uint32_t c = 0; c < chunks; c++) {
		if (c + ahead < chunks)
			esk_chunk_ask(search->snapshot.directory->chunks[c + ahead]);
		choose_slots(&search->snapshot, c, options, search->participants[c]);
		for (uint32_t word = 0; word < ESK_CHUNK_WORDS; word++)
			search->participant_count += (size_t)__builtin_popcountll(search->participants[c][word]);
	}
	return ESKEL_OK;
}

ESK_EVERY_WIDTH void esk_search_leave_out(const esk_search *search, uint32_t chunk, float numbers[ESK_CHUNK_SLOTS])
{
	for (uint32_t slot = 0; slot < ESK_CHUNK_SLOTS; slot += 32) {
		const uint32_t in = (uint32_t)(search->participants[chunk][slot / 64] >> slot % 64);
		for (size_t i = 0; in != UINT32_MAX && i < 32; i++)
			numbers[slot + i] = in >> i & 1 ? numbers[slot + i] : INFINITY;
	}
}

void esk_search_answer(esk_search *search, uint32_t id, double distance, const double *levels)
{
	esk_ranked found = {.distance = distance, .key = esk_snapshot_key(&search->snapshot, id), .id = id};
	if (!esk_nearest_takes(&search->answer, &found, &found.row))
		return;
	const uint32_t depth = esk_query_depth(&search->query, esk_snapshot_shape(&search->snapshot, id));
	if (search->query.summed)
		memcpy(search->levels[found.row], levels, depth * sizeof *levels);
	esk_nearest_offer(&search->answer, found);
}

eskel_status esk_search_run(esk_search *search, const esk_shape *shape, const eskel_search_options *options)
{
	eskel_status status = esk_query_init(&search->query, shape, &options->distance);
	if (status == ESKEL_OK)
		status = choose_participants(search, options);
	if (status != ESKEL_OK)
		return status;
	const size_t limit = options->limit < search->participant_count ? options->limit : search->participant_count;
	search->result->library = search->participant_count;
	if (limit == 0) {
		search->result->proven = true;
		return ESKEL_OK;
	}
	search->levels = esk_memory_array(limit, sizeof *search->levels);
	if (!search->levels || !esk_nearest_init(&search->answer, limit))
		return ESKEL_NO_MEMORY;
	return options->mode == ESKEL_SEARCH_EXACT ? esk_search_exact(search) : esk_search_pruned(search);
}

void esk_search_clear(esk_search *search)
{
	esk_nearest_clear(&search->answer);
	free(search->levels);
	free(search->unscaled);
	free(search->participants);
	esk_query_clear(&search->query);
}

/* The first of the answer in order, each with its D_k. When levels are not summed, only one of them has been computed. */
static eskel_status write_neighbours(esk_search *search, size_t limit)
{
	eskel_search_result *result = search->result;
	esk_nearest *answer = &search->answer;
	const size_t count = limit < answer->count ? limit : answer->count;
	if (count == 0)
		return ESKEL_OK;
	result->neighbours = esk_memory_zeroed_array(count, sizeof *result->neighbours);
	if (!result->neighbours)
		return ESKEL_NO_MEMORY;
	esk_ranked_sort(answer->items, answer->count);
	result->count = count;
	for (size_t n = 0; n < count; n++) {
		const esk_ranked *found = &answer->items[n];
		const esk_shape *shape = esk_snapshot_shape(&search->snapshot, found->id);
		eskel_neighbour *neighbour = &result->neighbours[n];
		neighbour->key = found->key;
		neighbour->distance = search->unscaled ? search->unscaled[found->row] : found->distance;
		neighbour->scaled = search->unscaled ? found->distance : 0;
		neighbour->level_count = esk_query_depth(&search->query, shape);
		if (search->query.summed)
			memcpy(neighbour->levels, search->levels[found->row], neighbour->level_count * sizeof(double));
		else
			esk_query_distance(&search->query, shape, neighbour->levels);
	}
	return ESKEL_OK;
}

static eskel_status answer_scaled(
	const eskel_library *library, const esk_shape *shape, eskel_search_options options, esk_search *search)
{
	const size_t limit = options.limit;
	options.limit = limit < least_shortlist - beyond_limit ? least_shortlist
			: limit < SIZE_MAX - beyond_limit      ? limit + beyond_limit
							       : limit;
	eskel_status status = esk_search_run(search, shape, &options);
	if (status == ESKEL_OK && search->answer.count)
		status = esk_neighbourhoods_scale(esk_library_neighbourhoods(library), &options, search);
	search->result->proven &= search->answer.count == search->participant_count;
	return status == ESKEL_OK ? write_neighbours(search, limit) : status;
}

static eskel_status answer_query(
	const eskel_library *library, const esk_shape *shape, eskel_search_options options, esk_search *search)
{
	if (options.limit == 0)
		options.limit = default_limit;
	if (options.scale == ESKEL_SCALE_NEIGHBOURHOOD)
		return answer_scaled(library, shape, options, search);
	eskel_status status = esk_search_run(search, shape, &options);
	return status == ESKEL_OK ? write_neighbours(search, options.limit) : status;
}

eskel_status eskel_library_search(const eskel_library *library, const eskel_signature *query,
	const eskel_search_options *options, eskel_search_result **result)
{
	const eskel_search_options chosen = options ? *options : (eskel_search_options){0};
	if ((unsigned)chosen.mode > ESKEL_SEARCH_PRUNED || (unsigned)chosen.scale > ESKEL_SCALE_NEIGHBOURHOOD ||
		!(chosen.keep >= 0 && chosen.keep <= 1))
		return ESKEL_INVALID;
	esk_shape *shape = NULL;
	eskel_search_result *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	esk_search search = {
		.snapshot = esk_library_snapshot(library),
		.keep = chosen.keep > 0 ? chosen.keep : default_keep,
		.minimum = chosen.minimum ? chosen.minimum : default_minimum,
		.watch = chosen.watch,
		.watched_key = chosen.watched_key,
		.result = made,
	};
	eskel_status status = esk_shape_new(query, &shape);
	if (status == ESKEL_OK)
		status = answer_query(library, shape, chosen, &search);
	esk_search_clear(&search);
	esk_shape_release(shape);
	esk_directory_release(search.snapshot.directory);
	if (status != ESKEL_OK) {
		eskel_search_result_free(made);
		return status;
	}
	*result = made;
	return ESKEL_OK;
}

void eskel_search_result_free(eskel_search_result *result)
{
	if (!result)
		return;
	free(result->neighbours);
	free(result);
}
