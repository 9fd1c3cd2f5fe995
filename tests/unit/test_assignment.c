#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "assignment.c" /* for the widths that this processor would not choose */
#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { most = ESKEL_LEVELS_MAX * ESKEL_LEVELS_MAX };

/* Kinds of matrix that find different weaknesses of a solver. */
enum kind { UNIFORM, TIED, NEAR_DIAGONAL, WIDE_RANGE, DISTANCES, KINDS };

static void fill(uint64_t *random, enum kind kind, uint32_t k, float *costs)
{
	float a[ESKEL_LEVELS_MAX], b[ESKEL_LEVELS_MAX];
	for (uint32_t i = 0; i < k; i++) {
		a[i] = (float)synthetic_uniform(random);
		b[i] = (float)synthetic_uniform(random);
	}
	for (uint32_t i = 0; i < k; i++)
		for (uint32_t j = 0; j < k; j++) {
			float u = (float)synthetic_uniform(random);
			float *cost = &costs[i * k + j];
			switch (kind) {
			case UNIFORM:
				*cost = u;
				break;
			case TIED:
				*cost = floorf(4 * u);
				break;
			case NEAR_DIAGONAL:
				*cost = i == j ? 0.1f * u : 1 + u;
				break;
			case WIDE_RANGE:
				*cost = expf(20 * u - 10);
				break;
			default:
				*cost = fabsf(a[i] - b[j]);
			}
		}
}

static void assert_is_permutation(uint32_t k, const uint32_t *columns)
{
	bool taken[ESKEL_LEVELS_MAX] = {false};
	for (uint32_t i = 0; i < k; i++) {
		if (columns[i] >= k || taken[columns[i]])
			fail_msg("row %u of %u has column %u, which does not exist or is taken", i, k, columns[i]);
		taken[columns[i]] = true;
	}
}

static double least_by_permutations(uint32_t k, const float *costs, uint32_t row, unsigned taken)
{
	if (row == k)
		return 0;
	double least = INFINITY;
	for (uint32_t j = 0; j < k; j++)
		if (!(taken >> j & 1))
			least = fmin(least,
				(double)costs[row * k + j] + least_by_permutations(k, costs, row + 1, taken | 1u << j));
	return least;
}

static void up_to_seven_classes_cost_the_least_over_all_permutations(void **state)
{
	(void)state;
	uint64_t random = 1;
	float costs[most];
	uint32_t columns[ESKEL_LEVELS_MAX];
	for (int round = 0; round < 4000; round++) {
		uint32_t k = 1 + (uint32_t)round % 7;
		fill(&random, (enum kind)(synthetic_random(&random) % KINDS), k, costs);
		double found = esk_assignment_solve(k, costs, columns);
		double least = least_by_permutations(k, costs, 0, 0);
		assert_is_permutation(k, columns);
		if (fabs(found - least) > 1e-6 * least)
			fail_msg("round %d, k = %u: found %.9g, least is %.9g", round, k, found, least);
	}
}

static void the_cost_is_the_sum_of_the_chosen_costs_in_row_order(void **state)
{
	(void)state;
	uint64_t random = 2;
	float costs[most];
	uint32_t columns[ESKEL_LEVELS_MAX];
	for (uint32_t k = 1; k <= ESKEL_LEVELS_MAX; k++) {
		fill(&random, WIDE_RANGE, k, costs);
		double found = esk_assignment_solve(k, costs, columns), sum = 0;
		for (uint32_t i = 0; i < k; i++)
			sum += (double)costs[i * k + columns[i]];
		if (found != sum)
			fail_msg("k = %u: %.17g, expected %.17g", k, found, sum);
	}
}

static void equal_costs_give_a_permutation_at_their_sum(void **state)
{
	(void)state;
	float costs[most];
	uint32_t columns[ESKEL_LEVELS_MAX];
	for (int n = 0; n < most; n++)
		costs[n] = 3;
	for (uint32_t k = 1; k <= ESKEL_LEVELS_MAX; k++) {
		assert_true(esk_assignment_solve(k, costs, columns) == 3.0 * k);
		assert_is_permutation(k, columns);
	}
}

