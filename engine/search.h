/* One search in progress: what the two modes share. */
#ifndef ESK_SEARCH_H
#define ESK_SEARCH_H

#include "distance.h"
#include "ranking.h"
#include "snapshot.h"

typedef struct {
	esk_snapshot snapshot;
	esk_shape *shape; /* the query's */
	esk_query query;
	uint64_t (*participants)[ESK_CHUNK_WORDS]; /* for each chunk a bit for each slot */
	size_t participant_count;
	esk_nearest answer;          /* filled by the mode */
	eskel_search_result *result; /* steps, kept, compared and proven are written by the mode */
} esk_search;

static inline bool esk_search_takes(const esk_search *search, uint32_t chunk, uint32_t slot)
{
	return search->participants[chunk][slot / 64] >> slot % 64 & 1;
}

/* Notes how many shapes a step has left in. */
static inline void esk_search_end_step(esk_search *search, size_t kept)
{
	search->result->kept[search->result->step_count++] = kept;
}

/* Takes a shape's distance into the answer. */
void esk_search_answer(esk_search *search, uint32_t id, double distance);

/* Both fail only when memory runs out. */
eskel_status esk_search_pruned(esk_search *search);
eskel_status esk_search_exact(esk_search *search);

#endif
