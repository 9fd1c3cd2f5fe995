/* Milliseconds that never go back: for deadlines and durations. */
#ifndef ESK_CLOCK_H
#define ESK_CLOCK_H

#include <stdint.h>
#include <time.h>

static inline double esk_clock_exact(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

static inline int64_t esk_clock_now(void)
{
	return (int64_t)esk_clock_exact();
}

#endif