static void the_same_tied_costs_always_give_the_same_matching(void **state)
{
	(void)state;
	uint64_t random = 3;
	float costs[most];
	uint32_t first[ESKEL_LEVELS_MAX], second[ESKEL_LEVELS_MAX];
	for (uint32_t k = 1; k <= ESKEL_LEVELS_MAX; k++) {
		fill(&random, TIED, k, costs);
		esk_assignment_solve(k, costs, first);
		memset(second, 0xff, sizeof second);
		esk_assignment_solve(k, costs, second);
		assert_memory_equal(first, second, k * sizeof *first);
	}
}

static void every_vector_width_finds_the_same_matching(void **state)
{
	(void)state;
#if defined(__x86_64__)
	if (!__builtin_cpu_supports("avx2")) {
		print_message("this processor has no AVX2\n");
		skip();
	}
	uint64_t random = 6;
	float costs[most];
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float padded[ESK_ASSIGNMENT_COSTS_MAX];
	uint32_t narrow[ESKEL_LEVELS_MAX], wide[ESKEL_LEVELS_MAX];
	for (uint32_t n = 0; n < 40 * ESKEL_LEVELS_MAX; n++) {
		const uint32_t k = 1 + n % ESKEL_LEVELS_MAX, width = esk_assignment_width(k);
		fill(&random, (enum kind)(synthetic_random(&random) % KINDS), k, costs);
		for (uint32_t i = 0; i < k; i++)
			for (uint32_t j = 0; j < width; j++)
				padded[i * width + j] = j < k ? costs[i * k + j] : INFINITY;
		const double by_four = solve_by(solve_plain, k, padded, narrow);
		const double by_eight = solve_by(solve_avx2, k, padded, wide);
		if (by_four != by_eight || memcmp(narrow, wide, k * sizeof *narrow))
			fail_msg("k = %u: %.17g by four lanes, %.17g by eight", k, by_four, by_eight);
	}
#else
	skip();
#endif
}

/* On a line the sorted matching is optimal; this is the bound of the exact search. */
static void points_on_a_line_are_matched_at_the_cost_of_the_sorted_matching(void **state)
{
	(void)state;
	uint64_t random = 4;
	float costs[most];
	uint32_t columns[ESKEL_LEVELS_MAX];
	for (uint32_t k = 1; k <= ESKEL_LEVELS_MAX; k++) {
		/* a_i = i and b_j = j + 1/4 in any order are matched at 1/4 each. */
		uint32_t order[ESKEL_LEVELS_MAX];
		for (uint32_t j = 0; j < k; j++) {
			uint32_t other = (uint32_t)(synthetic_random(&random) % (j + 1));
			order[j] = order[other];
			order[other] = j;
		}
		for (uint32_t i = 0; i < k; i++)
			for (uint32_t j = 0; j < k; j++)
				costs[i * k + j] = fabsf((float)i - (float)order[j] - 0.25f);
		double found = esk_assignment_solve(k, costs, columns);
		if (found != 0.25 * k)
			fail_msg("k = %u: %.9g, expected %.9g", k, found, 0.25 * k);
	}
}

/* Shortest augmenting paths as textbooks have them: rows and columns count from 1, in double. */
static double least_by_textbook(uint32_t k, const float *costs)
{
	double u[ESKEL_LEVELS_MAX + 1] = {0}, v[ESKEL_LEVELS_MAX + 1] = {0}, sum = 0;
	uint32_t row_of[ESKEL_LEVELS_MAX + 1] = {0}, before[ESKEL_LEVELS_MAX + 1] = {0};
	for (uint32_t i = 1; i <= k; i++) {
		double slack[ESKEL_LEVELS_MAX + 1];
		bool used[ESKEL_LEVELS_MAX + 1] = {false};
		for (uint32_t j = 0; j <= k; j++)
			slack[j] = INFINITY;
		uint32_t column = 0;
		row_of[0] = i;
		while (row_of[column] != 0) {
			const uint32_t row = row_of[column];
			uint32_t next = 0;
			used[column] = true;
			for (uint32_t j = 1; j <= k; j++) {
				const double reduced = (double)costs[(row - 1) * k + j - 1] - u[row] - v[j];
				if (!used[j] && reduced < slack[j]) {
					slack[j] = reduced;
					before[j] = column;
				}
				if (!used[j] && (next == 0 || slack[j] < slack[next]))
					next = j;
			}
			const double step = slack[next];
			for (uint32_t j = 0; j <= k; j++)
				if (used[j]) {
					u[row_of[j]] += step;
					v[j] -= step;
				} else {
					slack[j] -= step;
				}
			column = next;
		}
		for (; column != 0; column = before[column])
			row_of[column] = row_of[before[column]];
	}
	for (uint32_t j = 1; j <= k; j++)
		sum += (double)costs[(row_of[j] - 1) * k + j - 1];
	return sum;
}

