/* ln, exp, sine and cosine, the cube root and rounding to float from IEEE basic operations alone, in a fixed order.
 *
 * The C library's own differ in the last bit between versions and, because they choose fused multiply-add at run time,
 * between processors. Features must be the same bits everywhere, and these loops vectorise. */
#ifndef ESK_ELEMENTARY_H
#define ESK_ELEMENTARY_H

#include <stdint.h>
#include <string.h>

/* x positive and normal. Within 1e-15 of ln x, relative to the larger of |ln x| and 1. */
static inline double esk_elementary_log(double x)
{
	/* x = 2^octave m with m in [sqrt 1/2, sqrt 2): the bits of sqrt 1/2 are subtracted, so that the exponent field of what
	 * is left counts whole octaves above it. They become a double in the last bits of 2^52, not by way of a short
	 * integer: vectors hold as many words of 64 bits as doubles. */
	const uint64_t sqrt_half = 0x3fe6a09e667f3bcd, bias = 0x3ff0000000000000, large = 0x4330000000000000;
	uint64_t bits, octaves;
	memcpy(&bits, &x, sizeof bits);
	octaves = (bits - sqrt_half + bias) >> 52;
	bits -= (octaves << 52) - bias;
	octaves |= large;
	double m, octave;
	memcpy(&m, &bits, sizeof m);
	memcpy(&octave, &octaves, sizeof octave);
	octave -= 0x1p52 + 1023;
	/* ln m = 2 artanh s, s = (m - 1) / (m + 1), |s| < 0.1716; the first term left out is 2 s^21 / 21 < 1e-17. */
	double s = (m - 1) / (m + 1), t = s * s;
	double series = 1.0 / 19;
	series = series * t + 1.0 / 17;
	series = series * t + 1.0 / 15;
	series = series * t + 1.0 / 13;
	series = series * t + 1.0 / 11;
	series = series * t + 1.0 / 9;
	series = series * t + 1.0 / 7;
	series = series * t + 1.0 / 5;
	series = series * t + 1.0 / 3;
	return octave * 0.69314718055994530942 + (2 * s + 2 * s * t * series);
}

/* |x| < 80. Relative error below 2e-7. */
static inline float esk_elementary_exp(float x)
{
	/* exp x = 2^n exp r, |r| <= ln 2 / 2. Adding and subtracting 1.5 * 2^23 rounds to the nearest integer; ln 2 is
	 * taken off in two parts, the first short enough for n times it to be exact. */
	const float round = 12582912.0f;
	float n = (x * 1.44269504f + round) - round;
	float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
	/* Taylor; the first term left out is r^8 / 8! < 6e-9. */
	float p = 1.0f / 5040;
	p = p * r + 1.0f / 720;
	p = p * r + 1.0f / 120;
	p = p * r + 1.0f / 24;
	p = p * r + 1.0f / 6;
	p = p * r + 0.5f;
	p = p * r + 1.0f;
	p = p * r + 1.0f;
	int32_t bits = ((int32_t)n + 127) * (1 << 23);
	float power;
	memcpy(&power, &bits, sizeof power);
	return p * power;
}

/* |x| < 700. Relative error below 1e-14. As esk_elementary_exp, in doubles. */
static inline double esk_elementary_exp_double(double x)
{
	const double round = 0x1.8p52;
	double shifted = x * 1.4426950408889634 + round, n = shifted - round;
	double r = (x - n * 0x1.62e42fefap-1) + n * -0x1.cf79abc9e3b39p-40;
	/* Taylor; the first term left out is r^12 / 12! < 7e-15. */
	double p = 1.0 / 39916800;
	p = p * r + 1.0 / 3628800;
	p = p * r + 1.0 / 362880;
	p = p * r + 1.0 / 40320;
	p = p * r + 1.0 / 5040;
	p = p * r + 1.0 / 720;
	p = p * r + 1.0 / 120;
	p = p * r + 1.0 / 24;
	p = p * r + 1.0 / 6;
	p = p * r + 0.5;
	p = p * r + 1;
	p = p * r + 1;
	/* n is in the last bits of shifted, and what the others hold is shifted out. */
	uint64_t bits, octaves;
	memcpy(&bits, &shifted, sizeof bits);
	octaves = (bits + 1023) << 52;
	double power;
	memcpy(&power, &octaves, sizeof power);
	return p * power;
}

/* x positive and normal, |ln x| < 240. Two Newton steps take the relative error from 1e-6 to rounding. */
static inline double esk_elementary_cbrt(double x)
{
	double root = (double)esk_elementary_exp((float)(esk_elementary_log(x) / 3));
	root -= (root - x / (root * root)) / 3;
	root -= (root - x / (root * root)) / 3;
	return root;
}

/* |x| < 1e5. Absolute error below 1e-15 |x| + 1e-15. */
static inline void esk_elementary_sine_cosine(double x, double *sine, double *cosine)
{
	/* x = n pi / 2 + r, |r| <= pi / 4; rounding as above, pi / 2 in two parts. */
	const double round = 0x1.8p52;
	double shifted = x * 0.63661977236758134 + round, n = shifted - round;
	double r = (x - n * 0x1.921fb544p0) - n * 0x1.0b4611a626331p-34, t = r * r;
	/* Taylor; the first terms left out are r^17 / 17! < 5e-17 and r^18 / 18! < 3e-18. */
	double s = -1.0 / 1307674368000;
	s = s * t + 1.0 / 6227020800;
	s = s * t - 1.0 / 39916800;
	s = s * t + 1.0 / 362880;
	s = s * t - 1.0 / 5040;
	s = s * t + 1.0 / 120;
	s = s * t - 1.0 / 6;
	s = r + r * t * s;
	double c = 1.0 / 20922789888000;
	c = c * t - 1.0 / 87178291200;
	c = c * t + 1.0 / 479001600;
	c = c * t - 1.0 / 3628800;
	c = c * t + 1.0 / 40320;
	c = c * t - 1.0 / 720;
	c = c * t + 1.0 / 24;
	c = 1 + t * (c * t - 0.5);
	/* A quarter turn takes (s, c) to (c, -s); n is in the last bits of shifted. */
	uint64_t turns;
	memcpy(&turns, &shifted, sizeof turns);
	double first = turns & 1 ? c : s, second = turns & 1 ? -s : c;
	*sine = turns & 2 ? -first : first;
	*cosine = turns & 2 ? -second : second;
}

/* Through memory: when gcc 12 joins two neighbours in a vector it drops a conversion to float and back, at -O2 already. */
static inline double esk_elementary_round_to_float(double x)
{
	volatile float rounded = (float)x;
	return (double)rounded;
}

#endif
