/* Lists of weighted runs: sorting, joining, and exchanging the run axis with another. */
#ifndef ESK_SPANS_H
#define ESK_SPANS_H

#include "eskel.h"

/* A run with the weight of each of its voxels. */
typedef struct {
	uint16_t x_first, x_last, y, z;
	uint32_t weight;
} esk_span;

typedef struct {
	esk_span *items;
	size_t count, capacity;
} esk_spans;

void esk_spans_free(esk_spans *spans);
eskel_status esk_spans_add(esk_spans *spans, esk_span span, eskel_error *error);

/* By (z, y, x_first). */
eskel_status esk_spans_sort(esk_spans *spans, eskel_error *error);

/* Sorts and joins spans of equal weight that touch. ESKEL_INVALID if any two overlap. */
eskel_status esk_spans_join(esk_spans *spans, eskel_error *error);

/* Exchanges y and z; the result is not sorted. */
void esk_spans_swap_yz(esk_spans *spans);

/* Exchanges x and y, so that the spans run along the former y axis. They must be sorted and joined, and stay so. */
eskel_status esk_spans_swap_xy(esk_spans *spans, eskel_error *error);

#endif
