/* The loops of envelope.c for one vector width. Included once for each, with these defined:
 *
 *	LANES, TARGET                doubles a vector, the functions' attribute
 *	MIN, MAX, MULTIPLY_ADD       on vectors of doubles
 *	ONE_MORE_WHERE(a, b)         a, and 1 more where b > 0
 *	LEAST(a)                     the least lane
 *	WHERE_ABOVE(a, b)            a bit for every lane with a > b
 */
#define JOIN(a, b) a##b
#define NAMED(a, b) JOIN(a, b)
#define lanes NAMED(lanes_, LANES)
#define integers NAMED(integers_, LANES)
#define SPREAD(number) ((number) - (lanes){0}) /* in every lane */
#define find_candidates NAMED(find_candidates_, LANES)
#define divide NAMED(divide_, LANES)
#define PICK(mask, a, b) ((lanes)(((mask) & (integers)(a)) | (~(mask) & (integers)(b))))
#define tally_pack NAMED(tally_pack_, LANES)
#define tally_packs NAMED(tally_packs_, LANES)

typedef double lanes __attribute__((vector_size(8 * LANES), may_alias, aligned(8)));
typedef int64_t integers __attribute__((vector_size(8 * LANES), may_alias, aligned(8)));

/* The stretches of count ranks in the segments from lane on. */
TARGET static inline __attribute__((always_inline)) void divide(const esk_envelope *e, const esk_pack *pack,
	size_t lane, const uint8_t *ranks, uint32_t count, lanes *first, lanes *end)
{
	const lanes x = *(const lanes *)&pack->x_first[lane], y = *(const lanes *)&pack->y[lane];
	const lanes z = *(const lanes *)&pack->z[lane], zero = {0};
	lanes score[ESKEL_LEVELS_MAX];
	EACH_UNROLLED(i, 0, count)
	{
		const lanes row = MULTIPLY_ADD(SPREAD(e->slope[2][ranks[i]]), z, SPREAD(e->constant[ranks[i]]));
		const lanes column = MULTIPLY_ADD(SPREAD(e->slope[1][ranks[i]]), y, row);
		score[i] = MULTIPLY_ADD(SPREAD(e->slope[0][ranks[i]]), x, column);
		first[i] = zero;
	}
	EACH_UNROLLED(i, 0, count)
	{
		end[i] = *(const lanes *)&pack->voxels[lane];
		EACH_UNROLLED(j, i + 1, count)
		{
			const lanes lead = score[j] - score[i];
			const lanes inverse = SPREAD(e->inverse[ranks[i]][ranks[j]]);
			const lanes change = SPREAD(e->change[ranks[i]][ranks[j]]);
			const lanes near = MULTIPLY_ADD(lead, inverse, SPREAD(0x1.8p52)) - 0x1.8p52;
			const lanes won = ONE_MORE_WHERE(near, MULTIPLY_ADD(near, change, lead));
			end[i] = MIN(end[i], won);
			first[j] = MAX(first[j], won);
		}
	}
}

/* Sums stay in lanes until the pass ends. */
TARGET static inline __attribute__((always_inline)) void tally_pack(
	const esk_envelope *e, const esk_pack *pack, uint64_t candidates, uint32_t count, esk_tally *tally)
{
	uint8_t ranks[ESKEL_LEVELS_MAX];
	list_ranks(candidates, count, ranks);
	for (size_t lane = 0; lane < ESK_PACK; lane += LANES) {
		lanes first[ESKEL_LEVELS_MAX], end[ESKEL_LEVELS_MAX];
		divide(e, pack, lane, ranks, count, first, end);
		const lanes x = *(const lanes *)&pack->x_first[lane], y = *(const lanes *)&pack->y[lane];
		const lanes z = *(const lanes *)&pack->z[lane], weight = *(const lanes *)&pack->weight[lane];
		EACH_UNROLLED(i, 0, count)
		{
			const lanes part = weight * MAX(end[i] - first[i], (lanes){0});
			const lanes middle = (x - 1) + (first[i] + end[i]); /* of x + 2 first and x + 2 (end - 1) */
			lanes *sum = (lanes *)&tally->weight[ranks[i]][lane];
			*sum += part;
			sum = (lanes *)&tally->first[ranks[i]][0][lane];
			*sum = MULTIPLY_ADD(part, middle, *sum);
			sum = (lanes *)&tally->first[ranks[i]][1][lane];
			*sum = MULTIPLY_ADD(part, y, *sum);
			sum = (lanes *)&tally->first[ranks[i]][2][lane];
			*sum = MULTIPLY_ADD(part, z, *sum);
		}
	}
}

