/* One search in progress: what the two modes share. */
#ifndef ESK_SEARCH_H
#define ESK_SEARCH_H

#include "distance.h"
#include "ranking.h"
#include "snapshot.h"

typedef struct {
	esk_snapshot snapshot;
	esk_query query;
	double keep; /* by each step of the pruned search: this share, but not fewer than the minimum */
	size_t minimum;
	uint64_t (*participants)[ESK_CHUNK_WORDS]; /* for each chunk a bit for each slot */
	size_t participant_count;
	esk_nearest answer;                 /* filled by the mode */
	double (*levels)[ESKEL_LEVELS_MAX]; /* D_k of each in the answer, by its row, when levels are summed */
	double *unscaled;                   /* the distance of each, by its row, where the answer has another */
	eskel_search_result *result;        /* steps, kept, compared and proven are written by the mode */
	int64_t watched_key;
	bool watch; /* the shape with that key, through the steps of the pruned mode */
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

/* Makes the numbers of all slots infinite that do not take part, those included that hold no shape. */
void esk_search_leave_out(const esk_search *search, uint32_t chunk, float numbers[ESK_CHUNK_SLOTS]);

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
	const uintptr_t begin = (uintptr_t)from / 64 * 64, end = (uintptr_t)from + size;
	for (uintptr_t at = begin; at < end; at += 64)
		__builtin_prefetch((const void *)at);
}

/* What a scan of a chunk reads: columns of codes, which lie one after the other, and of floats. For the second cache: the
 * first is too small for two chunks. */
static inline void esk_search_ask_column(const void *from, size_t size)
{
	for (size_t at = 0; at < size; at += 64)
		__builtin_prefetch((const char *)from + at, 0, 2);
}

static inline void esk_search_ask_columns(const esk_search *search, uint32_t chunk, bool first_level)
{
	if (chunk >= search->snapshot.directory->chunk_count)
		return;
	const eskel_signature_kind kind = search->query.signature;
	const esk_columns *columns = &search->snapshot.directory->chunks[chunk]->columns;
	const size_t column = columns->capacity * sizeof(uint16_t) * esk_numbers(kind);
	if (first_level)
		esk_search_ask_column(columns->first_level[kind], column);
	else
		esk_search_ask_column(columns->total_halves[kind], 2 * column);
	esk_search_ask_column(columns->log_volumes, columns->capacity * sizeof(float));
	if (kind == ESKEL_SIGNATURE_PAPER)
		esk_search_ask_column(columns->scales, columns->capacity * sizeof(float));
}

static inline void esk_search_ask_halves(const esk_search *search, uint32_t id, uint32_t first, uint32_t last)
{
	const eskel_signature_kind kind = search->query.signature;
	const esk_columns *columns = &esk_snapshot_chunk(&search->snapshot, id)->columns;
	const size_t row = 2 * esk_numbers(kind);
	if (last <= ESK_SUMMED_LEVELS)
		esk_search_ask(esk_columns_halves(columns, id % ESK_CHUNK_SLOTS, kind) + (first - 1) * row,
			(last - first + 1) * row);
}

/* Where a shape lies has to be read before the shape can be asked for. */
static inline void esk_search_ask_place(const esk_search *search, uint32_t id)
{
	const esk_chunk *chunk = esk_snapshot_chunk(&search->snapshot, id);
	__builtin_prefetch(&chunk->shapes[id % ESK_CHUNK_SLOTS]);
	__builtin_prefetch(&chunk->keys[id % ESK_CHUNK_SLOTS]);
}

/* The numbers of levels first..last. */
static inline void esk_search_ask_numbers(const esk_search *search, uint32_t id, uint32_t first, uint32_t last)
{
	const esk_shape *shape = esk_snapshot_shape(&search->snapshot, id);
	const char *begin = (const char *)(shape->numbers + ESK_NUMBERS_MAX * ESKEL_NODES(first - 1));
	__builtin_prefetch(shape);
	esk_search_ask(begin, ESK_NUMBERS_MAX * sizeof(float) * (ESKEL_NODES(last) - ESKEL_NODES(first - 1)));
}

/* And their ranks. */
static inline void esk_search_ask_level(const esk_search *search, uint32_t id, uint32_t level)
{
	const esk_shape *shape = esk_snapshot_shape(&search->snapshot, id);
	const size_t numbers = ESK_NUMBERS_MAX * ESKEL_NODES(search->query.shape->level_count);
	esk_search_ask_numbers(search, id, level, level);
	__builtin_prefetch((const char *)(shape->numbers + numbers) + ESK_NUMBERS_MAX * ESKEL_NODES(level - 1) / 2);
}

/* Takes a shape's distance into the answer, with its D_k, which are read when levels are summed. */
void esk_search_answer(esk_search *search, uint32_t id, double distance, const double *levels);

/* Fills the answer for a shape, which must outlive the search. The snapshot and the result are set, all else is zero; clear
 * the search afterwards, after a failure as well. Without shapes that take part there is no answer. */
eskel_status esk_search_run(esk_search *search, const esk_shape *shape, const eskel_search_options *options);
void esk_search_clear(esk_search *search);

/* The two modes. Both fail only when memory runs out. */
eskel_status esk_search_pruned(esk_search *search);
eskel_status esk_search_exact(esk_search *search);

#endif
