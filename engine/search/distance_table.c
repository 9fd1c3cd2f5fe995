/* Distances of every pair of two lists of a library's shapes, piece by piece.
 *
 * The cells are numbered row by row. A piece is a stretch of them, cut into tiles that threads take; what a cell holds
 * depends on its two shapes alone, so neither pieces nor threads show in the result.
 *
 * When rows and columns are the same list, the lower triangle is the upper one to the last bit (distance.c). Up to
 * MOST_KEPT pairs are kept for it; of a larger table, whose memory is to stay bounded, every pair is computed twice. */
#include "distance.h"
#include "library.h"
#include "memory.h"
#include "team.h"

#include <stdlib.h>
#include <string.h>

enum {
	TILE = 64,           /* cells: half a millisecond, so that threads end together */
	MOST_ROWS = 1024,    /* of one piece: a row that is compared takes 6 kB */
	MOST_KEPT = 1 << 22, /* pairs: 32 MB, 2895 shapes */
};

struct eskel_distance_table {
	esk_snapshot snapshot;
	const esk_shape **rows, **columns;
	size_t row_count, column_count, cell_count;
	size_t next; /* cell */
	eskel_distance_options options;
	uint32_t threads;
	size_t most_kept;
	double *kept; /* of pairs r <= c, row by row; NULL: none are */
};

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

/* Where the pair of r <= c is kept: of n columns, the rows before have n, n - 1 ... of them. */
static size_t place(size_t r, size_t c, size_t n)
{
	return r * (2 * n - r + 1) / 2 + c - r;
}

static eskel_status keep_pairs(eskel_distance_table *table, const int64_t *rows, const int64_t *columns)
{
	const size_t n = table->row_count;
	if (n == 0 || n != table->column_count || n * (n + 1) / 2 > table->most_kept ||
		memcmp(rows, columns, n * sizeof *rows) != 0)
		return ESKEL_OK;
	table->kept = esk_memory_array(n * (n + 1) / 2, sizeof *table->kept);
	return table->kept ? ESKEL_OK : ESKEL_NO_MEMORY;
}

static eskel_status check_options(const eskel_distance_table *table)
{
	esk_query query;
	eskel_status status = esk_query_init(&query, table->rows[0], &table->options);
	if (status == ESKEL_OK)
		esk_query_clear(&query);
	return status;
}

eskel_status eskel_distance_table_new(const eskel_library *library, const int64_t *rows, size_t row_count,
	const int64_t *columns, size_t column_count, const eskel_distance_table_options *options,
	eskel_distance_table **table)
{
	const eskel_distance_table_options chosen = options ? *options : (eskel_distance_table_options){0};
	size_t cell_count;
	if (__builtin_mul_overflow(row_count, column_count, &cell_count))
		return ESKEL_INVALID;
	eskel_distance_table *made = esk_memory_zeroed_array(1, sizeof *made);
	if (!made)
		return ESKEL_NO_MEMORY;
	made->snapshot = esk_library_snapshot(library);
	made->row_count = row_count;
	made->column_count = column_count;
	made->cell_count = cell_count;
	made->options = chosen.distance;
	made->threads = esk_team_threads(chosen.threads);
	made->most_kept = chosen.most_kept ? chosen.most_kept : MOST_KEPT;
	eskel_status status = find(&made->snapshot, rows, row_count, &made->rows);
	if (status == ESKEL_OK)
		status = find(&made->snapshot, columns, column_count, &made->columns);
	if (status == ESKEL_OK && row_count > 0)
		status = check_options(made);
	if (status == ESKEL_OK)
		status = keep_pairs(made, rows, columns);
	if (status == ESKEL_OK)
		*table = made;
	else
		eskel_distance_table_free(made);
	return status;
}

void eskel_distance_table_free(eskel_distance_table *table)
{
	if (!table)
		return;
	esk_directory_release(table->snapshot.directory);
	free(table->rows);
	free(table->columns);
	free(table->kept);
	free(table);
}

