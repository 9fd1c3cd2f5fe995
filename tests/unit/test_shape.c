#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

/* For the widths that this processor would not choose: what is compiled for every width goes into a caller of each. */
#include "lanes.h"
#undef ESK_EVERY_WIDTH
#define ESK_EVERY_WIDTH inline __attribute__((always_inline))
#include "columns.c"
#include "shape.c"

#include "synthetic.h"

typedef void writer(const eskel_signature *signature, esk_shape *shape, esk_shape_codes *codes);

static void write_plain(const eskel_signature *signature, esk_shape *shape, esk_shape_codes *codes)
{
	esk_shape_write(signature, shape);
	esk_columns_encode(shape, codes);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) static void write_avx2(
	const eskel_signature *signature, esk_shape *shape, esk_shape_codes *codes)
{
	esk_shape_write(signature, shape);
	esk_columns_encode(shape, codes);
}

__attribute__((target("avx512f"))) static void write_avx512(
	const eskel_signature *signature, esk_shape *shape, esk_shape_codes *codes)
{
	esk_shape_write(signature, shape);
	esk_columns_encode(shape, codes);
}
#endif

/* ---- number by number, as shape.h and columns.h say */

static float plain_feature(const eskel_signature *signature, uint32_t level, uint32_t class, uint32_t number)
{
	const double taken = signature->rows[ESKEL_NODES(level - 1) + class][number];
	const double unit = number < 4 ? esk_elementary_cbrt(signature->volume) : 1;
	return (float)esk_elementary_log(taken / unit + 0.02);
}

static void check_level(const eskel_signature *signature, const esk_shape *shape, uint32_t k)
{
	const float *sorted = esk_shape_sorted(shape, k);
	float numbers[ESK_LEVEL_FLOATS_MAX], places[ESK_LEVEL_FLOATS_MAX] = {0}, ranks[ESK_LEVEL_FLOATS_MAX];
	for (uint32_t n = 0; n < ESK_NUMBERS_MAX * k; n++)
		places[n] = (float)(n % k);
	esk_shape_unsort(shape, k, sorted, ESK_NUMBERS_MAX, numbers);
	esk_shape_unsort(shape, k, places, ESK_NUMBERS_MAX, ranks);
	for (uint32_t c = 0; c < ESK_NUMBERS_MAX; c++)
		for (uint32_t i = 0; i < k; i++) {
			const float feature = plain_feature(signature, k, i, c);
			uint32_t before = 0;
			for (uint32_t j = 0; j < k; j++) {
				const float other = plain_feature(signature, k, j, c);
				before += other < feature || (other == feature && j < i);
			}
			if (numbers[c * k + i] != feature || ranks[c * k + i] != (float)before)
				fail_msg("level %u, class %u, number %u: %.9g of rank %g, expected %.9g of %u", k, i, c,
					(double)numbers[c * k + i], (double)ranks[c * k + i], (double)feature, before);
		}
}

static float plain_number(const esk_shape *shape, eskel_signature_kind kind, uint32_t level, uint32_t c, uint32_t i)
{
	const float feature = esk_shape_sorted(shape, level)[c * level + i];
	return kind == ESKEL_SIGNATURE_PAPER ? esk_shape_length(feature) : feature;
}

/* The lower or the upper half of a row. */
static float plain_half(const esk_shape *shape, eskel_signature_kind kind, uint32_t k, uint32_t h)
{
	double sum = k % 2 ? (double)plain_number(shape, kind, k, h / 2, k / 2) / 2 : 0;
	for (uint32_t i = 0; i < k / 2; i++)
		sum += (double)plain_number(shape, kind, k, h / 2, h % 2 ? k - 1 - i : i);
	return (float)(sum / k);
}

static bool is_code_of(const esk_codes *codes, float number, uint32_t code, bool *odd)
{
	if (number < codes->origin || number > codes->top) {
		*odd = true;
		return code == 0;
	}
	return (float)code == floorf((number - codes->origin) / codes->step + 0.5f);
}

/* Codes of levels 1 and 2. */
static void check_first_levels(
	const esk_shape *shape, eskel_signature_kind kind, const esk_kind_codes *codes, bool *odd)
{
	const esk_codes of_kind = esk_columns_codes(kind);
	const uint32_t numbers = esk_numbers(kind);
	float rows[2 * ESK_NUMBERS_MAX];
	for (uint32_t c = 0; c < numbers; c++)
		assert_true(is_code_of(&of_kind, plain_number(shape, kind, 1, c, 0), codes->first_level[c], odd));
	if (shape->level_count < 2)
		return;
	esk_shape_unsort(shape, 2, esk_shape_sorted(shape, 2), numbers, rows);
	for (uint32_t i = 0; i < 2 * numbers; i++) {
		const float feature = rows[i % numbers * 2 + i / numbers];
		const float number = kind == ESKEL_SIGNATURE_PAPER ? esk_shape_length(feature) : feature;
		assert_true(is_code_of(&of_kind, number, codes->second_level[i], odd));
	}
}

