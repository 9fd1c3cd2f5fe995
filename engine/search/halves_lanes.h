/* The loop of halves.c for one vector width. Included once for each, with these defined:
 *
 *	LANES, NAME, TARGET   floats a vector, the function's name and its attribute
 *	MIN(a, b)             on vectors of floats
 *	TO_FLOAT(p)           LANES bytes at p as floats
 */
#define JOIN(a, b) a##b
#define NAMED(a, b) JOIN(a, b)
#define lanes NAMED(lanes_, LANES)
#define integers NAMED(integers_, LANES)

typedef float lanes __attribute__((vector_size(4 * LANES), may_alias, aligned(4)));
typedef int32_t integers __attribute__((vector_size(4 * LANES), may_alias, aligned(4)));

#define AT(n, part) ((n) + (part)*LANES)
#define DIFFERENCE(n, part) \
	(MIN(*(const lanes *)(mine + AT(n, part)) * steps[i], last_code) - TO_FLOAT(rows[i] + AT(n, part)))

TARGET static void NAME(const float *mine, size_t begin, size_t end, size_t size, const uint8_t *const *rows,
	const float *steps, size_t row_count, float *sums)
{
	enum { PARTS = SUMMED / LANES };
	const integers magnitude = (integers){0} + INT32_MAX;
	const lanes last_code = (lanes){0} + 255;
	const size_t tail = end - (end - begin) % SUMMED, from = tail + SUMMED <= size ? tail : size - SUMMED;
	const int32_t *below_end = some_of_sixteen + SUMMED - (end - from);
	const int32_t *below_tail = some_of_sixteen + SUMMED - (tail - from);
	for (size_t i = 0; i < row_count; i++) {
		lanes sum[PARTS] = {0};
		for (size_t n = begin; n < tail; n += SUMMED)
			for (size_t part = 0; part < PARTS; part++)
				sum[part] += (lanes)((integers)DIFFERENCE(n, part) & magnitude);
		for (size_t part = 0; tail < end && part < PARTS; part++)
			sum[part] += (lanes)((integers)DIFFERENCE(from, part) & magnitude &
					     *(const integers *)(below_end + part * LANES) &
					     ~*(const integers *)(below_tail + part * LANES));
		sums[i] = sum_of_sixteen((const float *)sum);
	}
}

#undef DIFFERENCE
#undef AT
#undef integers
#undef lanes
#undef NAMED
#undef JOIN
#undef TO_FLOAT
#undef MIN
#undef TARGET
#undef NAME
#undef LANES
