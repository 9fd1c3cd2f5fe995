#include "snapshot.h"

#include "memory.h"

#include <endian.h>
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

/* The first of ascending keys from begin on that is not below key. It gallops, because the next is mostly near. */
static size_t advance(const int64_t *keys, size_t count, size_t begin, int64_t key)
{
	size_t low = begin, step = 1;
	while (step <= count - low && keys[low + step - 1] < key) {
		low += step;
		step *= 2;
	}
	size_t high = step <= count - low ? low + step - 1 : count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (keys[middle] < key)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static inline void set(uint64_t *slots, size_t slot, bool found)
{
	slots[slot / 64] |= (uint64_t)found << slot % 64;
}

/* Eight bytes, each 0 or 1, as bits. Byte i, at 2^(8i), is moved to 2^(56 + i) by the factor's 2^(56 - 7i), and no two of the
 * products share a place. */
static uint64_t gather_bits(const uint8_t bytes[8])
{
	uint64_t eight;
	memcpy(&eight, bytes, sizeof eight);
	return le64toh(eight) * 0x0102040810204080 >> 56;
}

enum { LONGEST_SPAN = 4 * ESK_CHUNK_SLOTS };

/* Sets the slots of keys, which lie in the span that begins with the first of theirs: a key marks its place in the span, and
 * each slot looks at that of its own. Nothing branches on what is there, which could not be foreseen. Where their keys follow
 * one another, as those of a database mostly do, a slot is a place. */
static void mark(const int64_t *their_keys, uint32_t slot_count, size_t span, const int64_t *keys, size_t key_count,
	uint64_t *slots)
{
	uint8_t marks[LONGEST_SPAN + ESK_CHUNK_SLOTS] = {0}, *of_slots = marks;
	for (size_t at = 0; at < key_count; at++)
		marks[keys[at] - their_keys[0]] = 1;
	if (span > slot_count) {
		of_slots = marks + LONGEST_SPAN;
		for (size_t slot = 0; slot < slot_count; slot++)
			of_slots[slot] = marks[their_keys[slot] - their_keys[0]];
	}
	for (size_t slot = 0; slot < slot_count; slot += 8)
		slots[slot / 64] |= gather_bits(of_slots + slot) << slot % 64;
}

/* Sets the slots of keys that are there; both lists ascend, and the keys are none below the first or above the last of
 * theirs. */
static void find_ascending(
	const int64_t *their_keys, uint32_t slot_count, const int64_t *keys, size_t key_count, uint64_t *slots)
{
	const uint64_t span = (uint64_t)their_keys[slot_count - 1] - (uint64_t)their_keys[0];
	if (8 * key_count >= slot_count && span < LONGEST_SPAN) {
		mark(their_keys, slot_count, (size_t)span + 1, keys, key_count, slots);
		return;
	}
	for (size_t at = 0, slot = 0; at < key_count; at++) {
		slot = advance(their_keys, slot_count, slot, keys[at]);
		set(slots, slot, their_keys[slot] == keys[at]);
	}
}

/* The writer may add to the ascending keys meanwhile; those that were there stay so. The others are looked up one by one. */
void esk_chunk_find(
	esk_chunk *chunk, uint32_t slot_count, const int64_t *keys, size_t key_count, uint64_t slots[ESK_CHUNK_WORDS])
{
	const uint32_t noted = atomic_load_explicit(&chunk->ascending, memory_order_relaxed);
	const uint32_t ascending = noted < slot_count ? noted : slot_count;
	memset(slots, 0, ESK_CHUNK_WORDS * sizeof *slots);
	if (ascending > 0) {
		const int64_t greatest = chunk->keys[ascending - 1];
		const size_t first = advance(keys, key_count, 0, chunk->keys[0]);
		const size_t last = advance(keys, key_count, first, greatest);
		const bool one_more = last < key_count && keys[last] == greatest;
		find_ascending(chunk->keys, ascending, keys + first, last + one_more - first, slots);
	}
	for (size_t slot = ascending; slot < slot_count; slot++) {
		const size_t at = advance(keys, key_count, 0, chunk->keys[slot]);
		set(slots, slot, at < key_count && keys[at] == chunk->keys[slot]);
	}
}
