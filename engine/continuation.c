#include "continuation.h"

#include "error.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	TOGETHER = 64, /* nodes followed together: their neighbours fill the lanes of a field */
	UP = 3 - 1,    /* the slot of direction (1, 1, 0), along the z axis of space */
	/* Between nodes of the columns that a scan looks at, and those columns. Of 2 it costs as much as the rest. */
	SCAN_STRIDE = 4,
};

typedef struct {
	esk_trace *trace;
	const esk_polygonise_options *options;
	size_t most;
	eskel_error *error;
} tracer;

void esk_trace_clear(esk_trace *trace)
{
	esk_lattice_clear(&trace->lattice);
	free(trace->actives);
	trace->actives = NULL;
	trace->count = trace->capacity = 0;
}

static eskel_status no_memory(const tracer *t)
{
	return esk_error_set(t->error, ESKEL_NO_MEMORY, "memory ran out for a surface of %zu nodes", t->trace->count);
}

/* The surface is at most an edge from an active node. */
static bool leaves_box(const tracer *t, const int32_t at[3])
{
	double position[3];
	esk_lattice_position(&t->trace->lattice, at, position);
	const double slack = 2 * t->trace->lattice.step_half;
	bool leaves = false;
	for (int a = 0; a < 3; a++)
		leaves |= position[a] < t->options->least[a] - slack || position[a] > t->options->greatest[a] + slack;
	return leaves;
}

static eskel_status activate(const tracer *t, uint32_t node)
{
	esk_trace *trace = t->trace;
	uint32_t *active = &trace->lattice.active[node];
	if (*active != ESK_NO_NODE)
		return ESKEL_OK;
	if (leaves_box(t, trace->lattice.nodes[node].at))
		return esk_error_set(t->error, ESKEL_TOO_LARGE, "the surface leaves its box");
	if (trace->count >= t->most)
		return ESKEL_TOO_LARGE;
	void *actives = trace->actives;
	if (!esk_memory_reserve(&actives, &trace->capacity, trace->count + 1, sizeof *trace->actives))
		return no_memory(t);
	trace->actives = actives;
	*active = (uint32_t)trace->count;
	trace->actives[trace->count++].node = node;
	return ESKEL_OK;
}

static eskel_status activate_both(const tracer *t, uint32_t a, uint32_t b)
{
	if (esk_trace_inside(t->trace, a) == esk_trace_inside(t->trace, b))
		return ESKEL_OK;
	eskel_status status = activate(t, a);
	return status == ESKEL_OK ? activate(t, b) : status;
}

/* Activates the neighbours of the other sign. */
static eskel_status follow_cuts(const tracer *t, size_t n)
{
	const double *values = t->trace->lattice.values;
	uint32_t neighbours[ESK_NEIGHBOURS];
	memcpy(neighbours, t->trace->actives[n].neighbours, sizeof neighbours);
	const bool inside = values[t->trace->actives[n].node] < 0;
	unsigned cut = 0;
	for (int s = 0; s < ESK_NEIGHBOURS; s++)
		cut |= ((values[neighbours[s]] < 0) != inside ? 1u : 0) << s;
	t->trace->actives[n].cut = (uint16_t)cut;
	eskel_status status = ESKEL_OK;
	for (; cut && status == ESKEL_OK; cut &= cut - 1)
		status = activate(t, neighbours[__builtin_ctz(cut)]);
	return status;
}

/* The last of those that are waiting first, so that what lies together in space does so in memory; many at once, so that
 * values are computed many at once. */
static eskel_status follow_some(const tracer *t, const uint32_t *waiting, size_t count)
{
	esk_trace *trace = t->trace;
	for (size_t w = 0; w < count; w++) {
		esk_active *active = &trace->actives[waiting[w]];
		if (!esk_lattice_neighbours(&trace->lattice, active->node, active->neighbours))
			return no_memory(t);
		memset(active->vertices, 0xff, sizeof active->vertices); /* ESK_NO_NODE */
	}
	if (!esk_lattice_evaluate(&trace->lattice))
		return no_memory(t);
	eskel_status status = ESKEL_OK;
	for (size_t w = 0; w < count && status == ESKEL_OK; w++)
		status = follow_cuts(t, waiting[w]);
	return status;
}

/* Follows the surface from all active nodes. */
static eskel_status follow(const tracer *t)
{
	uint32_t *waiting = NULL, some[TOGETHER];
	size_t capacity = 0, count = 0, listed = 0; /* actives that have been waiting */
	eskel_status status = ESKEL_OK;
	while (status == ESKEL_OK && (count > 0 || listed < t->trace->count)) {
		void *items = waiting;
		if (!esk_memory_reserve(&items, &capacity, count + t->trace->count - listed, sizeof *waiting)) {
			status = no_memory(t);
			break;
		}
		waiting = items;
		while (listed < t->trace->count)
			waiting[count++] = (uint32_t)listed++;
		const size_t taken = count < TOGETHER ? count : TOGETHER;
		count -= taken;
		memcpy(some, waiting + count, taken * sizeof *some);
		status = follow_some(t, some, taken);
	}
	free(waiting);
	return status;
}

static void move(int32_t at[3], int slot, int32_t by)
{
	const int mask = slot % ESK_DIRECTIONS + 1;
	for (int a = 0; a < 3; a++)
		at[a] += (mask >> a & 1) * by;
}

