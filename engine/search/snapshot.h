/* A library as it was at one moment: what a reader holds while others add and remove.
 *
 * Shapes lie in chunks. A chunk is filled from its first slot on and a filled slot never changes. A removal only stamps
 * the slot with the moment that it took effect, so a reader of an earlier moment still sees the shape. The chunks in
 * use are listed by a directory, which is immutable; the writer replaces it by another. Chunks live as long as a
 * directory lists them, and directories as long as the library or a snapshot holds them.
 *
 * Only the last chunk of a directory can still grow, so a snapshot notes how far it was filled. */
#ifndef ESK_SNAPSHOT_H
#define ESK_SNAPSHOT_H

#include "columns.h"

#include <stdatomic.h>

/* The columns that a scan sums over fit the first-level cache. */
enum { ESK_CHUNK_SLOTS = 512, ESK_CHUNK_WORDS = ESK_CHUNK_SLOTS / 64 };

#define ESK_NEVER UINT64_MAX

typedef struct {
	atomic_uint references; /* directories that list it */
	uint32_t capacity;      /* at most ESK_CHUNK_SLOTS */
	uint32_t count;         /* slots filled */
	atomic_uint ascending;  /* so many of the first keys ascend; all, mostly */
	atomic_uint removed_count;
	esk_columns columns;
	esk_shape *shapes[ESK_CHUNK_SLOTS];
	int64_t keys[ESK_CHUNK_SLOTS];
	atomic_uint_least64_t removed_at[ESK_CHUNK_SLOTS]; /* ESK_NEVER until removed */
} esk_chunk;

typedef struct {
	atomic_uint references;
	uint32_t chunk_count;
	esk_chunk *chunks[];
} esk_directory;

typedef struct {
	esk_directory *directory;
	uint32_t last_count; /* slots of the last chunk */
	uint64_t moment;     /* removals so far */
	size_t shape_count;
} esk_snapshot;

/* It and its columns lie in the arena. */
eskel_status esk_chunk_new(uint32_t capacity, esk_arena *arena, esk_chunk **chunk);
/* Asks for what a search reads of every chunk before it looks at its columns. */
static inline void esk_chunk_ask(const esk_chunk *chunk)
{
	for (const char *at = (const char *)chunk; at < (const char *)&chunk->shapes; at += 64)
		__builtin_prefetch(at);
}

/* For a chunk that no directory lists. */
void esk_chunk_free(esk_chunk *chunk);

/* A directory with room for chunk_count, none set, and one reference. */
eskel_status esk_directory_new(uint32_t chunk_count, esk_directory **directory);
void esk_directory_set(esk_directory *directory, uint32_t index, esk_chunk *chunk);
void esk_directory_release(esk_directory *directory);

static inline int64_t esk_directory_key(const esk_directory *directory, uint32_t id)
{
	return directory->chunks[id / ESK_CHUNK_SLOTS]->keys[id % ESK_CHUNK_SLOTS];
}

static inline uint32_t esk_snapshot_slots(const esk_snapshot *snapshot, uint32_t chunk)
{
	bool last = chunk == snapshot->directory->chunk_count - 1;
	return last ? snapshot->last_count : snapshot->directory->chunks[chunk]->count;
}

/* Sets bit s for each slot that holds a shape of the snapshot. */
void esk_snapshot_visible(const esk_snapshot *snapshot, uint32_t chunk, uint64_t slots[ESK_CHUNK_WORDS]);

/* Sets bit s for each of the first slot_count slots whose key is among these. */
void esk_chunk_find(esk_chunk *chunk, uint32_t slot_count, const eskel_key_block *keys, size_t block_count,
	uint64_t slots[ESK_CHUNK_WORDS]);

/* A shape's number within the snapshot; within its directory, too. */
static inline uint32_t esk_snapshot_id(uint32_t chunk, uint32_t slot)
{
	return chunk * ESK_CHUNK_SLOTS + slot;
}

static inline esk_chunk *esk_snapshot_chunk(const esk_snapshot *snapshot, uint32_t id)
{
	return snapshot->directory->chunks[id / ESK_CHUNK_SLOTS];
}

static inline const esk_shape *esk_snapshot_shape(const esk_snapshot *snapshot, uint32_t id)
{
	return esk_snapshot_chunk(snapshot, id)->shapes[id % ESK_CHUNK_SLOTS];
}

static inline int64_t esk_snapshot_key(const esk_snapshot *snapshot, uint32_t id)
{
	return esk_directory_key(snapshot->directory, id);
}

#endif
