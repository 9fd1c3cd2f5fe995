#include "coarse.h"

#include "memory.h"

#include <stdlib.h>
#include <string.h>

/* Along one axis voxel x lies in cell (x + pad) / 3. The number of cells has the parity of the extent, so that equal
 * pads fit on both sides. */
typedef struct {
	int cells, pad;
} axis;

typedef struct {
	axis axes[3];
	uint64_t *row; /* [axes[0].cells] weights of one row of cells, zero outside first..last */
	int first, last;
	esk_segment *segments;
	size_t count, capacity;
} grid;

static axis axis_of(int extent)
{
	int cells = (extent + 2) / 3;
	cells += (3 * cells - extent) % 2;
	return (axis){.cells = cells, .pad = (3 * cells - extent) / 2};
}

static int cell(const grid *g, int r, int x)
{
	return (x + g->axes[r].pad) / 3;
}

static void add_run(grid *g, const eskel_run *run, uint64_t weight)
{
	int first = cell(g, 0, run->x_first), last = cell(g, 0, run->x_last);
	for (int i = first; i <= last; i++) {
		int low = 3 * i - g->axes[0].pad, high = low + 2;
		int x_first = run->x_first > low ? run->x_first : low, x_last = run->x_last < high ? run->x_last : high;
		g->row[i] += weight * (uint64_t)(x_last - x_first + 1);
	}
	g->first = first < g->first ? first : g->first;
	g->last = last > g->last ? last : g->last;
}

/* Writes the row of cells as segments of equal weight, and empties it. */
static bool flush_row(grid *g, int y, int z)
{
	for (int i = g->first; i <= g->last;) {
		int end = i;
		while (end < g->last && g->row[end + 1] == g->row[i])
			end++;
		if (g->row[i]) {
			if (!esk_memory_reserve((void **)&g->segments, &g->capacity, g->count + 1, sizeof *g->segments))
				return false;
			g->segments[g->count++] = (esk_segment){
				.x_first = 2 * i - (g->axes[0].cells - 1),
				.x_last = 2 * end - (g->axes[0].cells - 1),
				.y = 2 * y - (g->axes[1].cells - 1),
				.z = 2 * z - (g->axes[2].cells - 1),
				.weight = g->row[i],
			};
		}
		i = end + 1;
	}
	if (g->first <= g->last)
		memset(g->row + g->first, 0, (size_t)(g->last - g->first + 1) * sizeof *g->row);
	g->first = g->axes[0].cells;
	g->last = -1;
	return true;
}

/* Runs are sorted by (z, y): each of a layer's three slices is a stretch of runs ordered by y, and the three are
 * merged row by row. */
static bool add_layer(grid *g, const eskel_cloud *cloud, size_t begin, size_t end)
{
	size_t next[3] = {end, end, end}, stop[3] = {end, end, end};
	int slices = 0;
	for (size_t i = begin; i < end; i++)
		if (i == begin || cloud->runs[i].z != cloud->runs[i - 1].z) {
			if (slices)
				stop[slices - 1] = i;
			next[slices++] = i;
		}
	const int z = cell(g, 2, cloud->runs[begin].z);
	for (;;) {
		int y = g->axes[1].cells;
		for (int s = 0; s < slices; s++)
			if (next[s] < stop[s] && cell(g, 1, cloud->runs[next[s]].y) < y)
				y = cell(g, 1, cloud->runs[next[s]].y);
		if (y == g->axes[1].cells)
			return true;
		for (int s = 0; s < slices; s++)
			for (; next[s] < stop[s] && cell(g, 1, cloud->runs[next[s]].y) == y; next[s]++)
				add_run(g, &cloud->runs[next[s]], cloud->weights ? cloud->weights[next[s]] : 1);
		if (!flush_row(g, y, z))
			return false;
	}
}

eskel_status esk_coarse_segments(const eskel_cloud *cloud, esk_segment **segments, size_t *segment_count)
{
	grid g = {.axes = {axis_of(cloud->extent[0]), axis_of(cloud->extent[1]), axis_of(cloud->extent[2])}};
	g.row = esk_memory_zeroed_array((size_t)g.axes[0].cells, sizeof *g.row);
	g.first = g.axes[0].cells;
	g.last = -1;
	bool ok = g.row != NULL;
	for (size_t begin = 0, end; ok && begin < cloud->run_count; begin = end) {
		const int z = cell(&g, 2, cloud->runs[begin].z);
		for (end = begin + 1; end < cloud->run_count && cell(&g, 2, cloud->runs[end].z) == z;)
			end++;
		ok = add_layer(&g, cloud, begin, end);
	}
	free(g.row);
	if (!ok) {
		free(g.segments);
		return ESKEL_NO_MEMORY;
	}
	*segments = g.segments;
	*segment_count = g.count;
	return ESKEL_OK;
}