/* The nodes from at up, stride apart, evaluated. */
static eskel_status make_column(const tracer *t, const int32_t at[3], int32_t count, int32_t stride, uint32_t *nodes)
{
	int32_t next[3] = {at[0], at[1], at[2]};
	for (int32_t n = 0; n < count; n++) {
		if (!esk_lattice_node(&t->trace->lattice, next, &nodes[n]))
			return no_memory(t);
		move(next, UP, stride);
	}
	return esk_lattice_evaluate(&t->trace->lattice) ? ESKEL_OK : no_memory(t);
}

/* Meets the surface along a column of nodes, between nodes of a coarse column that differ. */
static eskel_status meet_between(const tracer *t, uint32_t lower, uint32_t upper, int32_t stride)
{
	if (esk_trace_inside(t->trace, lower) == esk_trace_inside(t->trace, upper))
		return ESKEL_OK;
	uint32_t nodes[SCAN_STRIDE + 1];
	const int32_t *found = t->trace->lattice.nodes[lower].at, at[3] = {found[0], found[1], found[2]};
	eskel_status status = make_column(t, at, stride + 1, 1, nodes);
	for (int32_t n = 0; n < stride && status == ESKEL_OK; n++)
		status = activate_both(t, nodes[n], nodes[n + 1]);
	return status;
}

/* Meets it along the whole column that at lies in, from below the box to above it; nodes has room for the column. */
static eskel_status meet_column(const tracer *t, const int32_t at[3], int32_t stride, uint32_t *nodes)
{
	const esk_lattice *lattice = &t->trace->lattice;
	const double step = 2 * lattice->step_half * stride;
	double position[3];
	esk_lattice_position(lattice, at, position);
	const int32_t down = (int32_t)ceil((position[2] - t->options->least[2]) / step) + 1;
	const int32_t up = (int32_t)ceil((t->options->greatest[2] - position[2]) / step) + 1;
	int32_t lowest[3] = {at[0], at[1], at[2]};
	move(lowest, UP, -down * stride);
	eskel_status status = make_column(t, lowest, down + up + 1, stride, nodes);
	for (int32_t n = 0; n < down + up && status == ESKEL_OK; n++)
		status = meet_between(t, nodes[n], nodes[n + 1], stride);
	return status;
}

static eskel_status meet_seed(const tracer *t, const double seed[3], uint32_t *nodes)
{
	esk_lattice *lattice = &t->trace->lattice;
	int32_t at[3];
	uint32_t node, neighbours[ESK_NEIGHBOURS];
	for (int a = 0; a < 3; a++)
		if (!(seed[a] >= t->options->least[a] && seed[a] <= t->options->greatest[a]))
			return esk_error_set(t->error, ESKEL_INVALID, "a seed lies at %g, expected %g to %g", seed[a],
				t->options->least[a], t->options->greatest[a]);
	esk_lattice_nearest(lattice, seed, at);
	if (!esk_lattice_node(lattice, at, &node) || !esk_lattice_neighbours(lattice, node, neighbours) ||
		!esk_lattice_evaluate(lattice))
		return no_memory(t);
	eskel_status status = ESKEL_OK;
	for (int s = 0; s < ESK_NEIGHBOURS && status == ESKEL_OK; s++)
		status = activate_both(t, node, neighbours[s]);
	return status == ESKEL_OK ? meet_column(t, at, 1, nodes) : status;
}

static int compare_points(const void *a, const void *b)
{
	const double *p = a, *q = b;
	for (int i = 0; i < 3; i++)
		if (p[i] != q[i])
			return p[i] < q[i] ? -1 : 1;
	return 0;
}

/* Followed in the order of space, the surface is numbered the same whatever order the seeds come in. */
static eskel_status follow_seeds(const tracer *t, uint32_t *nodes)
{
	const size_t count = t->options->seed_count;
	double(*seeds)[3] = esk_memory_array(count, sizeof *seeds);
	if (!seeds)
		return no_memory(t);
	if (count)
		memcpy(seeds, t->options->seeds, count * sizeof *seeds);
	qsort(seeds, count, sizeof *seeds, compare_points);
	eskel_status status = ESKEL_OK;
	for (size_t s = 0; s < count && status == ESKEL_OK; s++)
		status = meet_seed(t, (const double *)seeds[s], nodes);
	free(seeds);
	return status;
}

static eskel_status scan_box(const tracer *t, uint32_t *nodes)
{
	const esk_polygonise_options *o = t->options;
	const double step = 2 * t->trace->lattice.step_half * SCAN_STRIDE;
	eskel_status status = ESKEL_OK;
	for (double y = o->least[1] + step / 2; y < o->greatest[1] && status == ESKEL_OK; y += step)
		for (double x = o->least[0] + step / 2; x < o->greatest[0] && status == ESKEL_OK; x += step) {
			int32_t at[3];
			esk_lattice_nearest(&t->trace->lattice, (const double[3]){x, y, o->least[2]}, at);
			status = meet_column(t, at, SCAN_STRIDE, nodes);
		}
	return status;
}

eskel_status esk_trace_surface(esk_trace *trace, const esk_polygonise_options *options, size_t most, eskel_error *error)
{
	const tracer t = {trace, options, most, error};
	const double height = options->greatest[2] - options->least[2];
	uint32_t *nodes = esk_memory_array((size_t)(height / (2 * trace->lattice.step_half)) + 8, sizeof *nodes);
	if (!nodes)
		return no_memory(&t);
	eskel_status status = follow_seeds(&t, nodes);
	if (status == ESKEL_OK && options->scan)
		status = scan_box(&t, nodes);
	if (status == ESKEL_OK)
		status = follow(&t);
	if (status == ESKEL_OK && trace->count == 0)
		status = esk_error_set(error, ESKEL_EMPTY, "no surface was met from %zu seeds", options->seed_count);
	free(nodes);
	return status;
}
