#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "class_costs.c" /* for the widths that this processor would not choose */
#include "synthetic.h"

static float one_cost(eskel_metric metric, uint32_t numbers, uint32_t k, const float *a, const float *b)
{
	float sum = 0;
	for (uint32_t c = 0; c < numbers; c++) {
		const float difference = a[c * k] - b[c * k];
		sum += metric == ESKEL_METRIC_EUCLIDEAN ? difference * difference
		       : metric == ESKEL_METRIC_ROOT    ? sqrtf(fabsf(difference))
							: fabsf(difference);
	}
	return metric == ESKEL_METRIC_EUCLIDEAN ? sqrtf(sum) : sum;
}

static void costs_are_the_sums_over_numbers_in_order_and_infinite_in_the_padding(void **state)
{
	(void)state;
	uint64_t random = 1;
	float a[ESK_LEVEL_FLOATS_MAX], b[ESK_LEVEL_FLOATS_MAX];
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float costs[ESK_ASSIGNMENT_COSTS_MAX];
	for (int n = 0; n < ESK_LEVEL_FLOATS_MAX; n++) {
		a[n] = (float)synthetic_uniform(&random);
		b[n] = (float)synthetic_uniform(&random);
	}
	for (uint32_t n = 0; n < 6 * ESKEL_LEVELS_MAX; n++) {
		const uint32_t k = 1 + n / 6, numbers = ESK_PAPER_NUMBERS + n / 3 % 2;
		const eskel_metric metric = (eskel_metric)(n % 3);
		const uint32_t width = esk_assignment_width(k);
		esk_class_costs(metric, numbers, k, a, b, costs);
		for (uint32_t i = 0; i < k; i++)
			for (uint32_t j = 0; j < width; j++) {
				float expected = j < k ? one_cost(metric, numbers, k, a + i, b + j) : INFINITY;
				if (costs[i * width + j] != expected)
					fail_msg("k = %u, %u numbers, pair %u, %u: %.9g, expected %.9g", k, numbers, i,
						j, (double)costs[i * width + j], (double)expected);
			}
	}
}

/* The sum of the least costs of rows or of columns. */
static float sum_of_least(const float *costs, uint32_t k, uint32_t row, uint32_t column)
{
	float sum = 0;
	for (uint32_t i = 0; i < k; i++) {
		float least = INFINITY;
		for (uint32_t j = 0; j < k; j++)
			least = fminf(least, costs[i * row + j * column]);
		sum += least;
	}
	return sum;
}

static void nearest_classes_cost_the_least_of_rows_or_columns(void **state)
{
	(void)state;
	uint64_t random = 3;
	float a[ESK_LEVEL_FLOATS_MAX], b[ESK_LEVEL_FLOATS_MAX];
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float costs[ESK_ASSIGNMENT_COSTS_MAX];
	for (int n = 0; n < ESK_LEVEL_FLOATS_MAX; n++) {
		a[n] = (float)synthetic_uniform(&random);
		b[n] = (float)synthetic_uniform(&random);
	}
	for (uint32_t n = 0; n < 2 * ESKEL_LEVELS_MAX; n++) {
		const uint32_t k = 1 + n / 2, numbers = ESK_PAPER_NUMBERS + n % 2, width = esk_assignment_width(k);
		esk_class_costs(ESKEL_METRIC_ROOT, numbers, k, a, b, costs);
		const float expected = fmaxf(sum_of_least(costs, k, width, 1), sum_of_least(costs, k, 1, width));
		assert_true(esk_class_costs_nearest(numbers, k, a, b) == expected);
		pairs p;
		init(&p, numbers, k, a, b);
		assert_true(add_nearest_any(&p) == expected);
	}
}

static void every_vector_width_computes_the_same_costs(void **state)
{
	(void)state;
#if defined(__x86_64__)
	if (!__builtin_cpu_supports("avx2")) {
		print_message("this processor has no AVX2\n");
		skip();
	}
	uint64_t random = 2;
	float a[ESK_LEVEL_FLOATS_MAX], b[ESK_LEVEL_FLOATS_MAX];
	_Alignas(ESK_ASSIGNMENT_ALIGNMENT) float narrow[ESK_ASSIGNMENT_COSTS_MAX], wide[ESK_ASSIGNMENT_COSTS_MAX];
	for (int n = 0; n < ESK_LEVEL_FLOATS_MAX; n++) {
		a[n] = (float)synthetic_uniform(&random);
		b[n] = (float)synthetic_uniform(&random);
	}
	for (uint32_t n = 0; n < 3 * ESKEL_LEVELS_MAX; n++) {
		pairs p = {.numbers = ESK_NUMBERS_MAX, .k = 1 + n / 3, .a = a};
		init(&p, p.numbers, p.k, a, b);
		add_up_any(&p, (eskel_metric)(n % 3), narrow);
		add_up_avx2(&p, (eskel_metric)(n % 3), wide);
		assert_memory_equal(narrow, wide, p.k * p.width * sizeof *wide);
	}
#else
	skip();
#endif
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(costs_are_the_sums_over_numbers_in_order_and_infinite_in_the_padding),
		cmocka_unit_test(nearest_classes_cost_the_least_of_rows_or_columns),
		cmocka_unit_test(every_vector_width_computes_the_same_costs),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