/* Cells first .. first + count of the table, and what they are computed from. */
typedef struct {
	const eskel_distance_table *table;
	size_t first, count, first_row, row_count;
	esk_query *queries; /* [row_count] */
	double *distances;
} piece;

/* Without those that have been kept, or will have been when the tiles are done. */
static void compute_tile(void *context, size_t index)
{
	const piece *p = context;
	const eskel_distance_table *table = p->table;
	const size_t end = p->count - index * TILE < TILE ? p->count : (index + 1) * TILE;
	for (size_t i = index * TILE; i < end; i++) {
		const size_t row = (p->first + i) / table->column_count, column = (p->first + i) % table->column_count;
		if (table->kept && column < row)
			continue;
		p->distances[i] = esk_query_distance(&p->queries[row - p->first_row], table->columns[column], NULL);
		if (table->kept)
			table->kept[place(row, column, table->column_count)] = p->distances[i];
	}
}

static void copy_kept(const piece *p)
{
	const size_t n = p->table->column_count;
	for (size_t i = 0; i < p->count; i++) {
		const size_t row = (p->first + i) / n, column = (p->first + i) % n;
		if (column < row)
			p->distances[i] = p->table->kept[place(column, row, n)];
	}
}

static void free_queries(esk_query *queries, size_t count)
{
	for (size_t n = 0; queries && n < count; n++)
		esk_query_clear(&queries[n]);
	free(queries);
}

static eskel_status make_queries(piece *p)
{
	p->queries = esk_memory_zeroed_array(p->row_count, sizeof *p->queries);
	eskel_status status = p->queries ? ESKEL_OK : ESKEL_NO_MEMORY;
	for (size_t n = 0; status == ESKEL_OK && n < p->row_count; n++)
		status = esk_query_init(&p->queries[n], p->table->rows[p->first_row + n], &p->table->options);
	return status;
}

/* The next cells, as many as are asked for and left, but of no more than MOST_ROWS rows. */
static piece next_piece(const eskel_distance_table *table, size_t most, double *distances)
{
	piece p = {.table = table, .first = table->next, .distances = distances};
	p.first_row = p.first / table->column_count;
	size_t end = table->cell_count;
	if (table->row_count - p.first_row > MOST_ROWS)
		end = (p.first_row + MOST_ROWS) * table->column_count;
	p.count = most < end - p.first ? most : end - p.first;
	p.row_count = (p.first + p.count - 1) / table->column_count - p.first_row + 1;
	return p;
}

eskel_status eskel_distance_table_next(eskel_distance_table *table, size_t most, double *distances, size_t *count)
{
	if (table->next == table->cell_count || most == 0) {
		*count = 0;
		return ESKEL_OK;
	}
	piece p = next_piece(table, most, distances);
	const size_t tiles = (p.count + TILE - 1) / TILE;
	eskel_status status = make_queries(&p);
	if (status == ESKEL_OK) {
		esk_team *team = esk_team_new(tiles < table->threads ? (uint32_t)tiles : table->threads);
		esk_team_run(team, tiles, compute_tile, &p);
		esk_team_free(team);
		if (table->kept)
			copy_kept(&p);
		table->next += p.count;
		*count = p.count;
	}
	free_queries(p.queries, p.row_count);
	return status;
}

eskel_status eskel_library_distances(const eskel_library *library, const int64_t *rows, size_t row_count,
	const int64_t *columns, size_t column_count, const eskel_distance_options *options, double *distances)
{
	eskel_distance_table_options all_kept = {.most_kept = SIZE_MAX};
	eskel_distance_table *table = NULL;
	size_t count = 0;
	if (options)
		all_kept.distance = *options;
	eskel_status status =
		eskel_distance_table_new(library, rows, row_count, columns, column_count, &all_kept, &table);
	do {
		if (status == ESKEL_OK)
			status = eskel_distance_table_next(table, SIZE_MAX, distances, &count);
		distances += count;
	} while (status == ESKEL_OK && count > 0);
	eskel_distance_table_free(table);
	return status;
}
