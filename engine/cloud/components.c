/* How many pieces a cloud is in, and how many holes it has inside: connected components of its runs.
 *
 * The nodes of a union-find forest are runs, so voxels are never looked at one by one. Runs are sorted by (z, y, x); moved
 * to a neighbouring row they still are, so one walk through both finds all that touch: a cursor never goes back but to the
 * last run that it touched. The object is joined over faces, edges and corners (26 neighbours), the background over faces
 * (6), its dual: a surface of the object that is closed in this sense keeps inside and outside apart.
 *
 * A cavity lies between two runs of each of its rows, so only such gaps are nodes, fewer than there are runs. What lies
 * before the first or after the last run of a row reaches the border, and so does a row without runs: a gap is open when
 * something of it lies beside neither runs nor gaps of a neighbouring row, and a cavity is a component without an open gap. */
#include "eskel.h"
#include "memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
	size_t count;
	const eskel_run *runs;
	uint32_t *parents; /* at most the node itself: the least node of a tree is its root */
} forest;

static eskel_status plant(const eskel_run *runs, size_t count, forest *f)
{
	*f = (forest){count, runs, esk_memory_array(count, sizeof *f->parents)};
	if (!f->parents)
		return ESKEL_NO_MEMORY;
	for (size_t i = 0; i < count; i++)
		f->parents[i] = (uint32_t)i;
	return ESKEL_OK;
}

/* Halves the way to the root for the next who goes it. */
static uint32_t root_of(forest *f, uint32_t node)
{
	while (f->parents[node] != node) {
		f->parents[node] = f->parents[f->parents[node]];
		node = f->parents[node];
	}
	return node;
}

static void join(forest *f, uint32_t a, uint32_t b)
{
	a = root_of(f, a);
	b = root_of(f, b);
	if (a < b)
		f->parents[b] = a;
	else
		f->parents[a] = b;
}

/* Rows in the order of the runs, also those next to the grid (y of -1 or 2^16). */
static int64_t row_of(const eskel_run *run, int dy, int dz)
{
	return ((int64_t)run->z + dz) * (1 << 18) + run->y + dy;
}

/* Joins what touches in rows that are (dy, dz) apart, along x also what is at most reach apart. */
static void join_rows(forest *f, int dy, int dz, int reach)
{
	size_t cursor = 0;
	for (size_t i = 0; i < f->count; i++) {
		const eskel_run *run = &f->runs[i];
		const int64_t row = row_of(run, dy, dz);
		while (cursor < f->count && (row_of(&f->runs[cursor], 0, 0) < row ||
						    (row_of(&f->runs[cursor], 0, 0) == row &&
							    f->runs[cursor].x_last + reach < run->x_first)))
			cursor++;
		for (size_t j = cursor;
			j < f->count && row_of(&f->runs[j], 0, 0) == row && f->runs[j].x_first <= run->x_last + reach;
			j++)
			join(f, (uint32_t)i, (uint32_t)j);
	}
}

static int compare_descending(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x < y) - (x > y);
}

/* The voxels of each tree without an open node (open: a flag a node, or NULL). */
static eskel_status measure(forest *f, bool *open, eskel_components **components)
{
	eskel_components *made = calloc(1, sizeof *made);
	uint64_t *sizes = esk_memory_zeroed_array(f->count, sizeof *sizes);
	if (!made || !sizes) {
		free(made);
		free(sizes);
		return ESKEL_NO_MEMORY;
	}
	for (size_t i = 0; i < f->count; i++) {
		const uint32_t root = root_of(f, (uint32_t)i);
		sizes[root] += (uint64_t)f->runs[i].x_last - f->runs[i].x_first + 1;
		if (open && open[i])
			open[root] = true;
	}
	for (size_t i = 0; i < f->count; i++) {
		const uint64_t size = open && open[i] ? 0 : sizes[i];
		made->voxels += size;
		if (size > 0)
			sizes[made->count++] = size;
	}
	qsort(sizes, made->count, sizeof *sizes, compare_descending);
	made->sizes = sizes;
	*components = made;
	return ESKEL_OK;
}

eskel_status eskel_cloud_components(const eskel_cloud *cloud, eskel_components **components)
{
	forest f;
	eskel_status status = plant(cloud->runs, cloud->run_count, &f);
	if (status != ESKEL_OK)
		return status;
	join_rows(&f, 0, 0, 1); /* runs of different weights may touch in a row */
	join_rows(&f, -1, 0, 1);
	for (int dy = -1; dy <= 1; dy++)
		join_rows(&f, dy, -1, 1);
	status = measure(&f, NULL, components);
	free(f.parents);
	return status;
}

/* What lies between the runs of a row, and the span of each row from its first run to its last. */
typedef struct {
	size_t gap_count, span_count;
	eskel_run *gaps, *spans;
	bool *open; /* a flag a gap */
} background;

static void clear_background(background *b)
{
	free(b->gaps);
	free(b->spans);
	free(b->open);
}

static eskel_status find_background(const eskel_cloud *cloud, background *b)
{
	b->gaps = esk_memory_array(cloud->run_count, sizeof *b->gaps);
	b->spans = esk_memory_array(cloud->run_count, sizeof *b->spans);
	b->open = esk_memory_zeroed_array(cloud->run_count, sizeof *b->open);
	if (!b->gaps || !b->spans || !b->open)
		return ESKEL_NO_MEMORY;
	for (size_t i = 0; i < cloud->run_count; i++) {
		const eskel_run *run = &cloud->runs[i];
		eskel_run *span = &b->spans[b->span_count];
		if (b->span_count == 0 || row_of(span - 1, 0, 0) != row_of(run, 0, 0)) {
			*span = *run;
			b->span_count++;
			continue;
		}
		span--;
		if (run->x_first > span->x_last + 1)
			b->gaps[b->gap_count++] =
				(eskel_run){(uint16_t)(span->x_last + 1), (uint16_t)(run->x_first - 1), run->y, run->z};
		span->x_last = run->x_last;
	}
	return ESKEL_OK;
}

/* Opens the gaps that the span of the row at (dy, dz) from theirs does not cover. */
static void open_gaps(background *b, int dy, int dz)
{
	size_t cursor = 0;
	for (size_t i = 0; i < b->gap_count; i++) {
		const eskel_run *gap = &b->gaps[i];
		const int64_t row = row_of(gap, dy, dz);
		while (cursor < b->span_count && row_of(&b->spans[cursor], 0, 0) < row)
			cursor++;
		const eskel_run *span = &b->spans[cursor];
		if (cursor == b->span_count || row_of(span, 0, 0) != row || gap->x_first < span->x_first ||
			gap->x_last > span->x_last)
			b->open[i] = true;
	}
}

eskel_status eskel_cloud_cavities(const eskel_cloud *cloud, eskel_components **cavities)
{
	background b = {0};
	forest f = {0};
	eskel_status status = find_background(cloud, &b);
	if (status == ESKEL_OK)
		status = plant(b.gaps, b.gap_count, &f);
	if (status == ESKEL_OK) {
		join_rows(&f, -1, 0, 0);
		join_rows(&f, 0, -1, 0);
		for (int step = -1; step <= 1; step += 2) {
			open_gaps(&b, step, 0);
			open_gaps(&b, 0, step);
		}
		status = measure(&f, b.open, cavities);
	}
	free(f.parents);
	clear_background(&b);
	return status;
}

void eskel_components_free(eskel_components *components)
{
	if (!components)
		return;
	free(components->sizes);
	free(components);
}
