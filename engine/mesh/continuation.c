#include "continuation.h"

#include "error.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	TOGETHER = 64, /* blocks followed together: their nodes fill the lanes of a field */
	UP = 3 - 1,    /* the slot of direction (1, 1, 0), along the z axis of space */
	/* Between nodes of the columns that a scan looks at, and those columns. Of 2 it costs as much as the rest. */
	SCAN_STRIDE = 4,
};

typedef struct {
	esk_trace *trace;
	const esk_polygonise_options *options;
	size_t most;
	eskel_error *error;
	uint32_t *waiting; /* blocks with active nodes that are not followed, in the order in which they got these */
	size_t waiting_count, waiting_capacity;
} tracer;

static eskel_status no_memory(const tracer *t)
{
	return esk_error_set(t->error, ESKEL_NO_MEMORY, "memory ran out for a surface of %zu nodes", t->trace->count);
}

/* Whether all nodes of a block are within the box, with a slack around it. */
static bool is_within_box(const tracer *t, uint32_t block, double slack)
{
	const esk_lattice *l = &t->trace->lattice;
	double first[3];
	bool within = true;
	esk_lattice_position(l, l->blocks[block].at, first);
	/* At 0 to 3 along each axis of the lattice, they are from -3 to 6 times step_half away from the first. */
	for (int a = 0; a < 3; a++)
		within &= first[a] - 3 * l->step_half >= t->options->least[a] - slack &&
			  first[a] + 6 * l->step_half <= t->options->greatest[a] + slack;
	return within;
}

/* The surface is at most an edge from an active node. */
static bool leaves_box(const tracer *t, uint32_t block, uint64_t nodes)
{
	const esk_lattice *l = &t->trace->lattice;
	const double slack = 2 * l->step_half;
	bool leaves = false;
	if (is_within_box(t, block, slack))
		return false;
	for (; nodes; nodes &= nodes - 1) {
		int32_t at[3];
		double position[3];
		esk_lattice_at(l, block << ESK_PLACE_BITS | (uint32_t)__builtin_ctzll(nodes), at);
		esk_lattice_position(l, at, position);
		for (int a = 0; a < 3; a++)
			leaves |= position[a] < t->options->least[a] - slack ||
				  position[a] > t->options->greatest[a] + slack;
	}
	return leaves;
}

static eskel_status activate(tracer *t, uint32_t block, uint64_t nodes)
{
	uint64_t *words = t->trace->lattice.blocks[block].words;
	nodes &= ~words[ESK_ACTIVE];
	if (!nodes)
		return ESKEL_OK;
	t->trace->count += (size_t)__builtin_popcountll(nodes);
	if (t->trace->count > t->most)
		return ESKEL_TOO_LARGE;
	if (words[ESK_ACTIVE] == words[ESK_FOLLOWED]) {
		void *waiting = t->waiting;
		if (!esk_memory_reserve(&waiting, &t->waiting_capacity, t->waiting_count + 1, sizeof *t->waiting))
			return no_memory(t);
		t->waiting = waiting;
		t->waiting[t->waiting_count++] = block;
	}
	words[ESK_ACTIVE] |= nodes;
	return ESKEL_OK;
}

static eskel_status activate_both(tracer *t, uint32_t a, uint32_t b)
{
	const esk_lattice *l = &t->trace->lattice;
	if (esk_lattice_has(l, a, ESK_INSIDE) == esk_lattice_has(l, b, ESK_INSIDE))
		return ESKEL_OK;
	eskel_status status = activate(t, a >> ESK_PLACE_BITS, esk_lattice_bit(a));
	return status == ESKEL_OK ? activate(t, b >> ESK_PLACE_BITS, esk_lattice_bit(b)) : status;
}

