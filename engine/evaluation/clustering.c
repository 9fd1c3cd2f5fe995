/* Hierarchical clustering by average linkage (UPGMA), by the nearest-neighbour chain (Murtagh, 1983; Müllner, 2011).
 *
 * From any cluster a chain goes to its nearest neighbour, and on to the nearest of that, until two are each other's. These
 * are merged: with average linkage no later merge can come between them, so merging pairs in any order and sorting by
 * height at the end gives the tree of merging the nearest pair of all each time. A merge leaves the chain before it
 * valid, so every cluster is pushed once and looked around from a few times: O(n^2).
 *
 * A tie goes to the cluster before in the chain, so that it ends, and then to the lower slot. A cluster lives in the slot
 * of its last shape; its distances are updated in place (Lance and Williams, 1967). A mean is kept between what it is the
 * mean of, which rounding might leave: on that rest that chains end and that heights ascend from the leaves on. */
#include "eskel.h"
#include "memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
	size_t count;
	double *distances; /* [count * count], of slots */
	uint32_t *sizes;   /* [count] shapes in a slot; 0: none any more */
	uint32_t *chain;   /* [count] slots */
	size_t chain_length, merge_count;
	eskel_merge *merges; /* first and second are slots until the tree is labelled */
} clustering;

static uint32_t nearest(const clustering *c, uint32_t slot, uint32_t before)
{
	const double *row = c->distances + slot * c->count;
	uint32_t best = before;
	for (uint32_t other = 0; other < c->count; other++)
		if (c->sizes[other] > 0 && other != slot && (best == slot || row[other] < row[best]))
			best = other;
	return best;
}

static void merge(clustering *c, uint32_t a, uint32_t b)
{
	const uint32_t gone = a < b ? a : b, kept = a < b ? b : a;
	const uint32_t size = c->sizes[gone] + c->sizes[kept];
	const double share = (double)c->sizes[gone] / size;
	c->merges[c->merge_count++] = (eskel_merge){gone, kept, c->distances[gone * c->count + kept], size};
	for (uint32_t other = 0; other < c->count; other++) {
		const double x = c->distances[gone * c->count + other], y = c->distances[kept * c->count + other];
		const double mean = fmin(fmax(share * x + (1 - share) * y, fmin(x, y)), fmax(x, y));
		c->distances[kept * c->count + other] = c->distances[other * c->count + kept] = mean;
	}
	c->sizes[gone] = 0;
	c->sizes[kept] = size;
}

static void step(clustering *c)
{
	if (c->chain_length == 0)
		for (uint32_t slot = 0; c->chain_length == 0; slot++)
			if (c->sizes[slot] > 0)
				c->chain[c->chain_length++] = slot;
	const uint32_t last = c->chain[c->chain_length - 1];
	const uint32_t before = c->chain_length > 1 ? c->chain[c->chain_length - 2] : last;
	const uint32_t next = nearest(c, last, before);
	if (next == before) {
		c->chain_length -= 2;
		merge(c, last, before);
	} else {
		c->chain[c->chain_length++] = next;
	}
}

/* Of equal heights what is within the other comes first. */
static int by_height(const void *a, const void *b)
{
	const eskel_merge *x = a, *y = b;
	if (x->height != y->height)
		return x->height < y->height ? -1 : 1;
	if (x->size != y->size)
		return x->size < y->size ? -1 : 1;
	return x->first < y->first ? -1 : 1; /* a slot goes once */
}

/* Sorts the merges and names clusters in place of slots. names[slot]: the cluster that lives there. */
static void label(clustering *c, uint32_t *names)
{
	qsort(c->merges, c->merge_count, sizeof *c->merges, by_height);
	for (uint32_t slot = 0; slot < c->count; slot++)
		names[slot] = slot;
	for (size_t s = 0; s < c->merge_count; s++) {
		eskel_merge *m = &c->merges[s];
		const uint32_t gone = names[m->first], kept = names[m->second];
		names[m->second] = (uint32_t)(c->count + s);
		m->first = gone < kept ? gone : kept;
		m->second = gone < kept ? kept : gone;
	}
}

eskel_status eskel_clustering(const double *distances, size_t count, eskel_merge *merges)
{
	if (count < 2)
		return ESKEL_OK;
	if (count > UINT32_MAX / 2)
		return ESKEL_INVALID;
	clustering c = {.count = count, .merges = merges};
	eskel_status status = ESKEL_OK;
	c.distances = esk_memory_array(count * count, sizeof *c.distances);
	c.sizes = esk_memory_array(count, sizeof *c.sizes);
	c.chain = esk_memory_array(count, sizeof *c.chain);
	if (!c.distances || !c.sizes || !c.chain) {
		status = ESKEL_NO_MEMORY;
		goto cleanup;
	}
	memcpy(c.distances, distances, count * count * sizeof *distances);
	for (size_t slot = 0; slot < count; slot++)
		c.sizes[slot] = 1;
	while (c.merge_count < count - 1)
		step(&c);
	label(&c, c.chain);
cleanup:
	free(c.distances);
	free(c.sizes);
	free(c.chain);
	return status;
}

/* ---------------------------------------------------------------------------------------------- the order of leaves */

static uint32_t size_of(const eskel_merge *merges, size_t count, uint32_t cluster)
{
	return cluster < count ? 1 : merges[cluster - count].size;
}

static bool comes_first(const eskel_merge *merges, size_t count, uint32_t a, uint32_t b)
{
	const double height_a = a < count ? 0 : merges[a - count].height;
	const double height_b = b < count ? 0 : merges[b - count].height;
	return height_a != height_b ? height_a < height_b : a < b;
}

eskel_status eskel_clustering_order(const eskel_merge *merges, size_t count, uint32_t *order)
{
	uint32_t *starts = esk_memory_array(2 * count, sizeof *starts); /* of a cluster's leaves in the order */
	if (!starts)
		return ESKEL_NO_MEMORY;
	if (count > 0)
		starts[count > 1 ? 2 * count - 2 : 0] = 0;
	for (size_t s = count - (count > 0); s-- > 0;) {
		const eskel_merge *m = &merges[s];
		const bool as_named = comes_first(merges, count, m->first, m->second);
		const uint32_t before = as_named ? m->first : m->second, after = as_named ? m->second : m->first;
		starts[before] = starts[count + s];
		starts[after] = starts[before] + size_of(merges, count, before);
	}
	for (uint32_t leaf = 0; leaf < count; leaf++)
		order[starts[leaf]] = leaf;
	free(starts);
	return ESKEL_OK;
}
