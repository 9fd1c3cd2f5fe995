/* The library's writers: they add, remove and tidy up while readers search snapshots (snapshot.h).
 *
 * Two locks. One keeps changes apart. A shape, where it will lie, and its codes, nearly all the work of an addition, are
 * prepared without it: several threads prepare side by side. The other, the gate, guards the current snapshot and is held
 * only to copy or replace it, so readers do not wait for a change. A change is made where no reader looks (free slots,
 * new chunks, a new directory) and becomes visible when the snapshot is replaced.
 *
 * Memory comes from arenas in lanes, one thread in a lane at a time: the first touch of a piece of an arena has the system
 * clear 2 MB, and others would wait for it. One thread alone is always in the first lane. */
#include "library.h"

#include "key_index.h"
#include "memory.h"
#include "signature.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Most of a machine's bandwidth of memory is that of four threads. */
enum { LANES = 4 };

typedef struct {
	pthread_mutex_t lock;
	esk_arena arena;
} lane;

struct eskel_prepared {
	esk_shape *shape; /* in one of the library's arenas */
	esk_shape_codes codes;
};

struct eskel_library {
	pthread_mutex_t writing;
	pthread_mutex_t *gate; /* apart, for readers of a const library */
	esk_neighbourhoods *neighbourhoods;
	esk_snapshot current;
	esk_key_index index;
	lane lanes[LANES];
};

void eskel_library_free(eskel_library *library)
{
	if (!library)
		return;
	esk_neighbourhoods_free(library->neighbourhoods);
	esk_directory_release(library->current.directory);
	esk_key_index_clear(&library->index);
	for (int n = 0; n < LANES; n++) {
		esk_arena_clear(&library->lanes[n].arena);
		pthread_mutex_destroy(&library->lanes[n].lock);
	}
	pthread_mutex_destroy(library->gate);
	pthread_mutex_destroy(&library->writing);
	free(library->gate);
	free(library);
}

