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

static inline bool esk_search_takes_any(const esk_search *search, uint32_t chunk)
{
	uint64_t any = 0;
	for (uint32_t word = 0; word < ESK_CHUNK_WORDS; word++)
		any |= search->participants[chunk][word];
	return any != 0;
}

/* Notes how many shapes a step has left in. */
static inline void esk_search_end_step(esk_search *search, size_t kept)
{
	search->result->kept[search->result->step_count++] = kept;
}

/* A search knows which shapes it will read long before it does: these ask for what it reads of a shape at the levels
 * first..last, as far as can be told without touching the shape: most have as many levels as the query. */
enum { ESK_SEARCH_AHEAD = 12 };

static inline void esk_search_ask(const void *from, size_t size)
{
	for (size_t at = 0; at < size + 63; at += 64)
		__builtin_prefetch((const char *)from + at);
}

static inline void esk_search_ask_halves(const esk_search *search, uint32_t id, uint32_t first, uint32_t last)
{
	const eskel_signature_kind kind = search->query.signature;
	const esk_columns *columns = &search->snapshot.directory->chunks[id / ESK_CHUNK_SLOTS]->columns;
	const size_t row = 2 * esk_numbers(kind);
	if (last <= ESK_SUMMED_LEVELS)
		esk_search_ask(esk_columns_halves(columns, id % ESK_CHUNK_SLOTS, kind) + (first - 1) * row,
			(last - first + 1) * row);
}

/* Where a shape lies has to be read before the shape can be asked for. */
static inline void esk_search_ask_place(const esk_search *search, uint32_t id)
{
	__builtin_prefetch(&search->snapshot.directory->chunks[id / ESK_CHUNK_SLOTS]->shapes[id % ESK_CHUNK_SLOTS]);
}

static inline void esk_search_ask_shape(const esk_search *search, uint32_t id, uint32_t first, uint32_t last)
{
	const char *shape = (const char *)esk_snapshot_shape(&search->snapshot, id);
	const size_t begin = ESK_NUMBERS_MAX * ESKEL_NODES(first - 1), end = ESK_NUMBERS_MAX * ESKEL_NODES(last);
	__builtin_prefetch(shape);
	__builtin_prefetch(shape + sizeof(esk_shape) + begin / 2);
	esk_search_ask(shape + (search->shape->numbers + begin) * sizeof(float), (end - begin) * sizeof(float));
}

/* Takes a shape's distance into the answer. */
void esk_search_answer(esk_search *search, uint32_t id, double distance);

/* Both fail only when memory runs out. */
eskel_status esk_search_pruned(esk_search *search);
eskel_status esk_search_exact(esk_search *search);

#endif
