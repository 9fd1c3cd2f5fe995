/* The library's writer: adds, removes and tidies up while readers search snapshots (snapshot.h).
 *
 * Two locks. One keeps writers apart for the whole of a change. The other, the gate, guards the current snapshot and
 * is held only to copy or replace it, so readers do not wait for a writer's work. A change is prepared where no reader
 * looks (free slots, new chunks, a new directory) and becomes visible when the snapshot is replaced. */
#include "library.h"

#include "key_index.h"
#include "memory.h"
#include "signature.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

struct eskel_library {
	pthread_mutex_t writing;
	pthread_mutex_t *gate; /* apart, for readers of a const library */
	esk_snapshot current;
	esk_key_index index;
	esk_arena arena;
};

void eskel_library_free(eskel_library *library)
{
	if (!library)
		return;
	esk_directory_release(library->current.directory);
	esk_key_index_clear(&library->index);
	esk_arena_clear(&library->arena);
	pthread_mutex_destroy(library->gate);
	pthread_mutex_destroy(&library->writing);
	free(library->gate);
	free(library);
}

eskel_status eskel_library_new(eskel_library **library)
{
	eskel_library *made = esk_memory_zeroed_array(1, sizeof *made);
	pthread_mutex_t *gate = esk_memory_array(1, sizeof *gate);
	if (!made || !gate || esk_directory_new(0, &made->current.directory) != ESKEL_OK) {
		free(made);
		free(gate);
		return ESKEL_NO_MEMORY;
	}
	/* With default attributes neither can fail here. */
	pthread_mutex_init(&made->writing, NULL);
	pthread_mutex_init(gate, NULL);
	made->gate = gate;
	*library = made;
	return ESKEL_OK;
}

esk_snapshot esk_library_snapshot(const eskel_library *library)
{
	pthread_mutex_lock(library->gate);
	esk_snapshot snapshot = library->current;
	atomic_fetch_add_explicit(&snapshot.directory->references, 1, memory_order_relaxed);
	pthread_mutex_unlock(library->gate);
	return snapshot;
}

size_t eskel_library_count(const eskel_library *library)
{
	pthread_mutex_lock(library->gate);
	size_t count = library->current.shape_count;
	pthread_mutex_unlock(library->gate);
	return count;
}

/* The previous directory is released when the new snapshot has another. */
static void publish(eskel_library *library, esk_snapshot snapshot)
{
	esk_directory *previous = library->current.directory;
	pthread_mutex_lock(library->gate);
	library->current = snapshot;
	pthread_mutex_unlock(library->gate);
	if (previous != snapshot.directory)
		esk_directory_release(previous);
}

static esk_chunk *last_chunk(const eskel_library *library)
{
	const esk_directory *directory = library->current.directory;
	return directory->chunk_count ? directory->chunks[directory->chunk_count - 1] : NULL;
}

/* Afterwards the last chunk has a free slot. */
static eskel_status make_room(eskel_library *library)
{
	const esk_directory *old = library->current.directory;
	esk_chunk *last = last_chunk(library), *chunk = NULL;
	esk_directory *directory = NULL;
	if (last && last->count < last->capacity)
		return ESKEL_OK;
	if (old->chunk_count == UINT32_MAX / ESK_CHUNK_SLOTS)
		return ESKEL_TOO_LARGE;
	eskel_status status = esk_chunk_new(ESK_CHUNK_SLOTS, &library->arena, &chunk);
	if (status == ESKEL_OK)
		status = esk_directory_new(old->chunk_count + 1, &directory);
	if (status != ESKEL_OK) {
		esk_chunk_free(chunk);
		return status;
	}
	for (uint32_t c = 0; c < old->chunk_count; c++)
		esk_directory_set(directory, c, old->chunks[c]);
	esk_directory_set(directory, old->chunk_count, chunk);
	esk_snapshot snapshot = library->current;
	snapshot.directory = directory;
	snapshot.last_count = 0;
	publish(library, snapshot);
	return ESKEL_OK;
}

static void put(esk_chunk *chunk, int64_t key, esk_shape *shape)
{
	const uint32_t ascending = atomic_load_explicit(&chunk->ascending, memory_order_relaxed);
	if (ascending == chunk->count && (ascending == 0 || chunk->keys[ascending - 1] < key))
		atomic_store_explicit(&chunk->ascending, ascending + 1, memory_order_relaxed);
	esk_shape_codes codes;
	esk_columns_encode(shape, &codes);
	esk_columns_put(&chunk->columns, chunk->count, &codes);
	chunk->shapes[chunk->count] = shape;
	chunk->keys[chunk->count++] = key;
}

