/* Minimum-cost matching by shortest augmenting paths.
 *
 * After Jonker and Volgenant, "A shortest augmenting path algorithm for dense and sparse linear assignment problems"
 * (Computing 38, 1987), without their reduction transfer, which does not pay for k <= 64.
 *
 * Linear programming duality: with a price v_j on every column, let u_i = min_j (c_ij - v_j). Any matching costs at
 * least sum u_i + sum v_j, and a matching of tight pairs (c_ij - v_j = u_i) costs exactly that, so it is optimal. The
 * invariant of every step is that matched pairs are tight. Three steps of growing cost match the rows: columns offer
 * themselves to their cheapest row; rows bid for their cheapest column and displace who has it; the rows that are left
 * find a free column along a shortest path. Only v is stored: u_i follows from the column that row i has, so
 * tightness cannot be lost to rounding.
 *
 * The paper expects O(k^2 + log k) (section 5.2.2); no such algorithm exists for dense costs, this one is O(k^3). */
#include "assignment.h"

#include "eskel.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

#define NONE UINT32_MAX

/* Rows are padded to whole groups of lanes with columns that cost too much for anyone, so that loops over columns become
 * vector code, with the same results at any width. */
enum { LANES = 8, WIDTH_MAX = ESKEL_LEVELS_MAX };

typedef struct {
	uint32_t k, width; /* width: k rounded up to whole groups */
	float costs[ESKEL_LEVELS_MAX * WIDTH_MAX];
	float price[WIDTH_MAX];
	uint32_t row_of_column[WIDTH_MAX]; /* NONE: free */
	uint32_t column_of_row[ESKEL_LEVELS_MAX];
	uint32_t free_rows[ESKEL_LEVELS_MAX], free_count;
} problem;

static void set_up(problem *p, uint32_t k, const float *costs)
{
	p->k = k;
	p->width = (k + LANES - 1) / LANES * LANES;
	for (uint32_t i = 0; i < k; i++) {
		memcpy(p->costs + i * p->width, costs + i * k, k * sizeof *costs);
		for (uint32_t j = k; j < p->width; j++)
			p->costs[i * p->width + j] = INFINITY;
	}
}

/* Prices of the least cost of each column make all pairs feasible and one row of each column tight; a row that is
 * tight for several columns takes the lowest. */
static void reduce_columns(problem *p)
{
	uint32_t cheapest[WIDTH_MAX] = {0};
	for (uint32_t j = 0; j < p->width; j++)
		p->price[j] = INFINITY;
	for (uint32_t i = 0; i < p->k; i++)
		for (uint32_t j = 0; j < p->width; j++) {
			const float cost = p->costs[i * p->width + j];
			cheapest[j] = cost < p->price[j] ? i : cheapest[j];
			p->price[j] = cost < p->price[j] ? cost : p->price[j];
		}
	for (uint32_t i = 0; i < p->k; i++)
		p->column_of_row[i] = NONE;
	for (uint32_t j = 0; j < p->width; j++) {
		p->row_of_column[j] = NONE;
		if (j >= p->k) {
			p->price[j] = 0;
		} else if (p->column_of_row[cheapest[j]] == NONE) {
			p->column_of_row[cheapest[j]] = j;
			p->row_of_column[j] = cheapest[j];
		}
	}
	p->free_count = 0;
	for (uint32_t i = 0; i < p->k; i++)
		if (p->column_of_row[i] == NONE)
			p->free_rows[p->free_count++] = i;
}

static float least_of(const float *values, uint32_t width)
{
	float least[LANES];
	memcpy(least, values, sizeof least);
	for (uint32_t j = LANES; j < width; j += LANES)
		for (uint32_t lane = 0; lane < LANES; lane++)
			least[lane] = values[j + lane] < least[lane] ? values[j + lane] : least[lane];
	for (uint32_t half = LANES / 2; half > 0; half /= 2)
		for (uint32_t lane = 0; lane < half; lane++)
			least[lane] = least[lane + half] < least[lane] ? least[lane + half] : least[lane];
	return least[0];
}

/* The lowest place of a value that is there. */
static uint32_t place_of(const float *values, float value)
{
	uint32_t j = 0;
	while (values[j] != value)
		j++;
	return j;
}

/* Row i takes its cheapest column, whose price falls until the second cheapest would do as well. Returns the row that had
 * the column, or NONE. */
static uint32_t bid(problem *p, uint32_t i, bool *price_fell)
{
	float reduced[WIDTH_MAX];
	for (uint32_t j = 0; j < p->width; j++)
		reduced[j] = p->costs[i * p->width + j] - p->price[j];
	const float least = least_of(reduced, p->width);
	const uint32_t cheapest = place_of(reduced, least);
	reduced[cheapest] = INFINITY;
	const float second = least_of(reduced, p->width);
	uint32_t column = cheapest;
	*price_fell = least < second;
	if (*price_fell)
		p->price[cheapest] -= second - least;
	else if (p->row_of_column[cheapest] != NONE)
		column = place_of(reduced, second);
	const uint32_t displaced = p->row_of_column[column];
	p->row_of_column[column] = i;
	p->column_of_row[i] = column;
	if (displaced != NONE)
		p->column_of_row[displaced] = NONE;
	return displaced;
}