eskel_status eskel_library_new(eskel_library **library)
{
	eskel_library *made = esk_memory_zeroed_array(1, sizeof *made);
	pthread_mutex_t *gate = esk_memory_array(1, sizeof *gate);
	esk_neighbourhoods *neighbourhoods = esk_neighbourhoods_new();
	if (!made || !gate || !neighbourhoods || esk_directory_new(0, &made->current.directory) != ESKEL_OK) {
		esk_neighbourhoods_free(neighbourhoods);
		free(made);
		free(gate);
		return ESKEL_NO_MEMORY;
	}
	/* None of these can fail here. */
	pthread_mutexattr_t adaptive; /* spins before it sleeps: most changes take less time than falling asleep */
	pthread_mutexattr_init(&adaptive);
	pthread_mutexattr_settype(&adaptive, PTHREAD_MUTEX_ADAPTIVE_NP);
	pthread_mutex_init(&made->writing, &adaptive);
	pthread_mutexattr_destroy(&adaptive);
	pthread_mutex_init(gate, NULL);
	for (int n = 0; n < LANES; n++)
		pthread_mutex_init(&made->lanes[n].lock, NULL);
	made->gate = gate;
	made->neighbourhoods = neighbourhoods;
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

esk_neighbourhoods *esk_library_neighbourhoods(const eskel_library *library)
{
	return library->neighbourhoods;
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

/* The first lane that is free. */
static lane *enter_lane(eskel_library *library)
{
	lane *last = &library->lanes[LANES - 1];
	for (lane *free = library->lanes; free < last; free++)
		if (pthread_mutex_trylock(&free->lock) == 0)
			return free;
	pthread_mutex_lock(&last->lock);
	return last;
}

static void leave_lane(lane *entered)
{
	pthread_mutex_unlock(&entered->lock);
}

static esk_shape *take_shape(eskel_library *library, uint32_t level_count)
{
	lane *entered = enter_lane(library);
	esk_shape *shape = esk_arena_take(&entered->arena, esk_shape_size(level_count));
	leave_lane(entered);
	return shape;
}

static eskel_status new_chunk(eskel_library *library, uint32_t capacity, esk_chunk **chunk)
{
	lane *entered = enter_lane(library);
	eskel_status status = esk_chunk_new(capacity, &entered->arena, chunk);
	leave_lane(entered);
	return status;
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
	eskel_status status = new_chunk(library, ESK_CHUNK_SLOTS, &chunk);
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

static void put(esk_chunk *chunk, int64_t key, esk_shape *shape, const esk_shape_codes *codes)
{
	const uint32_t ascending = atomic_load_explicit(&chunk->ascending, memory_order_relaxed);
	if (ascending == chunk->count && (ascending == 0 || chunk->keys[ascending - 1] < key))
		atomic_store_explicit(&chunk->ascending, ascending + 1, memory_order_relaxed);
	esk_columns_put(&chunk->columns, chunk->count, codes);
	chunk->shapes[chunk->count] = shape;
	chunk->keys[chunk->count++] = key;
}

static bool has(const eskel_library *library, int64_t key)
{
	uint32_t id;
	return esk_key_index_find(&library->index, library->current.directory, key, &id);
}

static eskel_status add(eskel_library *library, int64_t key, const eskel_prepared *prepared)
{
	if (has(library, key))
		return ESKEL_INVALID;
	if (!esk_key_index_reserve(&library->index, library->current.directory))
		return ESKEL_NO_MEMORY;
	eskel_status status = make_room(library);
	if (status != ESKEL_OK)
		return status;
	esk_snapshot snapshot = library->current;
	esk_chunk *chunk = last_chunk(library);
	const uint32_t id = esk_snapshot_id(snapshot.directory->chunk_count - 1, chunk->count);
	put(chunk, key, prepared->shape, &prepared->codes);
	esk_key_index_insert(&library->index, key, id);
	snapshot.last_count = chunk->count;
	snapshot.shape_count++;
	publish(library, snapshot);
	return ESKEL_OK;
}

static eskel_status add_or_give_back(eskel_library *library, int64_t key, const eskel_prepared *prepared)
{
	pthread_mutex_lock(&library->writing);
	eskel_status status = add(library, key, prepared);
	pthread_mutex_unlock(&library->writing);
	if (status != ESKEL_OK)
		esk_arena_give_back(prepared->shape);
	return status;
}

static eskel_status prepare(eskel_library *library, const eskel_signature *signature, eskel_prepared *prepared)
{
	eskel_status status = esk_signature_check(signature, NULL);
	if (status != ESKEL_OK)
		return status;
	prepared->shape = take_shape(library, signature->level_count);
	if (!prepared->shape)
		return ESKEL_NO_MEMORY;
	esk_shape_write(signature, prepared->shape);
	esk_columns_encode(prepared->shape, &prepared->codes);
	return ESKEL_OK;
}

eskel_status eskel_library_add(eskel_library *library, int64_t key, const eskel_signature *signature)
{
	eskel_prepared prepared;
	eskel_status status = prepare(library, signature, &prepared);
	return status == ESKEL_OK ? add_or_give_back(library, key, &prepared) : status;
}

eskel_status eskel_library_prepare(eskel_library *library, const eskel_signature *signature, eskel_prepared **prepared)
{
	eskel_prepared *made = esk_memory_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	eskel_status status = prepare(library, signature, made);
	if (status == ESKEL_OK)
		*prepared = made;
	else
		free(made);
	return status;
}

eskel_status eskel_library_add_prepared(eskel_library *library, int64_t key, eskel_prepared *prepared)
{
	eskel_status status = add_or_give_back(library, key, prepared);
	free(prepared);
	return status;
}

void eskel_prepared_free(eskel_prepared *prepared)
{
	if (!prepared)
		return;
	esk_arena_give_back(prepared->shape);
	free(prepared);
}

static bool is_removed(esk_chunk *chunk, uint32_t slot)
{
	return atomic_load_explicit(&chunk->removed_at[slot], memory_order_relaxed) != ESK_NEVER;
}

/* A copy of the shape in a chunk that has a free slot. */
static eskel_status put_copy(eskel_library *library, esk_chunk *chunk, int64_t key, const esk_shape *shape)
{
	esk_shape *copy = take_shape(library, shape->level_count);
	esk_shape_codes codes;
	if (!copy)
		return ESKEL_NO_MEMORY;
	memcpy(copy, shape, esk_shape_size(shape->level_count));
	esk_columns_encode(copy, &codes);
	put(chunk, key, copy, &codes);
	return ESKEL_OK;
}

/* The shapes that are left, in a chunk that has no room for others and does not keep the arena's older pieces. */
static eskel_status copy_survivors(eskel_library *library, esk_chunk *chunk, esk_chunk **copy)
{
	const uint32_t removed = atomic_load_explicit(&chunk->removed_count, memory_order_relaxed);
	esk_chunk *made = NULL;
	eskel_status status = new_chunk(library, chunk->count - removed, &made);
	for (uint32_t slot = 0; status == ESKEL_OK && slot < chunk->count; slot++)
		if (!is_removed(chunk, slot))
			status = put_copy(library, made, chunk->keys[slot], chunk->shapes[slot]);
	if (status != ESKEL_OK) {
		esk_chunk_free(made);
		return status;
	}
	*copy = made;
	return ESKEL_OK;
}

static void publish_directory(eskel_library *library, esk_directory *directory)
{
	esk_snapshot snapshot = library->current;
	const uint32_t chunks = directory->chunk_count;
	snapshot.directory = directory;
	snapshot.last_count = chunks ? directory->chunks[chunks - 1]->count : 0;
	publish(library, snapshot);
}

static void shrink_chunk(eskel_library *library, uint32_t index)
{
	const esk_directory *old = library->current.directory;
	esk_chunk *chunk = old->chunks[index], *copy = NULL;
	esk_directory *directory = NULL;
	if (copy_survivors(library, chunk, &copy) != ESKEL_OK)
		return;
	if (esk_directory_new(old->chunk_count, &directory) != ESKEL_OK) {
		esk_chunk_free(copy);
		return;
	}
	for (uint32_t c = 0; c < old->chunk_count; c++)
		esk_directory_set(directory, c, c == index ? copy : old->chunks[c]);
	for (uint32_t slot = 0, next = 0; slot < chunk->count; slot++)
		if (!is_removed(chunk, slot))
			esk_key_index_move(&library->index, chunk->keys[slot], esk_snapshot_id(index, slot),
				esk_snapshot_id(index, next++));
	publish_directory(library, directory);
}

/* Where the chunk at c was before the one at index was left out. The last full one fills the gap, so that few shapes get
 * another number, and the last, which may still grow, stays the last. */
static uint32_t place_before(uint32_t chunk_count, uint32_t index, uint32_t c)
{
	if (c == chunk_count - 2)
		return index == chunk_count - 1 ? c : c + 1;
	return c == index ? chunk_count - 2 : c;
}

static void leave_out_chunk(eskel_library *library, uint32_t index)
{
	const esk_directory *old = library->current.directory;
	esk_directory *directory = NULL;
	if (esk_directory_new(old->chunk_count - 1, &directory) != ESKEL_OK)
		return;
	for (uint32_t c = 0; c < directory->chunk_count; c++) {
		const uint32_t before = place_before(old->chunk_count, index, c);
		esk_chunk *chunk = old->chunks[before];
		esk_directory_set(directory, c, chunk);
		for (uint32_t slot = 0; before != c && slot < chunk->count; slot++)
			if (!is_removed(chunk, slot))
				esk_key_index_move(&library->index, chunk->keys[slot], esk_snapshot_id(before, slot),
					esk_snapshot_id(c, slot));
	}
	publish_directory(library, directory);
}

/* Copies what is left of a full chunk once half of it is removed: removals then cost a constant number of copies each,
 * and at most half of the memory is dead. When memory runs out the chunk stays as it is, until its next removal. */
static void compact(eskel_library *library, uint32_t index)
{
	esk_chunk *chunk = library->current.directory->chunks[index];
	const uint32_t removed = atomic_load_explicit(&chunk->removed_count, memory_order_relaxed);
	if (chunk->count < chunk->capacity)
		return;
	if (removed == chunk->count)
		leave_out_chunk(library, index);
	else if (2 * removed >= chunk->count)
		shrink_chunk(library, index);
}

static void remove_shape(eskel_library *library, int64_t key, uint32_t id)
{
	esk_snapshot snapshot = library->current;
	esk_chunk *chunk = snapshot.directory->chunks[id / ESK_CHUNK_SLOTS];
	snapshot.moment++;
	snapshot.shape_count--;
	atomic_store_explicit(&chunk->removed_at[id % ESK_CHUNK_SLOTS], snapshot.moment, memory_order_relaxed);
	atomic_fetch_add_explicit(&chunk->removed_count, 1, memory_order_relaxed);
	publish(library, snapshot);
	esk_key_index_remove(&library->index, snapshot.directory, key, id);
	compact(library, id / ESK_CHUNK_SLOTS);
}

eskel_status eskel_library_remove(eskel_library *library, int64_t key)
{
	uint32_t id;
	pthread_mutex_lock(&library->writing);
	const bool found = esk_key_index_find(&library->index, library->current.directory, key, &id);
	if (found)
		remove_shape(library, key, id);
	pthread_mutex_unlock(&library->writing);
	return found ? ESKEL_OK : ESKEL_NOT_FOUND;
}