/* Activates the neighbours of the other sign in the same block. */
static eskel_status follow_cuts_within(tracer *t, uint32_t b)
{
	const uint64_t *words = t->trace->lattice.blocks[b].words;
	const uint64_t active = words[ESK_ACTIVE], inside = words[ESK_INSIDE], outside = words[ESK_KNOWN] & ~inside;
	return activate(
		t, b, (esk_word_spread(active & inside) & outside) | (esk_word_spread(active & outside) & inside));
}

/* Follows the surface within each of some blocks, as far as it goes there. */
static eskel_status follow_within(tracer *t, const uint32_t *some, size_t count)
{
	esk_lattice *l = &t->trace->lattice;
	uint64_t asked[TOGETHER] = {0}; /* nodes whose neighbours in the block are */
	size_t open[TOGETHER], left = count;
	for (size_t i = 0; i < count; i++)
		open[i] = i;
	while (left > 0) {
		size_t kept = 0;
		for (size_t n = 0; n < left; n++) {
			const size_t i = open[n];
			const uint64_t active = l->blocks[some[i]].words[ESK_ACTIVE];
			if (active == asked[i])
				continue;
			asked[i] = active;
			open[kept++] = i;
			if (!esk_lattice_ask(l, some[i], esk_word_spread(active)))
				return no_memory(t);
		}
		left = kept;
		esk_lattice_evaluate(l);
		for (size_t n = 0; n < left; n++) {
			const eskel_status status = follow_cuts_within(t, some[open[n]]);
			if (status != ESKEL_OK)
				return status;
		}
	}
	return ESKEL_OK;
}

/* Nodes of a block that are followed, and by slot what they reach: from those inside, and from those outside. */
typedef struct {
	uint32_t block;
	uint64_t from_inside[ESK_AROUND], from_outside[ESK_AROUND];
} reach;

/* The nodes of a block that are active and not followed; their neighbours are asked for. */
static eskel_status ask_around(tracer *t, uint32_t b, reach *r)
{
	esk_lattice *l = &t->trace->lattice;
	uint64_t *words = l->blocks[b].words, reached[ESK_AROUND];
	const uint64_t fresh = words[ESK_ACTIVE] & ~words[ESK_FOLLOWED];
	words[ESK_FOLLOWED] = words[ESK_ACTIVE];
	if (leaves_box(t, b, fresh))
		return esk_error_set(t->error, ESKEL_TOO_LARGE, "the surface leaves its box");
	r->block = b;
	esk_words_spread(fresh & words[ESK_INSIDE], r->from_inside);
	esk_words_spread(fresh & ~words[ESK_INSIDE], r->from_outside);
	for (int s = 0; s < ESK_AROUND; s++)
		reached[s] = r->from_inside[s] | r->from_outside[s];
	return esk_lattice_ask_around(l, b, reached) ? ESKEL_OK : no_memory(t);
}

/* Activates the neighbours of the other sign. */
static eskel_status follow_cuts(tracer *t, const reach *r)
{
	const esk_lattice *l = &t->trace->lattice;
	eskel_status status = ESKEL_OK;
	for (int s = 0; s < ESK_AROUND && status == ESKEL_OK; s++) {
		if (!(r->from_inside[s] | r->from_outside[s]))
			continue;
		const uint32_t other = l->blocks[r->block].around[s];
		const uint64_t inside = l->blocks[other].words[ESK_INSIDE];
		status = activate(t, other, (r->from_inside[s] & ~inside) | (r->from_outside[s] & inside));
	}
	return status;
}

static eskel_status follow_some(tracer *t, const uint32_t *some, size_t count)
{
	reach reaches[TOGETHER];
	eskel_status status = follow_within(t, some, count);
	for (size_t i = 0; i < count && status == ESKEL_OK; i++)
		status = ask_around(t, some[i], &reaches[i]);
	if (status != ESKEL_OK)
		return status;
	esk_lattice_evaluate(&t->trace->lattice);
	for (size_t i = 0; i < count && status == ESKEL_OK; i++)
		status = follow_cuts(t, &reaches[i]);
	return status;
}