static void check_halves(const esk_shape *shape, eskel_signature_kind kind, const esk_kind_codes *codes, bool *odd)
{
	const esk_codes of_kind = esk_columns_codes(kind);
	const uint32_t row = 2 * esk_numbers(kind), depth = shape->level_count < 16 ? shape->level_count : 16;
	double sums[ESK_HALVES_MAX] = {0}, error = 0;
	for (uint32_t k = 1; k <= depth; k++)
		for (uint32_t h = 0; h < row; h++) {
			const esk_codes of_half = esk_columns_half_codes(kind, h / 2);
			const float half = plain_half(shape, kind, k, h);
			const float inside = fminf(fmaxf(half, of_half.origin), of_half.top);
			const float code = fminf(floorf((inside - of_half.origin) / of_half.step + 0.5f), 255);
			if ((float)codes->halves[(k - 1) * row + h] != code)
				fail_msg("level %u, half %u of %g: %d, expected %g", k, h, (double)half,
					codes->halves[(k - 1) * row + h], (double)code);
			error += fabs((double)(of_half.origin + code * of_half.step) - (double)inside) /
				 (double)of_half.step;
			sums[h] += (double)half;
		}
	for (uint32_t h = 0; h < row; h++)
		assert_true(is_code_of(&of_kind, (float)(sums[h] / depth), codes->total_halves[h], odd));
	for (uint32_t n = depth * row; n < ESK_COLUMNS_HALVES; n++)
		assert_int_equal(codes->halves[n], 0);
	assert_int_equal(codes->slack, (int)ceil(error));
}

static void check(writer *write, const eskel_signature *signature)
{
	esk_shape *shape = malloc(esk_shape_size(signature->level_count)); /* of its size, for the address sanitizer */
	esk_shape_codes codes;
	bool odd = false;
	assert_non_null(shape);
	write(signature, shape, &codes);
	assert_int_equal(shape->level_count, signature->level_count);
	assert_true(shape->log_volume == (float)esk_elementary_log(signature->volume));
	assert_true(shape->scale == (float)esk_elementary_cbrt(signature->volume));
	for (uint32_t k = 1; k <= signature->level_count; k++)
		check_level(signature, shape, k);
	for (eskel_signature_kind kind = ESKEL_SIGNATURE_LOG; kind <= ESKEL_SIGNATURE_PAPER; kind++) {
		check_first_levels(shape, kind, &codes.kinds[kind], &odd);
		check_halves(shape, kind, &codes.kinds[kind], &odd);
	}
	assert_int_equal(codes.odd, odd);
	assert_int_equal(codes.level_count, signature->level_count);
	assert_true(codes.log_volume == shape->log_volume && codes.scale == shape->scale);
	free(shape);
}

/* Plausible ones, and ones with zeros, equal numbers and numbers without codes. */
static void check_many(writer *write)
{
	uint64_t random = 7;
	for (uint32_t n = 0; n < 120; n++) {
		eskel_signature *signature = synthetic_signature(n, 1, 0.2, 1 + n % (n % 10 ? 20 : ESKEL_LEVELS_MAX));
		for (size_t i = 0; n % 3 && i < ESKEL_NODES(signature->level_count); i++) {
			const uint64_t bits = synthetic_random(&random);
			double *number = &signature->rows[i][bits % ESKEL_SIGNATURE_NUMBERS];
			*number = bits >> 8 & 1 ? (double)(bits >> 9 & 3) : *number;
			if (n % 3 == 2 && (bits >> 16) % 64 == 0)
				*number = 1e10 / (double)(1 + (bits >> 32));
		}
		check(write, signature);
		eskel_signature_free(signature);
	}
}

static void every_vector_width_finds_what_a_plain_computation_finds(void **state)
{
	(void)state;
	check_many(write_plain);
#if defined(__x86_64__)
	if (__builtin_cpu_supports("avx2"))
		check_many(write_avx2);
	if (__builtin_cpu_supports("avx512f"))
		check_many(write_avx512);
#endif
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_vector_width_finds_what_a_plain_computation_finds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
