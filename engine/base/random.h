/* Numbers that look random, the same for the same seed everywhere: splitmix64 (Steele, Lea, Flood 2014). */
#ifndef ESK_RANDOM_H
#define ESK_RANDOM_H

#include <stdint.h>

/* The next of a stream. */
static inline uint64_t esk_random(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
	z = (z ^ z >> 27) * 0x94d049bb133111eb;
	return z ^ z >> 31;
}

/* From 0 to 1, without 1. */
static inline double esk_random_uniform(uint64_t *state)
{
	return (double)(esk_random(state) >> 11) * 0x1p-53;
}

/* Of mean 0 and variance 1, nearly normal: the sum of twelve. */
static inline double esk_random_normal(uint64_t *state)
{
	double sum = -6;
	for (int i = 0; i < 12; i++)
		sum += esk_random_uniform(state);
	return sum;
}

#endif
