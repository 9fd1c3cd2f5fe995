/* The paper's search (section 5.3): compare at level 1, discard the farthest 90 %, compare the rest at level 2, and so
 * on, until few are left; compare those to full depth.
 *
 * Read literally, "until 10 or less remain" overshoots: of 116 shapes 12 and then 2 would be left. So a step never
 * keeps fewer than 10, nor fewer than are wanted. A shape that lacks a step's level is compared at the deepest level that
 * both have. Nothing is proven unless all were compared: a discarded shape may be nearer in the end. */
#include "search.h"

#include "memory.h"

#include <stdlib.h>

enum { least_kept = 10, kept_one_in = 10 };

static double step_distance(const esk_search *search, uint32_t id, uint32_t level)
{
	const esk_shape other = esk_snapshot_shape(&search->snapshot, id);
	const uint32_t mine = esk_shape_level_count(search->query.shape), theirs = esk_shape_level_count(other);
	if (level > mine)
		level = mine;
	if (level > theirs)
		level = theirs;
	return esk_query_level(&search->query, other, level) + esk_query_size_term(&search->query, other);
}

static void list_participants(const esk_search *search, esk_ranked *all)
{
	for (uint32_t chunk = 0; chunk < search->snapshot.directory->chunk_count; chunk++)
		for (uint32_t slot = 0; slot < esk_snapshot_slots(&search->snapshot, chunk); slot++) {
			if (!esk_search_takes(search, chunk, slot))
				continue;
			const uint32_t id = esk_snapshot_id(chunk, slot);
			*all++ = (esk_ranked){0, esk_snapshot_key(&search->snapshot, id), id};
		}
}

eskel_status esk_search_pruned(esk_search *search)
{
	size_t count = search->participant_count;
	const size_t enough = search->answer.wanted > least_kept ? search->answer.wanted : least_kept;
	esk_ranked *all = esk_memory_array(count, sizeof *all);
	if (!all)
		return ESKEL_NO_MEMORY;
	list_participants(search, all);
	for (uint32_t level = 1; count > enough; level++) {
		for (size_t n = 0; n < count; n++)
			all[n].distance = step_distance(search, all[n].id, level);
		size_t tenth = (count + kept_one_in - 1) / kept_one_in, keep = tenth > enough ? tenth : enough;
		esk_ranked_select(all, count, keep);
		count = keep;
		esk_search_end_step(search, count);
	}
	for (size_t n = 0; n < count; n++)
		esk_search_answer(search, all[n].id,
			esk_query_distance(&search->query, esk_snapshot_shape(&search->snapshot, all[n].id), NULL));
	search->result->compared = count;
	search->result->proven = count == search->participant_count;
	free(all);
	return ESKEL_OK;
}