/* A displaced row bids at once if a price fell for it, else in the next round. Bids are limited, because a price can fall
 * by less than its rounding, and then nothing would change for ever. */
static void bid_for_columns(problem *p)
{
	uint32_t bids_left = 4 * p->k;
	for (int round = 0; round < 2; round++) {
		const uint32_t count = p->free_count;
		p->free_count = 0;
		for (uint32_t n = 0; n < count; n++) {
			uint32_t row = p->free_rows[n];
			bool price_fell = true;
			while (row != NONE && price_fell && bids_left > 0) {
				row = bid(p, row, &price_fell);
				bids_left--;
			}
			if (row != NONE)
				p->free_rows[p->free_count++] = row;
		}
	}
}

/* Dijkstra from a free row over reduced costs: length[j] is that of the shortest alternating path to column j which
 * leaves matched rows by settled columns only, came_from[j] the row before j on it. */
typedef struct {
	float length[WIDTH_MAX]; /* minus infinity once settled, so that no path is shorter */
	float open[WIDTH_MAX];   /* the same, but infinite once settled */
	float settled[WIDTH_MAX];
	uint32_t came_from[WIDTH_MAX];
	uint32_t order[WIDTH_MAX], settled_count;
} path_tree;

static void settle(path_tree *tree, uint32_t column)
{
	tree->settled[column] = tree->open[column];
	tree->length[column] = -INFINITY;
	tree->open[column] = INFINITY;
	tree->order[tree->settled_count++] = column;
}

/* Paths through the row that has a column just settled. */
static void extend_paths(const problem *p, path_tree *tree, uint32_t column)
{
	const uint32_t row = p->row_of_column[column];
	const float *costs = p->costs + row * p->width;
	const float offset = (costs[column] - p->price[column]) - tree->settled[column];
	for (uint32_t j = 0; j < p->width; j++) {
		const float through = (costs[j] - p->price[j]) - offset;
		const bool shorter = through < tree->length[j];
		tree->length[j] = shorter ? through : tree->length[j];
		tree->open[j] = shorter ? through : tree->open[j];
		tree->came_from[j] = shorter ? row : tree->came_from[j];
	}
}

/* The nearest free column; on return the settled columns are those nearer than it. */
static uint32_t find_free_column(const problem *p, uint32_t free_row, path_tree *tree)
{
	tree->settled_count = 0;
	for (uint32_t j = 0; j < p->width; j++) {
		tree->length[j] = p->costs[free_row * p->width + j] - p->price[j];
		tree->open[j] = tree->length[j];
		tree->came_from[j] = free_row;
	}
	for (;;) {
		const uint32_t column = place_of(tree->open, least_of(tree->open, p->width));
		if (p->row_of_column[column] == NONE)
			return column;
		settle(tree, column);
		extend_paths(p, tree, column);
	}
}

/* Prices of settled columns fall by how much nearer they are than the free column, which makes the path tight. */
static void match_along_path(problem *p, uint32_t free_row)
{
	path_tree tree;
	uint32_t column = find_free_column(p, free_row, &tree), row;
	const float length = tree.open[column];
	for (uint32_t n = 0; n < tree.settled_count; n++)
		p->price[tree.order[n]] -= length - tree.settled[tree.order[n]];
	do {
		row = tree.came_from[column];
		p->row_of_column[column] = row;
		uint32_t next = p->column_of_row[row];
		p->column_of_row[row] = column;
		column = next;
	} while (row != free_row);
}

#ifndef NDEBUG
/* Every price is the result of a few times k subtractions, each wrong by half a unit in the last place of the largest
 * number in play. */
static bool is_optimal(const problem *p)
{
	float largest = 0;
	for (uint32_t j = 0; j < p->k; j++) {
		largest = fmaxf(largest, fabsf(p->price[j]));
		for (uint32_t i = 0; i < p->k; i++)
			largest = fmaxf(largest, p->costs[i * p->width + j]);
	}
	const float tolerance = 8 * (float)p->k * FLT_EPSILON * largest;
	for (uint32_t i = 0; i < p->k; i++) {
		const uint32_t matched = p->column_of_row[i];
		if (matched >= p->k || p->row_of_column[matched] != i)
			return false;
		const float u = p->costs[i * p->width + matched] - p->price[matched];
		for (uint32_t j = 0; j < p->k; j++)
			if (p->costs[i * p->width + j] - p->price[j] < u - tolerance)
				return false;
	}
	return true;
}
#endif

double esk_assignment_solve(uint32_t k, const float *costs, uint32_t *column_of_row)
{
	problem p;
	set_up(&p, k, costs);
	reduce_columns(&p);
	if (p.free_count > 0)
		bid_for_columns(&p);
	for (uint32_t n = 0; n < p.free_count; n++)
		match_along_path(&p, p.free_rows[n]);
	assert(is_optimal(&p));
	double sum = 0;
	for (uint32_t i = 0; i < k; i++) {
		column_of_row[i] = p.column_of_row[i];
		sum += (double)costs[i * k + p.column_of_row[i]];
	}
	return sum;
}
