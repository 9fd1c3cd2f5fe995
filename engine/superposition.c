/* Superposition of skeletons, level by level.
 *
 * The paper tells left from right by the sign of a determinant over classes that are matched by signature (section 5.5;
 * determinant.c). But signatures do not change under reflection, so classes that are alike get exchanged across the
 * mirror plane, and the sign becomes a coin toss. Here classes are compared by where they lie.
 *
 * Both shapes are put in a natural frame. The order and the signs of its axes are undefined when eigenvalues are close,
 * so b starts from all 48 signed permutations of the axes, 24 of them rotations and 24 reflections. Then, as in the
 * iterative closest point method (Besl and McKay, 1992), every class is paired with the nearest of the other shape, b is
 * turned so that paired centres superpose, and so on. A turn is proper, so a start of either hand keeps its hand. Of
 * each hand the least cost counts, at every level by itself: partitions of like shapes differ from level to level, and
 * independent errors average out.
 *
 * The cost is the mean distance from a class to the nearest one of the other shape, over all matter of both shapes:
 * roughly how far the matter of one has to go to become the other. Nothing in it is tuned. The bijection of least cost in
 * place of the nearest class is slower and no better: where two partitions of one shape differ it has to give some class
 * a partner elsewhere (decided of 116 brain regions resampled at 2 and 3 mm: 111 and 95 by nearest classes, 106 and 90
 * by bijection; equal on bones; neither was wrong). */
#include "superposition.h"

#include "natural_frame.h"
#include "rotation.h"

#include <math.h>
#include <string.h>

enum {
	FRAMES = 24, /* of each hand */
	/* Starts of each hand that are followed, chosen by their cost before any turn at one level, deep enough to show
	 * the shape. Of 505 pairs of bones and brain regions 2 get another verdict than by all 24 starts, 5 with 4
	 * starts; time grows in proportion. */
	STARTS = 8,
	START_LEVEL = 8,
	TURNS = 4, /* most starts settle after two or three */
	COLUMNS = ESK_PLACED_CLASSES_MAX,
};

/* For each class of a level, the nearest class of the other shape, and the square of its distance. */
typedef struct {
	int64_t index[COLUMNS]; /* as wide as a double: both go through the same vector code */
	double square[COLUMNS];
} nearest;

typedef struct {
	nearest of_a, of_b;
} pairing;

/* Frame f of FRAMES of a hand: cyclic or transposed order of the axes, and signs that make the determinant's sign. */
static void make_frame(int f, bool proper, double frame[3][3])
{
	static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
	int permutation = f / 4;
	double first = f & 1 ? -1 : 1, second = f & 2 ? -1 : 1;
	double parity = permutation < 3 ? 1 : -1, hand = proper ? 1 : -1;
	const double sign[3] = {first, second, first * second * parity * hand};
	memset(frame, 0, 9 * sizeof frame[0][0]);
	for (int r = 0; r < 3; r++)
		frame[r][order[permutation][r]] = sign[r];
}

/* Squared distances of class i of a to every class of b. */
static void square_distances(const esk_placed_level *a, uint32_t i, const esk_placed_level *b, double square[COLUMNS])
{
	memset(square, 0, COLUMNS * sizeof square[0]);
	for (int c = 0; c < ESK_PLACED_COORDINATES; c++) {
		double from = a->at[c][i];
		for (int j = 0; j < COLUMNS; j++) {
			double d = b->at[c][j] - from;
			square[j] += d * d;
		}
	}
}

/* The first of equals. */
static void find_nearest(const esk_placed_level *a, const esk_placed_level *b, pairing *pairs)
{
	nearest *of_a = &pairs->of_a, *of_b = &pairs->of_b;
	for (int j = 0; j < COLUMNS; j++) {
		of_b->index[j] = 0;
		of_b->square[j] = INFINITY;
	}
	for (uint32_t i = 0; i < a->count; i++) {
		double square[COLUMNS];
		square_distances(a, i, b, square);
		for (int j = 0; j < COLUMNS; j++) {
			bool less = square[j] < of_b->square[j];
			of_b->index[j] = less ? (int64_t)i : of_b->index[j];
			of_b->square[j] = less ? square[j] : of_b->square[j];
		}
		uint32_t best = 0;
		for (uint32_t j = 1; j < b->count; j++)
			if (square[j] < square[best])
				best = j;
		of_a->index[i] = best;
		of_a->square[i] = square[best];
	}
}

