/* Bentley's k-d tree: the centres of a node are halved at the median along the axis in which they spread most, down to
 * leaves of a few. Halves are ranges of one array, so that nothing is stored of a node but where it is split.
 *
 * A search goes down to where the point is and visits on the way back what may hold something nearer. As in Arya and Mount
 * (1993) the distance to a node's half-space wedge is kept up to date axis by axis, which bounds that to its centres;
 * items may come nearer than their centres by their reach. */
#include "nearest.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>

enum { leaf = 8 }; /* centres in a leaf at most */

struct esk_nearest_node {
	double split; /* the first half is not beyond, the second not before */
	uint8_t axis;
};

typedef struct {
	double centre[3];
	uint32_t item;
} entry;

/* The axis along which entries spread most. */
static uint8_t widest_axis(const entry *entries, size_t count)
{
	double least[3], greatest[3];
	for (int a = 0; a < 3; a++)
		least[a] = greatest[a] = entries[0].centre[a];
	for (size_t i = 1; i < count; i++)
		for (int a = 0; a < 3; a++) {
			least[a] = fmin(least[a], entries[i].centre[a]);
			greatest[a] = fmax(greatest[a], entries[i].centre[a]);
		}
	uint8_t widest = 0;
	for (uint8_t a = 1; a < 3; a++)
		if (greatest[a] - least[a] > greatest[widest] - least[widest])
			widest = a;
	return widest;
}

static bool is_before(const entry *a, const entry *b, int axis)
{
	return a->centre[axis] != b->centre[axis] ? a->centre[axis] < b->centre[axis] : a->item < b->item;
}

static void swap(entry *a, entry *b)
{
	const entry kept = *a;
	*a = *b;
	*b = kept;
}

/* Hoare's selection: brings the entry of rank middle to its place, what is less before it, what is greater behind it. */
static void select_middle(entry *entries, size_t count, size_t middle, int axis)
{
	size_t first = 0, last = count - 1;
	while (first < last) {
		const entry pivot = entries[first + (last - first) / 2];
		size_t i = first, j = last;
		for (;;) {
			while (is_before(&entries[i], &pivot, axis))
				i++;
			while (is_before(&pivot, &entries[j], axis))
				j--;
			if (i >= j)
				break;
			swap(&entries[i++], &entries[j--]);
		}
		if (middle <= j)
			last = j;
		else
			first = j + 1;
	}
}

static void build(entry *entries, size_t count, size_t node, struct esk_nearest_node *nodes)
{
	if (count <= leaf)
		return;
	const uint8_t axis = widest_axis(entries, count);
	select_middle(entries, count, count / 2, axis);
	nodes[node] = (struct esk_nearest_node){entries[count / 2].centre[axis], axis};
	build(entries, count / 2, 2 * node + 1, nodes);
	build(entries + count / 2, count - count / 2, 2 * node + 2, nodes);
}

/* Inner nodes and those in between: the second half is the larger one. */
static size_t count_nodes(size_t count)
{
	size_t nodes = 1;
	for (; count > leaf; count -= count / 2)
		nodes = 2 * nodes + 1;
	return nodes;
}

eskel_status esk_nearest_new(const double (*centres)[3], size_t count, esk_nearest **nearest)
{
	esk_nearest *made = esk_memory_zeroed_array(1, sizeof *made);
	entry *entries = esk_memory_array(count, sizeof *entries);
	eskel_status status = ESKEL_NO_MEMORY;
	if (!made || !entries)
		goto end;
	made->count = count;
	made->centres = esk_memory_array(count, sizeof *made->centres);
	made->items = esk_memory_array(count, sizeof *made->items);
	made->nodes = esk_memory_array(count_nodes(count), sizeof *made->nodes);
	if (!made->centres || !made->items || !made->nodes)
		goto end;
	for (size_t i = 0; i < count; i++)
		entries[i] = (entry){{centres[i][0], centres[i][1], centres[i][2]}, (uint32_t)i};
	build(entries, count, 0, made->nodes);
	for (size_t i = 0; i < count; i++) {
		for (int a = 0; a < 3; a++)
			made->centres[i][a] = entries[i].centre[a];
		made->items[i] = entries[i].item;
	}
	*nearest = made;
	made = NULL;
	status = ESKEL_OK;
end:
	free(entries);
	esk_nearest_free(made);
	return status;
}

void esk_nearest_free(esk_nearest *nearest)
{
	if (!nearest)
		return;
	free(nearest->centres);
	free(nearest->items);
	free(nearest->nodes);
	free(nearest);
}

typedef struct {
	const esk_nearest *tree;
	const double *point;
	double reach;
	double (*distance)(const void *context, uint32_t item, const double point[3]);
	const void *context;
	double best;
	size_t place; /* of the best */
} search;

static bool may_hold_nearer(const search *s, double square)
{
	const double bound = s->best + s->reach;
	return square < bound * bound;
}

static void visit_leaf(search *s, size_t first, size_t count)
{
	for (size_t place = first; place < first + count; place++) {
		double square = 0;
		for (int a = 0; a < 3; a++) {
			const double difference = s->point[a] - s->tree->centres[place][a];
			square += difference * difference;
		}
		if (!may_hold_nearer(s, square))
			continue;
		const double distance = s->distance(s->context, s->tree->items[place], s->point);
		if (distance < s->best || (distance == s->best && place < s->place)) {
			s->best = distance;
			s->place = place;
		}
	}
}

/* offsets: how far the point is outside of the node along each axis; square is their sum of squares. */
static void visit(search *s, size_t first, size_t count, size_t node, const double offsets[3])
{
	if (count <= leaf) {
		visit_leaf(s, first, count);
		return;
	}
	const uint8_t axis = s->tree->nodes[node].axis;
	const size_t half = count / 2;
	const double beyond = s->point[axis] - s->tree->nodes[node].split;
	const bool second = beyond > 0;
	double further[3] = {offsets[0], offsets[1], offsets[2]};
	further[axis] = fmax(further[axis], fabs(beyond));
	for (int turn = 0; turn < 2; turn++) {
		const bool upper = second == (turn == 0);
		const double *o = turn == 0 ? offsets : further;
		if (!may_hold_nearer(s, o[0] * o[0] + o[1] * o[1] + o[2] * o[2]))
			return;
		if (upper)
			visit(s, first + half, count - half, 2 * node + 2, o);
		else
			visit(s, first, half, 2 * node + 1, o);
	}
}

double esk_nearest_find(const esk_nearest *nearest, const double point[3], double reach,
	double (*distance)(const void *context, uint32_t item, const double point[3]), const void *context,
	uint32_t *item)
{
	search s = {nearest, point, reach, distance, context, INFINITY, nearest->count};
	visit(&s, 0, nearest->count, 0, (const double[3]){0});
	if (item)
		*item = nearest->items[s.place];
	return s.best;
}
