#include "scores.h"

/* numerator / denominator to the nearest integer, halves away from 0: symmetric, so that mirroring commutes. */
static esk_int128 divide_rounded(esk_int128 numerator, esk_int128 denominator)
{
	esk_int128 half = denominator / 2;
	return (numerator < 0 ? numerator - half : numerator + half) / denominator;
}

/* With g = S / w: b = T S 2^shift / w. |T S| <= 3 2^40 2^60, and 2^shift is small when T and S are large: the score
 * bound of metric.c keeps b below 2^52, so the numerator stays below 2^(52 + 44 + 3). */
void esk_scores_set(esk_scores *scores, uint32_t index, const esk_metric *metric, const esk_sums *sums)
{
	const int shift = metric->shift;
	esk_int128 denominator = (esk_int128)sums->weight << (shift < 0 ? -shift : 0), constant = 0;
	for (int r = 0; r < 3; r++) {
		esk_int128 numerator = 0;
		for (int c = 0; c < 3; c++)
			numerator += (esk_int128)metric->form[r][c] * sums->first[c];
		if (shift > 0)
			numerator *= (esk_int128)1 << shift;
		esk_int128 b = divide_rounded(numerator, denominator);
		constant += b * sums->first[r];
		scores->slope[r][index] = (double)(-2 * b);
	}
	scores->constant[index] = (double)divide_rounded(constant, sums->weight);
}
