/* The monotonic clock, see clock.h. */
#include "clock.h"

#include <time.h>

double esk_clock_milliseconds(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}
