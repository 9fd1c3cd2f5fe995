/* Candidates ordered by distance, then key: so that every order in a search is total and ties never depend on where
 * shapes happen to lie. */
#ifndef ESK_RANKING_H
#define ESK_RANKING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
	double distance;
	int64_t key;
	uint32_t id;  /* in the snapshot */
	uint32_t row; /* whatever else is known of it, where the caller keeps that */
} esk_ranked;

static inline bool esk_ranked_before(const esk_ranked *a, const esk_ranked *b)
{
	return a->distance < b->distance || (a->distance == b->distance && a->key < b->key);
}

/* Puts the first count of all in front, in any order. O(n) on average. */
void esk_ranked_select(esk_ranked *all, size_t n, size_t count);
/* The last of all, which are at least one. */
const esk_ranked *esk_ranked_last(const esk_ranked *all, size_t n);
void esk_ranked_sort(esk_ranked *all, size_t n);

/* A shape of which only a lower bound of its distance is known. */
typedef struct {
	float lower; /* zero or more */
	uint32_t id;
} esk_candidate;

/* The lower that n others are before, when all are in order. n is less than count. O(count). */
float esk_candidates_nth(const esk_candidate *all, size_t count, size_t n);

/* The nearest of all candidates offered so far: a heap with the farthest of them on top. */
typedef struct {
	esk_ranked *items;
	size_t count, wanted;
} esk_nearest;

/* wanted is at least 1; false when memory ran out. */
bool esk_nearest_init(esk_nearest *nearest, size_t wanted);
void esk_nearest_clear(esk_nearest *nearest);
void esk_nearest_offer(esk_nearest *nearest, esk_ranked candidate);
/* Whether it would be taken; then *row, below wanted, is one that no other has. */
bool esk_nearest_takes(const esk_nearest *nearest, const esk_ranked *candidate, uint32_t *row);

/* Nothing farther than this can still be taken; infinite until all wanted are there. */
double esk_nearest_threshold(const esk_nearest *nearest);

#endif
