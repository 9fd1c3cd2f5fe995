/* Lists of weighted runs.
 *
 * They are sorted by the bytes of their positions, the lowest first (radix sort): a pass over the list for each byte that
 * differs, most often three.
 *
 * Changing the run axis does not go through voxels. Seen along y, a run begins at (x, y) where row y has a weight at x
 * that row y - 1 has not, and ends where row y + 1 has not. So the beginnings are the interval difference of each row
 * and the row before it, the ends that of each row and the row after it, and along one y column they alternate: sorted,
 * the n-th beginning belongs to the n-th end. The cost is in proportion to the runs that go in and come out.
 */
#include "spans.h"

#include "error.h"
#include "memory.h"

#include <stdlib.h>

/* A run list of 1.5 GB: beyond every real object (a 1000^3 block has 10^6 runs), it bounds what a thin plate of long
 * runs can grow to when its run axis changes. */
static const size_t most_spans = (size_t)1 << 27;

void esk_spans_free(esk_spans *spans)
{
	free(spans->items);
	*spans = (esk_spans){0};
}

eskel_status esk_spans_add(esk_spans *spans, esk_span span, eskel_error *error)
{
	if (spans->count == most_spans)
		return esk_error_set(error, ESKEL_TOO_LARGE, "the object needs more than %zu runs", most_spans);
	void *items = spans->items;
	if (!esk_memory_reserve(&items, &spans->capacity, spans->count + 1, sizeof span))
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out after %zu runs", spans->count);
	spans->items = items;
	spans->items[spans->count++] = span;
	return ESKEL_OK;
}

static uint64_t position(const esk_span *s)
{
	return (uint64_t)s->z << 32 | (uint64_t)s->y << 16 | s->x_first;
}

/* Decoders deliver runs in order, so most lists are sorted already. */
static bool is_sorted(const esk_spans *spans)
{
	for (size_t i = 1; i < spans->count; i++)
		if (position(&spans->items[i - 1]) > position(&spans->items[i]))
			return false;
	return true;
}

/* Positions have six bytes, of which the lowest is digit 0. */
enum { digits = 6, digit_values = 256 };

static unsigned digit_of(const esk_span *s, unsigned digit)
{
	return position(s) >> 8 * digit & (digit_values - 1);
}

static void count_digits(const esk_spans *spans, uint32_t counts[digits][digit_values])
{
	for (size_t i = 0; i < spans->count; i++)
		for (unsigned d = 0; d < digits; d++)
			counts[d][digit_of(&spans->items[i], d)]++;
}

/* Orders spans by a digit; those that share it keep their order. */
static void distribute(
	const esk_span *from, esk_span *to, size_t count, unsigned digit, const uint32_t counts[digit_values])
{
	uint32_t places[digit_values];
	uint32_t before = 0;
	for (unsigned v = 0; v < digit_values; v++) {
		places[v] = before;
		before += counts[v];
	}
	for (size_t i = 0; i < count; i++)
		to[places[digit_of(&from[i], digit)]++] = from[i];
}

eskel_status esk_spans_sort(esk_spans *spans, eskel_error *error)
{
	if (is_sorted(spans))
		return ESKEL_OK;
	esk_span *from = spans->items, *to = esk_memory_array(spans->count, sizeof *to);
	if (!to)
		return esk_error_set(error, ESKEL_NO_MEMORY, "memory ran out for %zu runs", spans->count);
	uint32_t counts[digits][digit_values] = {{0}};
	count_digits(spans, counts);
	for (unsigned d = 0; d < digits; d++) {
		if (counts[d][digit_of(from, d)] == spans->count)
			continue; /* all share it: the high bytes of small grids */
		distribute(from, to, spans->count, d, counts[d]);
		esk_span *ordered = to;
		to = from;
		from = ordered;
	}
	free(to);
	*spans = (esk_spans){from, spans->count, spans->count};
	return ESKEL_OK;
}

static bool same_row(const esk_span *a, const esk_span *b)
{
	return a->y == b->y && a->z == b->z;
}

