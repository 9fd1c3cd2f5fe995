/* Logistic regression: from evidence and whether it was right to the probability that it is right,
 * P = 1 / (1 + exp(-weights . features)).
 *
 * The weights maximise the likelihood of the examples times a normal prior about weights known from elsewhere, so that a
 * few examples move them little, many decide, and examples that a line separates do not drive them to infinity. */
#ifndef ESK_LOGISTIC_H
#define ESK_LOGISTIC_H

#include <stdbool.h>
#include <stddef.h>

#define ESK_FEATURES 3

typedef struct {
	double features[ESK_FEATURES];
	bool right;
} esk_example;

/* A feature that is not used is 0 in every example; its weight then stays where the prior has it. */
typedef struct {
	double weights[ESK_FEATURES], spreads[ESK_FEATURES]; /* means and standard deviations, > 0 */
} esk_logistic_prior;

double esk_logistic_probability(const double weights[ESK_FEATURES], const double features[ESK_FEATURES]);

/* The same for any order of the examples but for rounding. */
void esk_logistic_fit(
	const esk_example *examples, size_t count, const esk_logistic_prior *prior, double weights[ESK_FEATURES]);

#endif
