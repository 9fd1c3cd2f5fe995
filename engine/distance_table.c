/* Distances of every pair of two lists of a library's shapes. */
#include "distance.h"
#include "library.h"
#include "memory.h"

#include <stdlib.h>
#include <string.h>

/* A key that is looked for. */
typedef struct {
	int64_t key;
	size_t position;
} wanted;

static int by_key(const void *a, const void *b)
{
	const wanted *x = a, *y = b;
	return x->key < y->key ? -1 : x->key > y->key;
}

static size_t first_with_key(const wanted *sorted, size_t count, int64_t key)
{
	size_t low = 0, high = count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (sorted[middle].key < key)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static size_t find_sorted(const esk_snapshot *snapshot, const wanted *sorted, size_t count, eskel_key_block *keys,
	const esk_shape **shapes)
{
	size_t found = 0, blocks = 0;
	for (size_t n = 0; n < count; n++)
		blocks = eskel_key_blocks_add(keys, blocks, sorted[n].key, 1);
	for (uint32_t c = 0; c < snapshot->directory->chunk_count && found < count; c++) {
		esk_chunk *chunk = snapshot->directory->chunks[c];
		const uint32_t slots = esk_snapshot_slots(snapshot, c);
		uint64_t visible[ESK_CHUNK_WORDS], among[ESK_CHUNK_WORDS];
		esk_snapshot_visible(snapshot, c, visible);
		esk_chunk_find(chunk, slots, keys, blocks, among);
		for (uint32_t slot = 0; slot < slots; slot++) {
			if (!(visible[slot / 64] & among[slot / 64] & UINT64_C(1) << slot % 64))
				continue;
			size_t at = first_with_key(sorted, count, chunk->keys[slot]);
			for (; at < count && sorted[at].key == chunk->keys[slot]; at++, found++)
				shapes[sorted[at].position] = chunk->shapes[slot];
		}
	}
	return found;
}

static eskel_status find(const esk_snapshot *snapshot, const int64_t *keys, size_t count, const esk_shape ***shapes)
{
	wanted *sorted = esk_memory_array(count, sizeof *sorted);
	eskel_key_block *blocks = esk_memory_array(count, sizeof *blocks);
	const esk_shape **made = esk_memory_array(count, sizeof *made);
	eskel_status status = sorted && blocks && made ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (size_t n = 0; status == ESKEL_OK && n < count; n++)
		sorted[n] = (wanted){keys[n], n};
	if (status == ESKEL_OK && count > 1)
		qsort(sorted, count, sizeof *sorted, by_key);
	if (status == ESKEL_OK && find_sorted(snapshot, sorted, count, blocks, made) < count)
		status = ESKEL_NOT_FOUND;
	free(sorted);
	free(blocks);
	if (status != ESKEL_OK) {
		free(made);
		return status;
	}
	*shapes = made;
	return ESKEL_OK;
}

static void free_queries(esk_query *queries, size_t count)
{
	for (size_t n = 0; queries && n < count; n++)
		esk_query_clear(&queries[n]);
	free(queries);
}

static eskel_status make_queries(
	const esk_shape **shapes, size_t count, const eskel_distance_options *options, esk_query **queries)
{
	esk_query *made = esk_memory_zeroed_array(count, sizeof *made);
	eskel_status status = made ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (size_t n = 0; status == ESKEL_OK && n < count; n++)
		status = esk_query_init(&made[n], shapes[n], options);
	if (status != ESKEL_OK) {
		free_queries(made, count);
		return status;
	}
	*queries = made;
	return ESKEL_OK;
}

/* When rows and columns are the same list, the lower triangle is the upper one to the last bit (distance.c). */
static void fill(const esk_query *rows, size_t row_count, const esk_shape **columns, size_t column_count, bool same,
	double *distances)
{
	for (size_t r = 0; r < row_count; r++)
		for (size_t c = 0; c < column_count; c++)
			distances[r * column_count + c] = same && c < r
								  ? distances[c * column_count + r]
								  : esk_query_distance(&rows[r], columns[c], NULL);
}

eskel_status eskel_library_distances(const eskel_library *library, const int64_t *rows, size_t row_count,
	const int64_t *columns, size_t column_count, const eskel_distance_options *options, double *distances)
{
	if (row_count == 0 || column_count == 0)
		return ESKEL_OK;
	const esk_shape **row_shapes = NULL, **column_shapes = NULL;
	esk_query *queries = NULL;
	esk_snapshot snapshot = esk_library_snapshot(library);
	eskel_status status = find(&snapshot, rows, row_count, &row_shapes);
	if (status == ESKEL_OK)
		status = find(&snapshot, columns, column_count, &column_shapes);
	if (status == ESKEL_OK)
		status = make_queries(row_shapes, row_count, options, &queries);
	if (status == ESKEL_OK) {
		bool same = row_count == column_count && memcmp(rows, columns, row_count * sizeof *rows) == 0;
		fill(queries, row_count, column_shapes, column_count, same, distances);
	}
	free_queries(queries, row_count);
	free(row_shapes);
	free(column_shapes);
	esk_directory_release(snapshot.directory);
	return status;
}