static void all_sizes_cost_what_the_textbook_finds(void **state)
{
	(void)state;
	uint64_t random = 7;
	float costs[most];
	uint32_t columns[ESKEL_LEVELS_MAX];
	for (uint32_t n = 0; n < 40 * ESKEL_LEVELS_MAX; n++) {
		const uint32_t k = 1 + n % ESKEL_LEVELS_MAX;
		fill(&random, (enum kind)(synthetic_random(&random) % KINDS), k, costs);
		const double found = esk_assignment_solve(k, costs, columns), least = least_by_textbook(k, costs);
		assert_is_permutation(k, columns);
		if (fabs(found - least) > 1e-6 * least)
			fail_msg("k = %u: found %.9g, the textbook %.9g", k, found, least);
	}
}

static void all_sizes_cost_what_scipy_finds(void **state)
{
	(void)state;
	enum { matrices = 800 };
	static double found[matrices];
	char path[] = "/tmp/eskel-assignment-XXXXXX", command[200], line[64];
	int descriptor = mkstemp(path);
	assert_true(descriptor >= 0);
	FILE *file = fdopen(descriptor, "w");
	uint64_t random = 5;
	float costs[most];
	uint32_t columns[ESKEL_LEVELS_MAX];
	for (int n = 0; n < matrices; n++) {
		uint32_t k = 1 + (uint32_t)n % ESKEL_LEVELS_MAX;
		fill(&random, (enum kind)(synthetic_random(&random) % KINDS), k, costs);
		found[n] = esk_assignment_solve(k, costs, columns);
		assert_is_permutation(k, columns);
		fprintf(file, "%u", k);
		for (uint32_t c = 0; c < k * k; c++)
			fprintf(file, " %.9g", (double)costs[c]);
		fputc('\n', file);
	}
	fclose(file);
	snprintf(command, sizeof command, "/usr/bin/python3 tests/unit/assignment_oracle.py %s 2>/dev/null", path);
	FILE *oracle = popen(command, "r");
	assert_non_null(oracle);
	int read = 0;
	for (; read < matrices && fgets(line, sizeof line, oracle); read++) {
		double least = strtod(line, NULL);
		if (fabs(found[read] - least) > 1e-6 * least)
			fail_msg("matrix %d: found %.9g, SciPy %.9g", read, found[read], least);
	}
	pclose(oracle);
	remove(path);
	if (read == 0) {
		print_message("python3 with SciPy is not there\n");
		skip();
	}
	assert_int_equal(read, matrices);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(up_to_seven_classes_cost_the_least_over_all_permutations),
		cmocka_unit_test(the_cost_is_the_sum_of_the_chosen_costs_in_row_order),
		cmocka_unit_test(equal_costs_give_a_permutation_at_their_sum),
		cmocka_unit_test(the_same_tied_costs_always_give_the_same_matching),
		cmocka_unit_test(points_on_a_line_are_matched_at_the_cost_of_the_sorted_matching),
		cmocka_unit_test(every_vector_width_finds_the_same_matching),
		cmocka_unit_test(all_sizes_cost_what_the_textbook_finds),
		cmocka_unit_test(all_sizes_cost_what_scipy_finds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
