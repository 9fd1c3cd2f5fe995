#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

uint64_t synthetic_random(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
	z = (z ^ z >> 27) * 0x94d049bb133111eb;
	return z ^ z >> 31;
}

double synthetic_uniform(uint64_t *state)
{
	return (double)(synthetic_random(state) >> 11) * 0x1p-53;
}

typedef struct {
	double side[3], centre[3], filled;
} box;

/* One stream for what the cluster has in common, one for what is the member's own. */
typedef struct {
	uint64_t cluster, member;
	double noise;
} source;

/* In (-1, 1) up to the member's noise. */
static double draw(source *s)
{
	double common = 2 * synthetic_uniform(&s->cluster) - 1, own = 2 * synthetic_uniform(&s->member) - 1;
	return common + s->noise * own;
}

static int longest_axis(const box *b)
{
	int longest = 0;
	for (int axis = 1; axis < 3; axis++)
		if (b->side[axis] > b->side[longest])
			longest = axis;
	return longest;
}

/* Cuts across the longest axis near the middle, and carves a little off both parts. */
static void split(source *s, box *whole, box *part)
{
	const int axis = longest_axis(whole);
	const double fraction = 0.5 + 0.15 * draw(s), length = whole->side[axis];
	*part = *whole;
	whole->side[axis] = fraction * length;
	whole->centre[axis] -= (1 - fraction) * length / 2;
	part->side[axis] = (1 - fraction) * length;
	part->centre[axis] += fraction * length / 2;
	box *both[2] = {whole, part};
	for (int b = 0; b < 2; b++) {
		both[b]->filled *= 0.97 + 0.02 * draw(s);
		for (int a = 0; a < 3; a++) {
			both[b]->side[a] *= 0.95 + 0.04 * draw(s);
			both[b]->centre[a] += 0.05 * both[b]->side[a] * draw(s);
		}
	}
}

/* Through memory: gcc 12 may drop the conversion (engine/elementary.h). */
static double to_float(double x)
{
	volatile float rounded = (float)x;
	return (double)rounded;
}

static void write_row(const box *b, double row[ESKEL_SIGNATURE_NUMBERS])
{
	double lengths[3] = {b->side[0], b->side[1], b->side[2]};
	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2 - i; j++)
			if (lengths[j] < lengths[j + 1]) {
				double swap = lengths[j];
				lengths[j] = lengths[j + 1];
				lengths[j + 1] = swap;
			}
	for (int i = 0; i < 3; i++)
		row[i] = to_float(lengths[i] / sqrt(12));
	const double *g = b->centre;
	row[3] = to_float(sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]));
	row[4] = to_float(b->filled);
}

eskel_signature *synthetic_signature(uint64_t cluster, uint64_t member, double noise, uint32_t levels)
{
	source s = {cluster * 1000003, (cluster << 32) ^ member, noise};
	eskel_signature *made = malloc(sizeof *made);
	box boxes[ESKEL_LEVELS_MAX];
	if (!made || !(made->rows = malloc(ESKEL_NODES(levels) * sizeof *made->rows))) {
		fputs("memory ran out\n", stderr);
		exit(1);
	}
	boxes[0] = (box){.centre = {0, 0, 0}, .filled = 0.8 + 0.15 * draw(&s)};
	for (int axis = 0; axis < 3; axis++)
		boxes[0].side[axis] = 40 * exp(0.8 * draw(&s));
	made->level_count = levels;
	made->volume = boxes[0].filled * boxes[0].side[0] * boxes[0].side[1] * boxes[0].side[2];
	for (uint32_t k = 1; k <= levels; k++) {
		if (k > 1) {
			uint32_t largest = 0;
			for (uint32_t i = 1; i < k - 1; i++)
				if (boxes[i].side[longest_axis(&boxes[i])] >
					boxes[largest].side[longest_axis(&boxes[largest])])
					largest = i;
			split(&s, &boxes[largest], &boxes[k - 1]);
		}
		for (uint32_t i = 0; i < k; i++)
			write_row(&boxes[i], made->rows[ESKEL_NODES(k - 1) + i]);
	}
	return made;
}
