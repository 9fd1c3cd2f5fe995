#include "scores.h"

enum { STEP = ESKEL_LEVELS_MAX }; /* between scores, so that the class index fits in */

/* numerator / denominator to the nearest integer, halves away from 0: symmetric, so that mirroring commutes. */
static esk_int128 divide_rounded(esk_int128 numerator, esk_int128 denominator)
{
	esk_int128 half = denominator / 2;
	return (numerator < 0 ? numerator - half : numerator + half) / denominator;
}

/* With g = S / w: b 2^shift = T S 2^shift / w. The numerator stays below 2^(44 + 44): |T g| half 2^shift < 2^44 by the
 * choice of shift, and w <= 2^44; so does |T S| <= 3 2^40 2^60 alone when shift is negative. */
void esk_scores_set(esk_scores *scores, uint32_t index, const esk_metric *metric, const esk_sums *sums)
{
	const int shift = metric->shift;
	const esk_int128 denominator = (esk_int128)sums->weight << (shift < 0 ? -shift : 0);
	esk_int128 constant = 0;
	for (int r = 0; r < 3; r++) {
		esk_int128 numerator = 0;
		for (int c = 0; c < 3; c++)
			numerator += (esk_int128)metric->form[r][c] * sums->first[c];
		if (shift > 0)
			numerator *= (esk_int128)1 << shift;
		const esk_int128 b = divide_rounded(numerator, denominator);
		constant += b * sums->first[r];
		scores->slope[r][index] = (double)(-2 * STEP * b);
	}
	scores->constant[index] = (double)(STEP * divide_rounded(constant, sums->weight) + index);
}

void esk_scores_set_plane(esk_scores *scores, const int64_t normal[3], int64_t threshold)
{
	*scores = (esk_scores){.count = 2};
	for (int r = 0; r < 3; r++)
		scores->slope[r][1] = (double)(-2 * STEP * normal[r]);
	scores->constant[1] = (double)(2 * STEP * threshold + 1);
}
