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
 * each hand every level proposes the pose of least cost: partitions of like shapes differ from level to level, and where
 * some mislead others do not.
 *
 * Eight poses of b are compared at once, one a lane. Most starts of a level are soon found to be hopeless or to go the
 * way of another one, so the poses that are left close ranks after every turn.
 *
 * The cost is the mean distance from a class to the nearest one of the other shape, over all matter of both shapes:
 * roughly how far the matter of one has to go to become the other. Nothing in it is tuned. The bijection of least cost in
 * place of the nearest class is slower and no better: where two partitions of one shape differ it has to give some class
 * a partner elsewhere. */
#include "superposition.h"

#include "rotation.h"

#include <math.h>
#include <string.h>

enum {
	HANDS = 2,
	FRAMES = 24, /* of each hand */
	/* Few, so that classes that are no counterparts do not fit by chance: of 396 pairs of bones and brain regions the
	 * hand is right for 376, 377, 375, 371 and 371 with 1, 2, 3, 4 and 6. */
	TURNS = 2,
	/* Where one pose serves all levels, turns go on: a viewer sees a pose that is a little off. In 126 pairs of bones of
	 * one class the residual is within 0.03 mm of that after 40 turns. */
	WHOLE_TURNS = 12,
	POSES_MAX = HANDS * FRAMES,
	CLASSES = ESK_PLACED_CLASSES_MAX,
};

/* A pose is given up when it costs this many times the best of its hand. Every sign in 396 pairs is as with 4; with 2 one
 * more of 122 cut bones is wrong. */
static const double hopeless = 2.5;
/* Costs of like poses differ by rounding; those of others do not agree to so many digits. */
static const double alike = 1e-9;

/* Pose p is lane p % ESK_LANES of group p / ESK_LANES. */
typedef struct {
	int count;
	int hand[POSES_MAX];
	double cost[POSES_MAX]; /* as last compared; 0 before */
	esk_lanes orthogonal[POSES_MAX / ESK_LANES][3][3];
} pose_set;

/* Of a class, the square of the distance to the nearest class of the other shape, and the centre of that. */
typedef struct {
	esk_lanes square, centre[3];
} nearest;

typedef struct {
	nearest of_a[CLASSES], of_b[CLASSES];
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

static void init_poses(pose_set *poses)
{
	*poses = (pose_set){0};
	for (int hand = 0; hand < HANDS; hand++)
		for (int f = 0; f < FRAMES; f++) {
			double frame[3][3];
			int p = poses->count++;
			make_frame(f, hand == 0, frame);
			poses->hand[p] = hand;
			for (int e = 0; e < 9; e++)
				poses->orthogonal[p / ESK_LANES][e / 3][e % 3][p % ESK_LANES] = frame[e / 3][e % 3];
		}
}

/* Appends pose p of some poses. Both may be the same ones when no more than p are kept so far. */
static void keep_pose(const pose_set *from, int p, pose_set *to)
{
	int q = to->count++;
	to->hand[q] = from->hand[p];
	to->cost[q] = from->cost[p];
	for (int e = 0; e < 9; e++)
		to->orthogonal[q / ESK_LANES][e / 3][e % 3][q % ESK_LANES] =
			from->orthogonal[p / ESK_LANES][e / 3][e % 3][p % ESK_LANES];
}

/* The first of equals. */
ESK_IN_LANES void offer(double square, double x, double y, double z, int l, nearest *n)
{
	bool less = square < n->square[l];
	n->square[l] = less ? square : n->square[l];
	n->centre[0][l] = less ? x : n->centre[0][l];
	n->centre[1][l] = less ? y : n->centre[1][l];
	n->centre[2][l] = less ? z : n->centre[2][l];
}

ESK_EVERY_WIDTH static void find_nearest(
	const esk_placed_class *a, const esk_posed_level *b, uint32_t count, pairing *pairs)
{
	for (uint32_t i = 0; i < count; i++)
		ESK_EACH_LANE (l)
			pairs->of_a[i].square[l] = pairs->of_b[i].square[l] = INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		nearest of_a = pairs->of_a[i];
		for (uint32_t j = 0; j < count; j++) {
			nearest *of_b = &pairs->of_b[j];
			ESK_EACH_LANE (l) {
				double square = 0;
				for (int c = 0; c < ESK_PLACED_COORDINATES; c++) {
					double d = b->at[c][j][l] - a[i].at[c];
					square += d * d;
				}
				offer(square, b->at[0][j][l], b->at[1][j][l], b->at[2][j][l], l, &of_a);
				offer(square, a[i].at[0], a[i].at[1], a[i].at[2], l, of_b);
			}
		}
		pairs->of_a[i] = of_a;
	}
}

