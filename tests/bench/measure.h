/* What a benchmark measures of itself. */
#ifndef MEASURE_H
#define MEASURE_H

#include <sys/resource.h>
#include <time.h>

static inline double measure_milliseconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static inline double measure_peak_megabytes(void)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	return (double)usage.ru_maxrss / 1024;
}

#endif
