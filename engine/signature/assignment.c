/* Minimum-cost matching by shortest augmenting paths.
 *
 * Linear programming duality: with a price v_j on every column, let u_i = min_j (c_ij - v_j). Any matching costs at
 * least sum u_i + sum v_j, and a matching of tight pairs (c_ij - v_j = u_i) costs exactly that, so it is optimal. The
 * invariant of every step is that matched pairs are tight. Columns are priced at their least cost; each row in turn
 * takes a tight column that is still free; the rows that are left find a free column along a shortest path. Only v is
 * stored: u_i follows from the column that row i has, so tightness cannot be lost to rounding.
 *
 * After Jonker and Volgenant, "A shortest augmenting path algorithm for dense and sparse linear assignment problems"
 * (Computing 38, 1987), without their bidding for columns: it leaves fewer paths to find, but with a row in a few
 * registers a bid costs as much as a step of a path, and it takes more bids than it saves steps.
 *
 * Prices only ever fall from the columns' least costs, so reduced costs c_ij - v_j are never negative, also when
 * rounded, and path lengths are made never to shrink from one step to the next. Floats that are not negative are
 * ordered like their bits, so they are compared as integers, whose minimum takes one cycle where a float's takes four.
 *
 * Lanes compute on their own, and neither the least of a row nor the columns that have it depend on how lanes are
 * grouped, so all vector widths find the same. Sixteen lanes (AVX-512) gain next to nothing over eight up to k = 32 and
 * a fifth at 64, which is not worth a third version.
 *
 * The paper expects O(k^2 + log k) (section 5.2.2); no such algorithm exists for dense costs, this one is O(k^3). */
#include "assignment.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

enum { WIDTH_MAX = ESKEL_LEVELS_MAX };

typedef struct {
	uint32_t k, width;
	const float *costs;
	uint64_t free_rows, free_columns; /* bit n: row or column n has no partner yet */
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float price[WIDTH_MAX];
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float matched_cost[WIDTH_MAX]; /* of a column and its row */
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float u[WIDTH_MAX];            /* of that row, when a search begins */
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) int32_t came_from[WIDTH_MAX]; /* the row before a column on the path to it */
	uint32_t row_of_column[WIDTH_MAX];
	uint32_t *column_of_row;
} problem;

static uint32_t first_of(uint64_t set)
{
	return (uint32_t)__builtin_ctzll(set);
}

static void match(problem *p, uint32_t row, uint32_t column)
{
	p->row_of_column[column] = row;
	p->column_of_row[row] = column;
	p->matched_cost[column] = p->costs[row * p->width + column];
	p->free_columns &= ~(UINT64_C(1) << column);
}

/* Every row on the path to a free column takes the column after it. */
static void match_along_path(problem *p, uint32_t free_row, uint32_t free_column)
{
	uint32_t row, column = free_column;
	do {
		row = (uint32_t)p->came_from[column];
		const uint32_t left = p->column_of_row[row];
		match(p, row, column);
		column = left;
	} while (row != free_row);
}

#if defined(__x86_64__)
#include <immintrin.h>

#define LANES 8
#define NAME solve_avx2
#define TARGET __attribute__((target("avx2")))
#define MIN(a, b) ((integers)_mm256_min_epi32((__m256i)(a), (__m256i)(b)))
#define MAX(a, b) ((integers)_mm256_max_epi32((__m256i)(a), (__m256i)(b)))
#define SWAP_HALVES(v) ((integers)_mm256_permute2x128_si256((__m256i)(v), (__m256i)(v), 1))
#define SWAP_PAIRS(v) ((integers)_mm256_shuffle_epi32((__m256i)(v), 0x4e))
#define SWAP_LANES(v) ((integers)_mm256_shuffle_epi32((__m256i)(v), 0xb1))
#define SIGN_BITS(v) (uint32_t) _mm256_movemask_ps((__m256)(v))
#define LANE_NUMBERS 0, 1, 2, 3, 4, 5, 6, 7
#include "assignment_lanes.h"
#endif

/* Four lanes: SSE2 and NEON, which are always there. */
#define LANES 4
#define NAME solve_plain
#define TARGET
#define PICK(mask, a, b) (((mask) & (a)) | (~(mask) & (b)))
#define MIN(a, b) PICK((a) < (b), a, b)
#define MAX(a, b) PICK((a) > (b), a, b)
#define SWAP_HALVES(v) (v)
#define SWAP_PAIRS(v) ((integers){(v)[2], (v)[3], (v)[0], (v)[1]})
#define SWAP_LANES(v) ((integers){(v)[1], (v)[0], (v)[3], (v)[2]})
#define SIGN_BITS(v) (uint32_t)(((v)[0] & 1) | ((v)[1] & 2) | ((v)[2] & 4) | ((v)[3] & 8))
#define LANE_NUMBERS 0, 1, 2, 3
#include "assignment_lanes.h"

#ifndef NDEBUG
/* Every price is the result of at most k subtractions, each wrong by half a unit in the last place of the largest
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

static void solve(problem *p)
{
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2")) {
		solve_avx2(p);
		return;
	}
#endif
	solve_plain(p);
}

static double solve_by(void (*solver)(problem *), uint32_t k, const float *costs, uint32_t *column_of_row)
{
	problem p;
	p.k = k;
	p.width = esk_assignment_width(k);
	p.costs = costs;
	p.free_rows = p.free_columns = UINT64_MAX >> (64 - k);
	p.column_of_row = column_of_row;
	solver(&p);
	assert(is_optimal(&p));
	double sum = 0;
	for (uint32_t i = 0; i < k; i++)
		sum += (double)costs[i * p.width + column_of_row[i]];
	return sum;
}

double esk_assignment_solve_padded(uint32_t k, const float *costs, uint32_t *column_of_row)
{
	return solve_by(solve, k, costs, column_of_row);
}

double esk_assignment_solve(uint32_t k, const float *costs, uint32_t *column_of_row)
{
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float padded[ESK_ASSIGNMENT_COSTS_MAX];
	const uint32_t width = esk_assignment_width(k);
	for (uint32_t i = 0; i < k; i++) {
		memcpy(padded + i * width, costs + i * k, k * sizeof *costs);
		for (uint32_t j = k; j < width; j++)
			padded[i * width + j] = INFINITY;
	}
	return esk_assignment_solve_padded(k, padded, column_of_row);
}
