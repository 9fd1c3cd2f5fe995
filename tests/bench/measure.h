/* What a benchmark measures of itself, and the lines that tests/bench/table.py reads. */
#ifndef MEASURE_H
#define MEASURE_H

#include <stdio.h>
#include <sys/resource.h>
#include <time.h>

static inline double measure_milliseconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* The most memory that the process has had so far. */
static inline double measure_peak_megabytes(void)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	return (double)usage.ru_maxrss / 1024;
}

/* Milliseconds of the fastest of five runs, or of as many as begin within a second. The same rule for every program,
 * the peers in Python included: the least is what the machine can do when nothing disturbs it. */
static inline double measure_least(void (*run)(void *context), void *context)
{
	double least = 1e300;
	const double begin = measure_milliseconds();
	for (int i = 0; i < 5 && (i == 0 || measure_milliseconds() - begin < 1e3); i++) {
		const double start = measure_milliseconds();
		run(context);
		const double spent = measure_milliseconds() - start;
		least = spent < least ? spent : least;
	}
	return least;
}

/* One line: figure, program, value, unit, with tabs between. */
static inline void measure_print(const char *figure, const char *program, double value, const char *unit)
{
	printf("%s\t%s\t%.6g\t%s\n", figure, program, value, unit);
	fflush(stdout);
}

#endif
