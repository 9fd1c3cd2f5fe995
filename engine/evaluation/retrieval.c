/* Retrieval measures of one query, and their means (definitions and the rule for ties: eskel_library.h).
 *
 * Every measure but the precision is a sum over ranks of a weight times whether the shape at that rank is relevant. Of m
 * shapes at equal distance, r of them relevant, each rank holds a relevant one in r/m of their orders; so putting r/m in
 * place of 0 or 1 gives the mean over all orders exactly. In a random order the ith of the r comes, on average, at place
 * i (m + 1) / (r + 1) of the m. */
#include "eskel.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>

enum { first_page = 32 }; /* of the E-measure */

typedef struct {
	double distance;
	bool relevant;
} ranked_shape;

static int by_distance(const void *a, const void *b)
{
	const ranked_shape *x = a, *y = b;
	return x->distance < y->distance ? -1 : x->distance > y->distance;
}

bool eskel_evaluation_leaves_out(const eskel_evaluation *evaluation, size_t query, size_t other)
{
	const uint32_t *subjects = evaluation->subjects;
	return other == query ||
	       (subjects && subjects[query] != ESKEL_UNNUMBERED && subjects[query] == subjects[other]);
}

/* Ascending distances. */
static void rank(const eskel_evaluation *evaluation, size_t query, const double *distances, ranked_shape *ranks,
	eskel_retrieval *r)
{
	const uint32_t class = evaluation->classes[query];
	for (size_t i = 0; i < evaluation->count; i++) {
		if (eskel_evaluation_leaves_out(evaluation, query, i))
			continue;
		bool relevant = class != ESKEL_UNNUMBERED && evaluation->classes[i] == class;
		ranks[r->ranked++] = (ranked_shape){distances[i], relevant};
		r->relevant += relevant;
	}
	qsort(ranks, r->ranked, sizeof *ranks, by_distance);
}

static double discount(size_t rank)
{
	return rank <= 2 ? 1 : 1 / log2((double)rank);
}

/* One rank, from 1, that holds a relevant shape in this share of the orders. */
static void count_rank(eskel_retrieval *r, size_t rank, double share)
{
	const size_t page = r->ranked < first_page ? r->ranked : first_page;
	const double relevant = (double)r->relevant;
	if (rank == 1)
		r->nearest_neighbour = share;
	if (rank <= r->relevant)
		r->first_tier += share / relevant;
	if (rank <= 2 * r->relevant)
		r->second_tier += share / relevant;
	if (rank <= page)
		r->e_measure += 2 * share / (relevant + (double)page);
	r->dcg += share * discount(rank);
}

/* Of the steps of recall that found shapes of the class reach, the precision there; those before take it if it is more. */
static void count_recall(eskel_retrieval *r, size_t found, double rank)
{
	const double precision = (double)found / rank;
	for (size_t step = 1; step <= ESKEL_RECALL_STEPS && step * r->relevant <= found * ESKEL_RECALL_STEPS; step++)
		r->precision[step - 1] = fmax(r->precision[step - 1], precision);
}

static void count_all(const ranked_shape *ranks, eskel_retrieval *r)
{
	size_t found = 0;
	for (size_t begin = 0, end; begin < r->ranked; begin = end) {
		size_t relevant = 0;
		for (end = begin; end < r->ranked && ranks[end].distance <= ranks[begin].distance; end++)
			relevant += ranks[end].relevant;
		const size_t equals = end - begin;
		for (size_t i = begin; relevant > 0 && i < end; i++)
			count_rank(r, i + 1, (double)relevant / (double)equals);
		for (size_t i = 1; i <= relevant; i++) {
			double place = (double)i * (double)(equals + 1) / (double)(relevant + 1);
			count_recall(r, ++found, (double)begin + place);
		}
	}
}

eskel_status eskel_evaluation_judge(
	const eskel_evaluation *evaluation, size_t query, const double *distances, eskel_retrieval *retrieval)
{
	eskel_retrieval made = {0};
	ranked_shape *ranks = esk_memory_array(evaluation->count, sizeof *ranks);
	if (!ranks)
		return ESKEL_NO_MEMORY;
	rank(evaluation, query, distances, ranks, &made);
	if (made.relevant > 0) {
		double most = 0;
		count_all(ranks, &made);
		for (size_t i = 1; i <= made.relevant; i++)
			most += discount(i);
		made.dcg /= most;
	}
	free(ranks);
	*retrieval = made;
	return ESKEL_OK;
}

size_t eskel_retrieval_mean(const eskel_retrieval *retrievals, size_t count, eskel_retrieval *mean)
{
	eskel_retrieval sum = {0};
	size_t queries = 0;
	for (size_t i = 0; i < count; i++)
		queries += retrievals[i].relevant > 0;
	for (size_t i = 0; i < count; i++) {
		const eskel_retrieval *one = &retrievals[i];
		if (one->relevant == 0)
			continue;
		sum.nearest_neighbour += one->nearest_neighbour / (double)queries;
		sum.first_tier += one->first_tier / (double)queries;
		sum.second_tier += one->second_tier / (double)queries;
		sum.e_measure += one->e_measure / (double)queries;
		sum.dcg += one->dcg / (double)queries;
		for (size_t step = 0; step < ESKEL_RECALL_STEPS; step++)
			sum.precision[step] += one->precision[step] / (double)queries;
	}
	*mean = sum;
	return queries;
}
