/* Newton's method on a strictly concave function, see logistic.h. */
#include "logistic.h"

#include <math.h>
#include <string.h>

/* Newton's method doubles the right digits; from the prior six or so steps do. */
#define MOST_STEPS 50
#define LEAST_GAIN 1e-12

typedef struct {
	double value, gradient[ESK_FEATURES];
	double hessian[ESK_FEATURES][ESK_FEATURES]; /* of the negative value: positive definite */
} expansion;

static double dot(const double a[ESK_FEATURES], const double b[ESK_FEATURES])
{
	double sum = 0;
	for (size_t i = 0; i < ESK_FEATURES; i++)
		sum += a[i] * b[i];
	return sum;
}

double esk_logistic_probability(const double weights[ESK_FEATURES], const double features[ESK_FEATURES])
{
	return 1 / (1 + exp(-dot(weights, features)));
}

/* ln P(example), without overflow. */
static double log_likelihood(const esk_example *example, const double weights[ESK_FEATURES])
{
	double x = dot(weights, example->features);
	if (!example->right)
		x = -x;
	return fmin(x, 0) - log1p(exp(-fabs(x)));
}

static expansion expand(
	const esk_example *examples, size_t count, const esk_logistic_prior *prior, const double weights[ESK_FEATURES])
{
	expansion e = {0};
	for (size_t i = 0; i < ESK_FEATURES; i++) {
		double precision = 1 / (prior->spreads[i] * prior->spreads[i]);
		double away = weights[i] - prior->weights[i];
		e.value -= 0.5 * precision * away * away;
		e.gradient[i] = -precision * away;
		e.hessian[i][i] = precision;
	}
	for (size_t n = 0; n < count; n++) {
		const double *x = examples[n].features;
		double p = esk_logistic_probability(weights, x);
		e.value += log_likelihood(&examples[n], weights);
		for (size_t i = 0; i < ESK_FEATURES; i++) {
			e.gradient[i] += (examples[n].right - p) * x[i];
			for (size_t j = 0; j < ESK_FEATURES; j++)
				e.hessian[i][j] += p * (1 - p) * x[i] * x[j];
		}
	}
	return e;
}

/* Solves hessian . step = gradient by elimination, which needs no pivots in a positive definite matrix. */
static void newton_step(expansion e, double step[ESK_FEATURES])
{
	for (size_t i = 0; i < ESK_FEATURES; i++)
		for (size_t j = i + 1; j < ESK_FEATURES; j++) {
			double factor = e.hessian[j][i] / e.hessian[i][i];
			for (size_t k = i; k < ESK_FEATURES; k++)
				e.hessian[j][k] -= factor * e.hessian[i][k];
			e.gradient[j] -= factor * e.gradient[i];
		}
	for (size_t i = ESK_FEATURES; i-- > 0;) {
		step[i] = e.gradient[i];
		for (size_t k = i + 1; k < ESK_FEATURES; k++)
			step[i] -= e.hessian[i][k] * step[k];
		step[i] /= e.hessian[i][i];
	}
}

void esk_logistic_fit(
	const esk_example *examples, size_t count, const esk_logistic_prior *prior, double weights[ESK_FEATURES])
{
	double best[ESK_FEATURES], step[ESK_FEATURES];
	memcpy(best, prior->weights, sizeof best);
	expansion at_best = expand(examples, count, prior, best);
	newton_step(at_best, step);
	for (int n = 0; n < MOST_STEPS && dot(step, at_best.gradient) > LEAST_GAIN; n++) {
		double next[ESK_FEATURES];
		for (size_t i = 0; i < ESK_FEATURES; i++)
			next[i] = best[i] + step[i];
		expansion at_next = expand(examples, count, prior, next);
		if (at_next.value >= at_best.value) {
			memcpy(best, next, sizeof best);
			at_best = at_next;
			newton_step(at_best, step);
		} else { /* too far: half the way is nearer, and goes up in the end */
			for (size_t i = 0; i < ESK_FEATURES; i++)
				step[i] /= 2;
		}
	}
	memcpy(weights, best, sizeof best);
}
