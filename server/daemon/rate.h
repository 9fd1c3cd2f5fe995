/* Requests a second of one client: a token bucket each, in a table of fixed size.
 *
 * A bucket holds a second's worth of requests and refills steadily. The table is eight-way associative: a new client
 * takes the place that was idle longest among its eight, so that strangers cannot make it grow.
 */
#ifndef ESK_RATE_H
#define ESK_RATE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct esk_rate esk_rate;

/* NULL when memory ran out. */
esk_rate *esk_rate_new(uint64_t a_second);
void esk_rate_free(esk_rate *rate);

/* Takes cost requests from the bucket of key at the time now (monotonic milliseconds); false when it is empty. */
bool esk_rate_take(esk_rate *rate, uint64_t key, double cost, int64_t now);

#endif
