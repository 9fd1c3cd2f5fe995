#include "snapshot.h"

#include "key_blocks.h"
#include "memory.h"

#include <stdlib.h>
#include <string.h>

void esk_chunk_free(esk_chunk *chunk)
{
	if (!chunk)
		return;
	for (uint32_t slot = 0; slot < chunk->count; slot++)
		esk_arena_give_back(chunk->shapes[slot]);
	esk_columns_clear(&chunk->columns);
	esk_arena_give_back(chunk);
}

eskel_status esk_chunk_new(uint32_t capacity, esk_arena *arena, esk_chunk **chunk)
{
	esk_chunk *made = esk_arena_take(arena, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	memset(made, 0, sizeof *made);
	eskel_status status = esk_columns_init(&made->columns, capacity, arena);
	if (status != ESKEL_OK) {
		esk_arena_give_back(made);
		return status;
	}
	made->capacity = capacity;
	for (uint32_t slot = 0; slot < ESK_CHUNK_SLOTS; slot++)
		atomic_init(&made->removed_at[slot], ESK_NEVER);
	*chunk = made;
	return ESKEL_OK;
}

eskel_status esk_directory_new(uint32_t chunk_count, esk_directory **directory)
{
	esk_directory *made = esk_memory_zeroed_array(1, sizeof *made + chunk_count * sizeof(esk_chunk *));
	if (!made)
		return ESKEL_NO_MEMORY;
	atomic_init(&made->references, 1);
	made->chunk_count = chunk_count;
	*directory = made;
	return ESKEL_OK;
}

void esk_directory_set(esk_directory *directory, uint32_t index, esk_chunk *chunk)
{
	atomic_fetch_add_explicit(&chunk->references, 1, memory_order_relaxed);
	directory->chunks[index] = chunk;
}

void esk_directory_release(esk_directory *directory)
{
	if (!directory || atomic_fetch_sub_explicit(&directory->references, 1, memory_order_acq_rel) > 1)
		return;
	for (uint32_t c = 0; c < directory->chunk_count; c++) {
		esk_chunk *chunk = directory->chunks[c];
		if (chunk && atomic_fetch_sub_explicit(&chunk->references, 1, memory_order_acq_rel) == 1)
			esk_chunk_free(chunk);
	}
	free(directory);
}

/* Stamps are read while the writer may set them. Relaxed is enough: a stamp set before the snapshot was taken is seen,
 * because both happened under the library's gate, and one set later is later than its moment, seen or not. */
void esk_snapshot_visible(const esk_snapshot *snapshot, uint32_t chunk_index, uint64_t slots[ESK_CHUNK_WORDS])
{
	esk_chunk *chunk = snapshot->directory->chunks[chunk_index];
	const uint32_t count = esk_snapshot_slots(snapshot, chunk_index);
	const bool any_removed = atomic_load_explicit(&chunk->removed_count, memory_order_relaxed) > 0;
	memset(slots, 0, ESK_CHUNK_WORDS * sizeof *slots);
	for (uint32_t word = 0; word * 64 < count; word++)
		slots[word] = count - word * 64 >= 64 ? UINT64_MAX : (UINT64_C(1) << (count - word * 64)) - 1;
	for (uint32_t slot = 0; any_removed && slot < count; slot++)
		if (atomic_load_explicit(&chunk->removed_at[slot], memory_order_relaxed) <= snapshot->moment)
			slots[slot / 64] &= ~(UINT64_C(1) << slot % 64);
}

/* The writer may add to the ascending keys meanwhile; those that were there stay so. Where all follow one another, as those of
 * a database mostly do, only the first and the last are read. Keys that do not ascend are looked up one by one. */
void esk_chunk_find(esk_chunk *chunk, uint32_t slot_count, const eskel_key_block *keys, size_t block_count,
	uint64_t slots[ESK_CHUNK_WORDS])
{
	const uint32_t noted = atomic_load_explicit(&chunk->ascending, memory_order_relaxed);
	const uint32_t ascending = noted < slot_count ? noted : slot_count;
	const int64_t *theirs = chunk->keys;
	const bool follow = ascending > 0 && (uint64_t)theirs[ascending - 1] - (uint64_t)theirs[0] == ascending - 1;
	size_t at = 0;
	memset(slots, 0, ESK_CHUNK_WORDS * sizeof *slots);
	for (uint32_t slot = 0; slot < ascending; slot += 64) {
		const uint32_t count = ascending - slot < 64 ? ascending - slot : 64;
		slots[slot / 64] =
			follow ? esk_key_blocks_find_run(keys, block_count, &at, theirs[0] + (int64_t)slot, count)
			       : esk_key_blocks_find(keys, block_count, &at, theirs + slot, count);
	}
	for (uint32_t slot = ascending; slot < slot_count; slot++) {
		at = 0;
		slots[slot / 64] |= esk_key_blocks_find(keys, block_count, &at, theirs + slot, 1) << slot % 64;
	}
}