ESK_EVERY_WIDTH static void find_costs(
	const esk_placed_class *a, const esk_placed_class *b, uint32_t count, const pairing *pairs, double *costs)
{
	esk_lanes sum = {0};
	for (uint32_t i = 0; i < count; i++)
		ESK_EACH_LANE (l)
			sum[l] += a[i].share * sqrt(pairs->of_a[i].square[l]) +
				  b[i].share * sqrt(pairs->of_b[i].square[l]);
	ESK_EACH_LANE (l)
		costs[l] = sum[l] / 2;
}

/* Of paired centres, weighted by share. */
ESK_EVERY_WIDTH static void correlate(const esk_placed_class *a, const esk_placed_class *b, uint32_t count,
	const esk_posed_level *posed, const pairing *pairs, esk_lanes correlation[3][3])
{
	esk_lanes sum[3][3] = {{{0}}};
	for (uint32_t i = 0; i < count; i++)
		for (int r = 0; r < 3; r++)
			for (int c = 0; c < 3; c++)
				ESK_EACH_LANE (l)
					sum[r][c][l] += a[i].share * (a[i].at[r] * pairs->of_a[i].centre[c][l]) +
							b[i].share * (pairs->of_b[i].centre[r][l] * posed->at[c][i][l]);
	memcpy(correlation, sum, sizeof sum);
}

/* orthogonal = rotation orthogonal */
static void turn(const esk_lanes rotation[3][3], esk_lanes orthogonal[3][3])
{
	esk_lanes out[3][3];
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++)
			ESK_EACH_LANE (l)
				out[r][c][l] = rotation[r][0][l] * orthogonal[0][c][l] +
					       rotation[r][1][l] * orthogonal[1][c][l] +
					       rotation[r][2][l] * orthogonal[2][c][l];
	memcpy(orthogonal, out, sizeof out);
}

/* One level of both shapes, and how it looks in eight poses. */
typedef struct {
	const esk_placed_class *a, *b;
	uint32_t count;
	esk_posed_level posed;
	pairing pairs;
} comparison;

static void begin_level(comparison *c, const esk_placed_class *a, const esk_placed_class *b, uint32_t level)
{
	c->a = a + ESKEL_NODES(level - 1);
	c->b = b + ESKEL_NODES(level - 1);
	c->count = level;
}

/* Compares a with b in eight poses. */
static void compare(comparison *c, const esk_lanes orthogonal[3][3], double *costs)
{
	esk_placed_pose(c->b, c->count, orthogonal, &c->posed);
	find_nearest(c->a, &c->posed, c->count, &c->pairs);
	find_costs(c->a, c->b, c->count, &c->pairs, costs);
}

/* Turns b, as last compared, about the common centre so that paired centres superpose. */
static void superpose(const comparison *c, esk_lanes orthogonal[3][3])
{
	esk_lanes correlation[3][3], rotation[3][3];
	correlate(c->a, c->b, c->count, &c->posed, &c->pairs, correlation);
	esk_rotation_fit((const esk_lanes(*)[3])correlation, rotation);
	turn((const esk_lanes(*)[3])rotation, orthogonal);
}

static bool agree(double cost, double other)
{
	return fabs(cost - other) <= alike * cost;
}

/* Keeps the poses that may still lead to a lesser cost: not those that settled, nor those that another one stands for. */
static void close_ranks(const double least[HANDS], const double *before, pose_set *poses)
{
	int count = poses->count;
	poses->count = 0;
	for (int p = 0; p < count; p++) {
		double cost = poses->cost[p];
		bool wanted = cost <= hopeless * least[poses->hand[p]] && !agree(cost, before[p]);
		for (int q = 0; wanted && q < poses->count; q++)
			wanted = poses->hand[q] != poses->hand[p] || !agree(cost, poses->cost[q]);
		if (wanted)
			keep_pose(poses, p, poses);
	}
}

