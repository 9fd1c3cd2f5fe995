/* Reads sets of "count, classes, subjects, distances" from standard input and prints the measures of every query, one a
 * line, and the means: for retrieval_oracle.py. A class or subject of -1 is none; a count of 0 ends. */
#include "eskel.h"

#include <stdio.h>
#include <stdlib.h>

static void print(const eskel_retrieval *r)
{
	printf("%.17g %.17g %.17g %.17g %.17g", r->nearest_neighbour, r->first_tier, r->second_tier, r->e_measure,
		r->dcg);
	for (size_t step = 0; step < ESKEL_RECALL_STEPS; step++)
		printf(" %.17g", r->precision[step]);
	putchar('\n');
}

static uint32_t *read_numbers(size_t count)
{
	uint32_t *numbers = calloc(count, sizeof *numbers);
	for (size_t i = 0; numbers && i < count; i++) {
		long number;
		if (scanf("%ld", &number) != 1)
			exit(1);
		numbers[i] = number < 0 ? ESKEL_UNNUMBERED : (uint32_t)number;
	}
	return numbers;
}

static void print_set(size_t count)
{
	uint32_t *classes = read_numbers(count), *subjects = read_numbers(count);
	double *distances = calloc(count, sizeof *distances);
	eskel_retrieval *retrievals = calloc(count, sizeof *retrievals), mean;
	if (!classes || !subjects || !distances || !retrievals)
		exit(1);
	const eskel_evaluation evaluation = {count, classes, subjects};
	for (size_t query = 0; query < count; query++) {
		for (size_t i = 0; i < count; i++)
			if (scanf("%lf", &distances[i]) != 1)
				exit(1);
		if (eskel_evaluation_judge(&evaluation, query, distances, &retrievals[query]))
			exit(1);
		print(&retrievals[query]);
	}
	eskel_retrieval_mean(retrievals, count, &mean);
	print(&mean);
	free(retrievals);
	free(distances);
	free(subjects);
	free(classes);
}

int main(void)
{
	for (size_t count; scanf("%zu", &count) == 1 && count > 0;)
		print_set(count);
	return 0;
}
