/* Fits the examples that it reads, for logistic_oracle.py. */
#include "logistic.h"

#include <stdio.h>

int main(void)
{
	static esk_example examples[1000];
	esk_logistic_prior prior;
	double weights[ESK_FEATURES], *p = prior.weights, *s = prior.spreads;
	size_t count = 0;
	int right;
	if (scanf("prior %lf %lf %lf %lf %lf %lf", &p[0], &p[1], &p[2], &s[0], &s[1], &s[2]) != 6)
		return 1;
	for (double *x = examples[0].features;
		count < 1000 && scanf("%d %lf %lf %lf", &right, &x[0], &x[1], &x[2]) == 4; x = examples[count].features)
		examples[count++].right = right;
	esk_logistic_fit(examples, count, &prior, weights);
	printf("%.17g %.17g %.17g\n", weights[0], weights[1], weights[2]);
	return 0;
}