/* Remembers the poses of a group that are the best of their hand so far; the first of equals. */
static void remember_best(const pose_set *poses, int group, double least[HANDS], double best[HANDS][3][3])
{
	for (int l = 0; l < ESK_LANES; l++) {
		const int p = group * ESK_LANES + l, hand = poses->hand[p];
		if (p >= poses->count || !(poses->cost[p] < least[hand]))
			continue;
		least[hand] = poses->cost[p];
		for (int e = 0; e < 9; e++)
			best[hand][e / 3][e % 3] = poses->orthogonal[group][e / 3][e % 3][l];
	}
}

/* The best poses of a level. */
static void find_best(comparison *c, double best[HANDS][3][3])
{
	pose_set poses;
	double least[HANDS] = {INFINITY, INFINITY}, before[POSES_MAX];
	init_poses(&poses);
	for (int t = 0; t <= TURNS; t++) {
		memcpy(before, poses.cost, sizeof before);
		for (int g = 0; g * ESK_LANES < poses.count; g++) {
			esk_lanes(*orthogonal)[3] = poses.orthogonal[g];
			compare(c, (const esk_lanes(*)[3])orthogonal, &poses.cost[g * ESK_LANES]);
			remember_best(&poses, g, least, best);
			if (t < TURNS)
				superpose(c, orthogonal);
		}
		close_ranks(least, before, &poses);
	}
}

void esk_superposition_candidates(
	const esk_placed_class *a, const esk_placed_class *b, uint32_t last, esk_candidate_poses *candidates)
{
	comparison c;
	double best[HANDS][3][3];
	for (uint32_t l = 0; l < ESK_LANES; l++) {
		uint32_t level = ESK_SUPERPOSITION_FIRST_LEVEL + l;
		if (level <= last) {
			begin_level(&c, a, b, level);
			find_best(&c, best);
		}
		for (int e = 0; e < 9; e++) {
			candidates->proper[e / 3][e % 3][l] = best[0][e / 3][e % 3];
			candidates->improper[e / 3][e % 3][l] = best[1][e / 3][e % 3];
		}
	}
}

/* Adds a level's costs in eight poses, and its correlation. */
static void add_level(comparison *c, const esk_lanes orthogonal[3][3], double *costs, esk_lanes correlation[3][3])
{
	esk_lanes of_level[3][3];
	double costs_of_level[ESK_LANES];
	compare(c, orthogonal, costs_of_level);
	correlate(c->a, c->b, c->count, &c->posed, &c->pairs, of_level);
	for (int l = 0; l < ESK_LANES; l++)
		costs[l] += costs_of_level[l];
	for (int e = 0; e < 9; e++)
		ESK_EACH_LANE (l)
			correlation[e / 3][e % 3][l] += of_level[e / 3][e % 3][l];
}

void esk_superposition_poses(const esk_placed_class *a, const esk_placed_class *b, uint32_t last, double best[2][3][3])
{
	comparison c;
	pose_set poses;
	double least[HANDS] = {INFINITY, INFINITY};
	init_poses(&poses);
	for (int t = 0; t <= WHOLE_TURNS; t++)
		for (int g = 0; g * ESK_LANES < poses.count; g++) {
			esk_lanes(*orthogonal)[3] = poses.orthogonal[g], correlation[3][3] = {{{0}}}, rotation[3][3];
			double costs[ESK_LANES] = {0};
			for (uint32_t k = 1; k <= last; k++) {
				begin_level(&c, a, b, k);
				add_level(&c, (const esk_lanes(*)[3])orthogonal, costs, correlation);
			}
			memcpy(&poses.cost[g * ESK_LANES], costs, sizeof costs);
			remember_best(&poses, g, least, best);
			esk_rotation_fit((const esk_lanes(*)[3])correlation, rotation);
			turn((const esk_lanes(*)[3])rotation, orthogonal);
		}
}