TARGET static void tally_packs(
	const esk_envelope *e, const esk_pack *packs, const uint64_t *candidates, size_t count, esk_tally *tally)
{
	for (size_t p = 0; p < count; p++) {
		const uint32_t found = (uint32_t)__builtin_popcountll(candidates[p]);
		switch (found) { /* unrolled for the usual counts, as loops so short are mispredicted at their ends */
		case 1:
			break;
		case 2:
			tally_pack(e, &packs[p], candidates[p], 2, tally);
			break;
		case 3:
			tally_pack(e, &packs[p], candidates[p], 3, tally);
			break;
		case 4:
			tally_pack(e, &packs[p], candidates[p], 4, tally);
			break;
		case 5:
			tally_pack(e, &packs[p], candidates[p], 5, tally);
			break;
		case 6:
			tally_pack(e, &packs[p], candidates[p], 6, tally);
			break;
		case 7:
			tally_pack(e, &packs[p], candidates[p], 7, tally);
			break;
		case 8:
			tally_pack(e, &packs[p], candidates[p], 8, tally);
			break;
		default:
			tally_pack(e, &packs[p], candidates[p], found, tally);
		}
	}
}

/* A class leads all over a box by no less than at the centre, less what the slopes can make of that towards the corners. */
TARGET static uint64_t find_candidates(const esk_envelope *e, const esk_box *box, double margin, double *least_lead)
{
	lanes at[ESKEL_LEVELS_MAX / LANES], best = SPREAD(INFINITY), least = SPREAD(INFINITY);
	for (uint32_t j = 0; j < e->count; j += LANES) {
		lanes sum = *(const lanes *)&e->constant[j];
		for (int r = 0; r < 3; r++)
			sum = MULTIPLY_ADD(*(const lanes *)&e->slope[r][j], SPREAD(box->centre[r]), sum);
		at[j / LANES] = sum;
		best = MIN(best, sum);
	}
	const double winning = LEAST(best);
	const uint8_t winner = e->rank[(int64_t)winning & (ESKEL_LEVELS_MAX - 1)];
	uint64_t above = 0;
	for (uint32_t j = 0; j < e->count; j += LANES) {
		lanes lead = at[j / LANES] - winning;
		for (int r = 0; r < 3; r++) {
			const lanes difference = *(const lanes *)&e->slope[r][j] - e->slope[r][winner];
			lead = MULTIPLY_ADD(MAX(difference, -difference), SPREAD(-box->half[r]), lead);
		}
		above |= (uint64_t)WHERE_ABOVE(lead, SPREAD(margin)) << j;
		least = MIN(least, PICK(lead > margin, lead, SPREAD(INFINITY)));
	}
	const double least_left_out = LEAST(least);
	*least_lead = least_left_out < *least_lead ? least_left_out : *least_lead;
	return ~above & (~(uint64_t)0 >> (ESKEL_LEVELS_MAX - e->count));
}

#undef find_candidates
#undef SPREAD
#undef PICK
#undef LEAST
#undef WHERE_ABOVE
#undef tally_pack
#undef tally_packs
#undef divide
#undef integers
#undef lanes
#undef NAMED
#undef JOIN
#undef ONE_MORE_WHERE
#undef MULTIPLY_ADD
#undef MAX
#undef MIN
#undef TARGET
#undef LANES
