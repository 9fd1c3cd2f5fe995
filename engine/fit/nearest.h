/* The nearest of many small things in space, by a k-d tree over their centres. */
#ifndef ESK_NEAREST_H
#define ESK_NEAREST_H

#include "eskel.h"

typedef struct {
	size_t count;
	double (*centres)[3]; /* in the order of the tree, in which neighbours in space are mostly neighbours */
	uint32_t *items;      /* which item has the centre at a place */
	struct esk_nearest_node *nodes; /* the inner ones, root first, the children of n at 2 n + 1 and 2 n + 2 */
} esk_nearest;

/* Copies. A thing reaches no further than reach from its centre. Count is 1 to 2^31. O(n log n). */
eskel_status esk_nearest_new(const double (*centres)[3], size_t count, esk_nearest **nearest);
void esk_nearest_free(esk_nearest *nearest);

/* The least distance from a point to any item, and which one it is (may be NULL), the first by place in the tree among
 * equals. Items reach no further than reach from their centres; distance(context, item, point) is theirs. */
double esk_nearest_find(const esk_nearest *nearest, const double point[3], double reach,
	double (*distance)(const void *context, uint32_t item, const double point[3]), const void *context,
	uint32_t *item);

#endif
