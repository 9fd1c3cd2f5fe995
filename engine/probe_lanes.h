/* The loop of probe.c for one vector width. Included once for each, with these defined:
 *
 *	LANES, NAME, TARGET      doubles a vector, the function's name and its attribute
 *	MIN, MAX, MULTIPLY_ADD   on vectors of doubles
 *	TO_DOUBLE(p)             LANES int32_t at p as doubles
 */
#define JOIN(a, b) a##b
#define NAMED(a, b) JOIN(a, b)
#define lanes NAMED(lanes_, LANES)
#define integers NAMED(integers_, LANES)
#define narrow NAMED(narrow_, LANES)

typedef double lanes __attribute__((vector_size(8 * LANES), may_alias, aligned(8)));
typedef int64_t integers __attribute__((vector_size(8 * LANES), may_alias, aligned(8)));
typedef int32_t narrow __attribute__((vector_size(4 * LANES), may_alias, aligned(4)));

/* A score is an integer below 2^51 in magnitude, so adding 1.5 2^52 leaves it in the low bits of the double. */
#define WINNER(score) ((integers)((score) + 0x1.8p52) & (ESKEL_LEVELS_MAX - 1))

TARGET static void NAME(esk_probes *p, size_t count, const esk_scores *s)
{
	for (size_t i = 0; i < count; i += LANES) {
		const lanes above_scores = (lanes){0} + 0x1p51;
		const lanes x_first = TO_DOUBLE(p->x_first + i), x_last = TO_DOUBLE(p->x_last + i);
		const lanes y = TO_DOUBLE(p->y + i), z = TO_DOUBLE(p->z + i);
		lanes best_first = above_scores, second_first = above_scores;
		lanes best_last = above_scores, second_last = above_scores;
		for (uint32_t j = 0; j < s->count; j++) {
			const lanes slope_x = (lanes){0} + s->slope[0][j], slope_y = (lanes){0} + s->slope[1][j];
			const lanes slope_z = (lanes){0} + s->slope[2][j], constant = (lanes){0} + s->constant[j];
			const lanes row = MULTIPLY_ADD(slope_z, z, MULTIPLY_ADD(slope_y, y, constant));
			const lanes first = MULTIPLY_ADD(slope_x, x_first, row),
				    last = MULTIPLY_ADD(slope_x, x_last, row);
			second_first = MIN(second_first, MAX(best_first, first));
			best_first = MIN(best_first, first);
			second_last = MIN(second_last, MAX(best_last, last));
			best_last = MIN(best_last, last);
		}
		const integers expected = __builtin_convertvector(*(const narrow *)&p->expected[i], integers);
		const integers winner_first = WINNER(best_first), winner_last = WINNER(best_last);
		const integers same = (winner_first == expected) & (winner_last == expected);
		const lanes lead = MIN(second_first - best_first, second_last - best_last), wrong = (lanes){0} - 1;
		*(narrow *)&p->winner_first[i] = __builtin_convertvector(winner_first, narrow);
		*(narrow *)&p->winner_last[i] = __builtin_convertvector(winner_last, narrow);
		*(lanes *)&p->slack[i] = (lanes)((same & (integers)lead) | (~same & (integers)wrong));
	}
}

#undef WINNER
#undef narrow
#undef integers
#undef lanes
#undef NAMED
#undef JOIN
#undef TO_DOUBLE
#undef MULTIPLY_ADD
#undef MAX
#undef MIN
#undef TARGET
#undef NAME
#undef LANES