/* Follows the surface from all active nodes. Blocks wait in turn, so that more nodes of each have come together. */
static eskel_status follow(tracer *t)
{
	uint32_t some[TOGETHER];
	eskel_status status = ESKEL_OK;
	for (size_t done = 0; done < t->waiting_count && status == ESKEL_OK;) {
		const size_t rest = t->waiting_count - done, count = rest < TOGETHER ? rest : TOGETHER;
		memcpy(some, t->waiting + done, count * sizeof *some);
		done += count;
		status = follow_some(t, some, count);
	}
	return status;
}

static void move(int32_t at[3], int slot, int32_t by)
{
	const int mask = slot % ESK_DIRECTIONS + 1;
	for (int a = 0; a < 3; a++)
		at[a] += (mask >> a & 1) * by;
}

/* The nodes from at up, stride apart, evaluated. */
static eskel_status make_column(tracer *t, const int32_t at[3], int32_t count, int32_t stride, uint32_t *nodes)
{
	int32_t next[3] = {at[0], at[1], at[2]};
	for (int32_t n = 0; n < count; n++) {
		if (!esk_lattice_node(&t->trace->lattice, next, &nodes[n]))
			return no_memory(t);
		move(next, UP, stride);
	}
	esk_lattice_evaluate(&t->trace->lattice);
	return ESKEL_OK;
}

/* Meets the surface along a column of nodes, between nodes of a coarse column that differ. */
static eskel_status meet_between(tracer *t, uint32_t lower, uint32_t upper, int32_t stride)
{
	const esk_lattice *l = &t->trace->lattice;
	uint32_t nodes[SCAN_STRIDE + 1];
	int32_t at[3];
	if (esk_lattice_has(l, lower, ESK_INSIDE) == esk_lattice_has(l, upper, ESK_INSIDE))
		return ESKEL_OK;
	esk_lattice_at(l, lower, at);
	eskel_status status = make_column(t, at, stride + 1, 1, nodes);
	for (int32_t n = 0; n < stride && status == ESKEL_OK; n++)
		status = activate_both(t, nodes[n], nodes[n + 1]);
	return status;
}

/* Meets it along the whole column that at lies in, from below the box to above it; nodes has room for the column. */
static eskel_status meet_column(tracer *t, const int32_t at[3], int32_t stride, uint32_t *nodes)
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

static eskel_status meet_seed(tracer *t, const double seed[3], uint32_t *nodes)
{
	esk_lattice *lattice = &t->trace->lattice;
	int32_t at[3];
	uint32_t node;
	for (int a = 0; a < 3; a++)
		if (!(seed[a] >= t->options->least[a] && seed[a] <= t->options->greatest[a]))
			return esk_error_set(t->error, ESKEL_INVALID, "a seed lies at %g, expected %g to %g", seed[a],
				t->options->least[a], t->options->greatest[a]);
	esk_lattice_nearest(lattice, seed, at);
	uint64_t reached[ESK_AROUND];
	if (!esk_lattice_node(lattice, at, &node))
		return no_memory(t);
	esk_words_spread(esk_lattice_bit(node), reached);
	if (!esk_lattice_ask_around(lattice, node >> ESK_PLACE_BITS, reached))
		return no_memory(t);
	esk_lattice_evaluate(lattice);
	eskel_status status = ESKEL_OK;
	for (int s = 0; s < ESK_NEIGHBOURS && status == ESKEL_OK; s++)
		status = activate_both(t, node, esk_lattice_next(lattice, node, s));
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
static eskel_status follow_seeds(tracer *t, uint32_t *nodes)
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

static eskel_status scan_box(tracer *t, uint32_t *nodes)
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
	tracer t = {.trace = trace, .options = options, .most = most, .error = error};
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
	free(t.waiting);
	free(nodes);
	return status;
}