static eskel_status add(eskel_library *library, int64_t key, const eskel_signature *signature)
{
	eskel_status status = esk_signature_check(signature, NULL);
	if (status != ESKEL_OK)
		return status;
	if (esk_key_index_find(&library->index, key))
		return ESKEL_INVALID;
	if (!esk_key_index_reserve(&library->index))
		return ESKEL_NO_MEMORY;
	status = make_room(library);
	if (status != ESKEL_OK)
		return status;
	esk_shape *shape = esk_arena_take(&library->arena, esk_shape_size(signature->level_count));
	if (!shape)
		return ESKEL_NO_MEMORY;
	esk_shape_write(signature, shape);
	esk_chunk *chunk = last_chunk(library);
	const uint32_t slot = chunk->count;
	put(chunk, key, shape);
	esk_key_index_insert(&library->index, (esk_key_place){key, chunk, slot});
	esk_snapshot snapshot = library->current;
	snapshot.last_count = chunk->count;
	snapshot.shape_count++;
	publish(library, snapshot);
	return ESKEL_OK;
}

eskel_status eskel_library_add(eskel_library *library, int64_t key, const eskel_signature *signature)
{
	pthread_mutex_lock(&library->writing);
	eskel_status status = add(library, key, signature);
	pthread_mutex_unlock(&library->writing);
	return status;
}

/* The shapes that are left, in a chunk that has no room for others and does not keep the arena's older pieces; NULL if
 * none is left. */
static eskel_status copy_survivors(const esk_chunk *chunk, esk_arena *arena, esk_chunk **copy)
{
	const uint32_t removed = atomic_load_explicit(&chunk->removed_count, memory_order_relaxed);
	esk_chunk *made = NULL;
	if (removed == chunk->count) {
		*copy = NULL;
		return ESKEL_OK;
	}
	eskel_status status = esk_chunk_new(chunk->count - removed, arena, &made);
	for (uint32_t slot = 0; status == ESKEL_OK && slot < chunk->count; slot++) {
		if (atomic_load_explicit(&chunk->removed_at[slot], memory_order_relaxed) != ESK_NEVER)
			continue;
		const size_t size = esk_shape_size(chunk->shapes[slot]->level_count);
		esk_shape *shape = esk_arena_take(arena, size);
		if (shape)
			put(made, chunk->keys[slot], memcpy(shape, chunk->shapes[slot], size));
		else
			status = ESKEL_NO_MEMORY;
	}
	if (status != ESKEL_OK) {
		esk_chunk_free(made);
		return status;
	}
	*copy = made;
	return ESKEL_OK;
}

/* A directory with copy in place of chunk, or without it when copy is NULL. */
static eskel_status replace_chunk(
	const esk_directory *old, const esk_chunk *chunk, esk_chunk *copy, esk_directory **directory)
{
	eskel_status status = esk_directory_new(copy ? old->chunk_count : old->chunk_count - 1, directory);
	if (status != ESKEL_OK)
		return status;
	uint32_t next = 0;
	for (uint32_t c = 0; c < old->chunk_count; c++)
		if (old->chunks[c] != chunk)
			esk_directory_set(*directory, next++, old->chunks[c]);
		else if (copy)
			esk_directory_set(*directory, next++, copy);
	return ESKEL_OK;
}

/* Copies what is left of a full chunk once half of it is removed: removals then cost a constant number of copies each,
 * and at most half of the memory is dead. When memory runs out the chunk stays as it is, until its next removal. */
static void compact(eskel_library *library, esk_chunk *chunk)
{
	esk_chunk *copy = NULL;
	esk_directory *directory = NULL;
	if (chunk->count < chunk->capacity ||
		2 * atomic_load_explicit(&chunk->removed_count, memory_order_relaxed) < chunk->count)
		return;
	if (copy_survivors(chunk, &library->arena, &copy) != ESKEL_OK)
		return;
	if (replace_chunk(library->current.directory, chunk, copy, &directory) != ESKEL_OK) {
		esk_chunk_free(copy);
		return;
	}
	for (uint32_t slot = 0; copy && slot < copy->count; slot++) {
		esk_key_place *place = esk_key_index_find(&library->index, copy->keys[slot]);
		place->chunk = copy;
		place->slot = slot;
	}
	esk_snapshot snapshot = library->current;
	snapshot.directory = directory;
	const uint32_t chunks = directory->chunk_count;
	snapshot.last_count = chunks ? directory->chunks[chunks - 1]->count : 0;
	publish(library, snapshot);
}

eskel_status eskel_library_remove(eskel_library *library, int64_t key)
{
	pthread_mutex_lock(&library->writing);
	esk_key_place *place = esk_key_index_find(&library->index, key);
	if (place) {
		esk_chunk *chunk = place->chunk;
		esk_snapshot snapshot = library->current;
		snapshot.moment++;
		snapshot.shape_count--;
		atomic_store_explicit(&chunk->removed_at[place->slot], snapshot.moment, memory_order_relaxed);
		atomic_fetch_add_explicit(&chunk->removed_count, 1, memory_order_relaxed);
		publish(library, snapshot);
		esk_key_index_remove(&library->index, place);
		compact(library, chunk);
	}
	pthread_mutex_unlock(&library->writing);
	return place ? ESKEL_OK : ESKEL_NOT_FOUND;
}
