/* Minimum-cost matching by shortest augmenting paths.
 *
 * After Jonker and Volgenant, "A shortest augmenting path algorithm for dense and sparse linear assignment problems"
 * (Computing 38, 1987), without their transfer and row augmentation steps, which do not pay for k <= 64.
 *
 * Linear programming duality: with a price v_j on every column, let u_i = min_j (c_ij - v_j). Any matching costs at
 * least sum u_i + sum v_j, and a matching of tight pairs (c_ij - v_j = u_i) costs exactly that, so it is optimal. The
 * invariant of every step is that matched pairs are tight; rows are matched one after the other, and prices fall
 * along the shortest path on which the new row finds a free column. Only v is stored: u_i follows from the column
 * that row i has, so tightness cannot be lost to rounding.
 *
 * The paper expects O(k^2 + log k) (section 5.2.2); no such algorithm exists for dense costs, this one is O(k^3). */
#include "assignment.h"

#include "eskel.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#define NONE UINT32_MAX

typedef struct {
	uint32_t k;
	const float *costs;
	float price[ESKEL_LEVELS_MAX];
	uint32_t row_of_column[ESKEL_LEVELS_MAX]; /* NONE: free */
	uint32_t *column_of_row;
} problem;

/* Prices of the least cost of each column make all pairs feasible and one row of each column tight; a row that is
 * tight for several columns takes the lowest. */
static void reduce_columns(problem *p)
{
	for (uint32_t i = 0; i < p->k; i++)
		p->column_of_row[i] = NONE;
	for (uint32_t j = 0; j < p->k; j++) {
		uint32_t best = 0;
		for (uint32_t i = 1; i < p->k; i++)
			if (p->costs[i * p->k + j] < p->costs[best * p->k + j])
				best = i;
		p->price[j] = p->costs[best * p->k + j];
		p->row_of_column[j] = NONE;
		if (p->column_of_row[best] == NONE) {
			p->column_of_row[best] = j;
			p->row_of_column[j] = best;
		}
	}
}

/* Dijkstra from a free row over reduced costs: distance[j] is the length of the shortest alternating path to column j
 * that leaves matched rows by scanned columns only, came_from[j] the row before j on it. */
typedef struct {
	float distance[ESKEL_LEVELS_MAX];
	uint32_t came_from[ESKEL_LEVELS_MAX];
	bool scanned[ESKEL_LEVELS_MAX];
} path_tree;

static uint32_t nearest_unscanned(const path_tree *tree, uint32_t k)
{
	uint32_t nearest = NONE;
	for (uint32_t j = 0; j < k; j++)
		if (!tree->scanned[j] && (nearest == NONE || tree->distance[j] < tree->distance[nearest]))
			nearest = j;
	return nearest;
}

/* The nearest free column; on return the scanned columns are those nearer than it. */
static uint32_t find_free_column(const problem *p, uint32_t free_row, path_tree *tree)
{
	for (uint32_t j = 0; j < p->k; j++) {
		tree->distance[j] = p->costs[free_row * p->k + j] - p->price[j];
		tree->came_from[j] = free_row;
		tree->scanned[j] = false;
	}
	for (;;) {
		uint32_t column = nearest_unscanned(tree, p->k), row = p->row_of_column[column];
		if (row == NONE)
			return column;
		tree->scanned[column] = true;
		const float *costs = p->costs + row * p->k;
		float offset = (costs[column] - p->price[column]) - tree->distance[column];
		for (uint32_t j = 0; j < p->k; j++) {
			float through = (costs[j] - p->price[j]) - offset;
			if (!tree->scanned[j] && through < tree->distance[j]) {
				tree->distance[j] = through;
				tree->came_from[j] = row;
			}
		}
	}
}

/* Prices of scanned columns fall by how much nearer they are than the free column, which makes the path tight. */
static void match_row(problem *p, uint32_t free_row)
{
	path_tree tree;
	uint32_t column = find_free_column(p, free_row, &tree);
	for (uint32_t j = 0; j < p->k; j++)
		if (tree.scanned[j])
			p->price[j] -= tree.distance[column] - tree.distance[j];
	uint32_t row;
	do {
		row = tree.came_from[column];
		p->row_of_column[column] = row;
		uint32_t next = p->column_of_row[row];
		p->column_of_row[row] = column;
		column = next;
	} while (row != free_row);
}

#ifndef NDEBUG
/* Every price is the result of at most k subtractions, each wrong by half a unit in the last place of the largest
 * number in play. */
static bool is_optimal(const problem *p)
{
	float largest = 0;
	for (uint32_t j = 0; j < p->k; j++) {
		largest = fmaxf(largest, fabsf(p->price[j]));
		for (uint32_t i = 0; i < p->k; i++)
			largest = fmaxf(largest, p->costs[i * p->k + j]);
	}
	float tolerance = 4 * (float)p->k * FLT_EPSILON * largest;
	for (uint32_t i = 0; i < p->k; i++) {
		uint32_t matched = p->column_of_row[i];
		if (matched >= p->k || p->row_of_column[matched] != i)
			return false;
		float u = p->costs[i * p->k + matched] - p->price[matched];
		for (uint32_t j = 0; j < p->k; j++)
			if (p->costs[i * p->k + j] - p->price[j] < u - tolerance)
				return false;
	}
	return true;
}
#endif

double esk_assignment_solve(uint32_t k, const float *costs, uint32_t *column_of_row)
{
	problem p = {.k = k, .costs = costs, .column_of_row = column_of_row};
	reduce_columns(&p);
	for (uint32_t i = 0; i < k; i++)
		if (column_of_row[i] == NONE)
			match_row(&p, i);
	assert(is_optimal(&p));
	double sum = 0;
	for (uint32_t i = 0; i < k; i++)
		sum += (double)costs[i * k + column_of_row[i]];
	return sum;
}