static double mean_distance(const esk_placed_level *level, const nearest *n)
{
	double sum = 0;
	for (uint32_t i = 0; i < level->count; i++)
		sum += level->share[i] * sqrt(n->square[i]);
	return sum;
}

static void correlate(double share, const esk_placed_level *a, int64_t i, const esk_placed_level *b, int64_t j,
	double correlation[3][3])
{
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			correlation[r][c] += share * (a->at[r][i] * b->at[c][j]);
}

/* Turns b about the common centre so that paired centres superpose. */
static void turn(const esk_placed_level *a, esk_placed_level *b, const pairing *pairs)
{
	double correlation[3][3] = {{0}}, rotation[3][3];
	for (uint32_t i = 0; i < a->count; i++)
		correlate(a->share[i], a, i, b, pairs->of_a.index[i], correlation);
	for (uint32_t j = 0; j < b->count; j++)
		correlate(b->share[j], a, pairs->of_b.index[j], b, j, correlation);
	esk_rotation_fit((const double(*)[3])correlation, rotation);
	esk_placed_move((const double(*)[3])rotation, b);
}

static bool same_pairs(const pairing *p, const pairing *q, uint32_t count)
{
	size_t size = count * sizeof p->of_a.index[0];
	return memcmp(p->of_a.index, q->of_a.index, size) == 0 && memcmp(p->of_b.index, q->of_b.index, size) == 0;
}

/* The least cost on the way from one start. Unchanged pairs would only ask for the turn just made. */
static double follow(const esk_placed_level *a, const esk_placed_level *b, const double frame[3][3], int turns)
{
	esk_placed_level moved = *b;
	esk_placed_move(frame, &moved);
	double least = INFINITY;
	pairing pairs[2];
	for (int t = 0;; t++) {
		pairing *now = &pairs[t & 1];
		find_nearest(a, &moved, now);
		least = fmin(least, (mean_distance(a, &now->of_a) + mean_distance(&moved, &now->of_b)) / 2);
		if (t == turns || (t > 0 && same_pairs(&pairs[0], &pairs[1], a->count)))
			return least;
		turn(a, &moved, now);
	}
}

/* Writes the most promising frames of a hand; the first of equals. */
static void choose_starts(
	const esk_placed_level *a, const esk_placed_level *b, bool proper, double starts[STARTS][3][3])
{
	double frames[FRAMES][3][3], costs[FRAMES];
	for (int f = 0; f < FRAMES; f++) {
		make_frame(f, proper, frames[f]);
		costs[f] = follow(a, b, (const double(*)[3])frames[f], 0);
	}
	for (int s = 0; s < STARTS; s++) {
		int best = 0;
		for (int f = 1; f < FRAMES; f++)
			if (costs[f] < costs[best])
				best = f;
		memcpy(starts[s], frames[best], sizeof starts[s]);
		costs[best] = INFINITY;
	}
}

static double least_cost(const esk_placed_level *a, const esk_placed_level *b, double starts[STARTS][3][3])
{
	double least = INFINITY;
	for (int s = 0; s < STARTS; s++)
		least = fmin(least, follow(a, b, (const double(*)[3])starts[s], TURNS));
	return least;
}

void esk_superposition_costs(
	const eskel_skeleton *a, const eskel_skeleton *b, uint32_t last, double *proper, double *improper)
{
	esk_placed_level placed_a, placed_b;
	double proper_starts[STARTS][3][3], improper_starts[STARTS][3][3], sums[2] = {0, 0};
	uint32_t start_level = last < START_LEVEL ? last : START_LEVEL;
	esk_natural_frame_place(a, start_level, &placed_a);
	esk_natural_frame_place(b, start_level, &placed_b);
	choose_starts(&placed_a, &placed_b, true, proper_starts);
	choose_starts(&placed_a, &placed_b, false, improper_starts);
	for (uint32_t k = ESK_SUPERPOSITION_FIRST_LEVEL; k <= last; k++) {
		esk_natural_frame_place(a, k, &placed_a);
		esk_natural_frame_place(b, k, &placed_b);
		sums[0] += least_cost(&placed_a, &placed_b, proper_starts);
		sums[1] += least_cost(&placed_a, &placed_b, improper_starts);
	}
	*proper = sums[0];
	*improper = sums[1];
}