eskel_status esk_spans_join(esk_spans *spans, eskel_error *error)
{
	eskel_status status = esk_spans_sort(spans, error);
	if (status != ESKEL_OK)
		return status;
	esk_span *items = spans->items;
	size_t kept = 0;
	for (size_t i = 0; i < spans->count; i++) {
		esk_span *last = kept ? &items[kept - 1] : NULL;
		bool beside = last && same_row(last, &items[i]);
		if (beside && items[i].x_first <= last->x_last)
			return esk_error_set(error, ESKEL_INVALID,
				"two runs hold voxel (%u, %u, %u), expected disjoint runs", items[i].x_first,
				items[i].y, items[i].z);
		if (beside && items[i].x_first == last->x_last + 1 && items[i].weight == last->weight)
			last->x_last = items[i].x_last;
		else
			items[kept++] = items[i];
	}
	spans->count = kept;
	return ESKEL_OK;
}

void esk_spans_swap_yz(esk_spans *spans)
{
	for (size_t i = 0; i < spans->count; i++) {
		esk_span *s = &spans->items[i];
		uint16_t y = s->y;
		s->y = s->z;
		s->z = y;
	}
}

/* A stretch [begin, end) of a span list that lies in one row. */
typedef struct {
	const esk_span *begin, *end;
} row;

static row row_from(const esk_span *begin, const esk_span *end)
{
	row r = {begin, begin};
	while (r.end < end && same_row(r.end, begin))
		r.end++;
	return r;
}

/* Adds the voxels x_first to x_last of a row, each as a span of one voxel with x and y exchanged. */
static eskel_status add_exchanged(
	esk_spans *out, const esk_span *s, uint32_t x_first, uint32_t x_last, eskel_error *error)
{
	eskel_status status = ESKEL_OK;
	for (uint32_t x = x_first; x <= x_last && status == ESKEL_OK; x++)
		status = esk_spans_add(out, (esk_span){s->y, s->y, (uint16_t)x, s->z, s->weight}, error);
	return status;
}

/* Adds to out the voxels of one row that the neighbour row does not have with the same weight. */
static eskel_status add_difference(esk_spans *out, row from, row neighbour, eskel_error *error)
{
	const esk_span *n = neighbour.begin;
	for (const esk_span *s = from.begin; s < from.end; s++) {
		uint32_t x = s->x_first; /* everything of s before x is dealt with */
		while (n < neighbour.end && n->x_last < x)
			n++;
		for (const esk_span *m = n; m < neighbour.end && m->x_first <= s->x_last; m++) {
			if (m->weight != s->weight)
				continue;
			if (m->x_first > x) {
				eskel_status status = add_exchanged(out, s, x, m->x_first - 1u, error);
				if (status != ESKEL_OK)
					return status;
			}
			x = m->x_last + 1u;
		}
		if (x <= s->x_last) {
			eskel_status status = add_exchanged(out, s, x, s->x_last, error);
			if (status != ESKEL_OK)
				return status;
		}
	}
	return ESKEL_OK;
}

static bool follows(row before, row after)
{
	return before.begin < before.end && after.begin < after.end && before.begin->z == after.begin->z &&
	       before.begin->y + 1 == after.begin->y;
}

eskel_status esk_spans_swap_xy(esk_spans *spans, eskel_error *error)
{
	esk_spans beginnings = {0}, ends = {0};
	const row nothing = {NULL, NULL};
	const esk_span *end = spans->items + spans->count;
	eskel_status status = ESKEL_OK;
	row before = nothing, here = row_from(spans->items, end);
	while (here.begin < here.end && status == ESKEL_OK) {
		row after = row_from(here.end, end);
		status = add_difference(&beginnings, here, follows(before, here) ? before : nothing, error);
		if (status == ESKEL_OK)
			status = add_difference(&ends, here, follows(here, after) ? after : nothing, error);
		before = here;
		here = after;
	}
	if (status == ESKEL_OK)
		status = esk_spans_sort(&beginnings, error);
	if (status == ESKEL_OK)
		status = esk_spans_sort(&ends, error);
	if (status == ESKEL_OK) {
		for (size_t i = 0; i < beginnings.count; i++)
			beginnings.items[i].x_last = ends.items[i].x_first;
		esk_spans_free(spans);
		*spans = beginnings;
		beginnings = (esk_spans){0};
	}
	esk_spans_free(&beginnings);
	esk_spans_free(&ends);
	return status;
}
