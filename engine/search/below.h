/* Which of many numbers are small enough. */
#ifndef ESK_BELOW_H
#define ESK_BELOW_H

#include <stdint.h>

enum { ESK_BELOW_MOST = 1 << 16 };

/* Writes the places, ascending, of those of count numbers that are at most limit, and returns how many they are. count is a
 * multiple of 16 and at most ESK_BELOW_MOST; places has room for count. */
uint32_t esk_below(const float *numbers, uint32_t count, float limit, uint16_t *places);

#endif
