/* Time that only goes forward, to measure with. */
#ifndef ESK_CLOCK_H
#define ESK_CLOCK_H

double esk_clock_milliseconds(void);

#endif
