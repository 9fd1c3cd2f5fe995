/* Costs of pairs of classes, by vectors of columns. Every cost is summed in one lane, number after number, so it does
 * not depend on the width of the processor's vectors. */
#include "class_costs.h"

#include "assignment.h"
#include "shape.h"

#include <math.h>
#include <string.h>

enum { LANES = 8 };
typedef float floats __attribute__((vector_size(4 * LANES), may_alias));
typedef int32_t integers __attribute__((vector_size(4 * LANES), may_alias));

typedef struct {
	uint32_t numbers, k, width;
	const float *a;                                                   /* rows of k */
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float b[ESK_LEVEL_FLOATS_MAX]; /* rows of width */
} pairs;

/* Infinite numbers in the padding make infinite costs. */
static void init(pairs *p, uint32_t numbers, uint32_t k, const float *a, const float *b)
{
	p->numbers = numbers;
	p->k = k;
	p->width = esk_assignment_width(k);
	p->a = a;
	for (uint32_t c = 0; c < p->numbers; c++) {
		float *row = p->b + c * p->width;
		memcpy(row, b + c * p->k, p->k * sizeof *b);
		for (uint32_t j = p->k; j < p->width; j++)
			row[j] = INFINITY;
	}
}

/* Adds what differences are worth in the cost of a pair, before the root of the Euclidean metric. */
__attribute__((always_inline)) static inline void add_term(const floats *differences, eskel_metric metric, floats *sum)
{
	floats term = (floats)((integers)*differences & INT32_MAX);
	if (metric == ESKEL_METRIC_EUCLIDEAN)
		term *= term;
	for (int lane = 0; metric == ESKEL_METRIC_ROOT && lane < LANES; lane++)
		term[lane] = sqrtf(term[lane]);
	*sum += term;
}

/* Of class i of a and eight of b, from j on. */
__attribute__((always_inline)) static inline void add_terms(
	const pairs *p, uint32_t i, uint32_t j, uint32_t numbers, eskel_metric metric, floats *sum)
{
	*sum = (floats){0};
	for (uint32_t c = 0; c < numbers; c++) {
		const floats differences = p->a[c * p->k + i] - *(const floats *)&p->b[c * p->width + j];
		add_term(&differences, metric, sum);
	}
}

__attribute__((always_inline)) static inline void add_up(
	const pairs *p, uint32_t numbers, eskel_metric metric, float *costs)
{
	for (uint32_t i = 0; i < p->k; i++)
		for (uint32_t j = 0; j < p->width; j += LANES) {
			floats sum;
			add_terms(p, i, j, numbers, metric, &sum);
			*(floats *)&costs[i * p->width + j] = sum;
		}
}

/* The log signature is what nearly all searches use, with the Manhattan metric or with roots, so these loops are worth
 * unrolling. */
__attribute__((always_inline)) static inline void add_up_any(const pairs *p, eskel_metric metric, float *costs)
{
	if (p->numbers == ESK_NUMBERS_MAX && metric == ESKEL_METRIC_MANHATTAN)
		add_up(p, ESK_NUMBERS_MAX, ESKEL_METRIC_MANHATTAN, costs);
	else if (p->numbers == ESK_NUMBERS_MAX && metric == ESKEL_METRIC_ROOT)
		add_up(p, ESK_NUMBERS_MAX, ESKEL_METRIC_ROOT, costs);
	else
		add_up(p, p->numbers, metric, costs);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void add_up_avx2(const pairs *p, eskel_metric metric, float *costs)
{
	add_up_any(p, metric, costs);
}
#endif

void esk_class_costs(eskel_metric metric, uint32_t numbers, uint32_t k, const float *a, const float *b, float *costs)
{
	pairs p;
	init(&p, numbers, k, a, b);
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2"))
		add_up_avx2(&p, metric, costs);
	else
#endif
		add_up_any(&p, metric, costs);
	for (uint32_t n = 0; metric == ESKEL_METRIC_EUCLIDEAN && n < k * p.width; n++)
		costs[n] = sqrtf(costs[n]);
}

/* ---- the nearest */

__attribute__((always_inline)) static inline void take_less(const floats *sum, floats *least)
{
	const integers less = *sum < *least;
	*least = (floats)((less & (integers)*sum) | (~less & (integers)*least));
}

__attribute__((always_inline)) static inline float least_lane(const floats *least)
{
	float found = (*least)[0];
	for (int lane = 1; lane < LANES; lane++)
		found = (*least)[lane] < found ? (*least)[lane] : found;
	return found;
}

__attribute__((always_inline)) static inline float add_nearest(const pairs *p, uint32_t numbers)
{
	floats of_b[ESKEL_LEVELS_MAX / LANES];
	float sum_of_a = 0, sum_of_b = 0;
	for (uint32_t j = 0; j < p->width; j += LANES)
		of_b[j / LANES] = (floats){0} + INFINITY;
	for (uint32_t i = 0; i < p->k; i++) {
		floats of_a = (floats){0} + INFINITY;
		for (uint32_t j = 0; j < p->width; j += LANES) {
			floats sum;
			add_terms(p, i, j, numbers, ESKEL_METRIC_ROOT, &sum);
			take_less(&sum, &of_a);
			take_less(&sum, &of_b[j / LANES]);
		}
		sum_of_a += least_lane(&of_a);
	}
	for (uint32_t j = 0; j < p->k; j++)
		sum_of_b += of_b[j / LANES][j % LANES];
	return sum_of_a > sum_of_b ? sum_of_a : sum_of_b;
}

__attribute__((always_inline)) static inline float add_nearest_any(const pairs *p)
{
	return p->numbers == ESK_NUMBERS_MAX ? add_nearest(p, ESK_NUMBERS_MAX) : add_nearest(p, p->numbers);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static float add_nearest_avx2(const pairs *p)
{
	return add_nearest_any(p);
}
#endif

float esk_class_costs_nearest(uint32_t numbers, uint32_t k, const float *a, const float *b)
{
	pairs p;
	init(&p, numbers, k, a, b);
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2"))
		return add_nearest_avx2(&p);
#endif
	return add_nearest_any(&p);
}
