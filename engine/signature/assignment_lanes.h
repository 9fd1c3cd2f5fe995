/* The algorithm of assignment.c for one vector width. Included once for each, with these defined:
 *
 *	LANES, NAME, TARGET                  floats a vector, the solver's name and its attribute
 *	MIN, MAX                             on vectors of int32_t
 *	SWAP_HALVES, SWAP_PAIRS, SWAP_LANES  lane l of a vector becomes lane l ^ 4, l ^ 2, l ^ 1
 *	SIGN_BITS                            bit l is set where lane l of a comparison holds
 *	LANE_NUMBERS                         0, 1, 2, ..
 *
 * A row is `pieces` vectors. All is inlined where that is a constant, so that rows stay in registers.
 */
#define JOIN(a, b) a##b
#define NAMED(a, b) JOIN(a, b)
#define INLINE TARGET __attribute__((always_inline)) static inline
#define floats NAMED(floats_, LANES)
#define integers NAMED(integers_, LANES)
#define paths NAMED(paths_, LANES)
#define columns_of_least NAMED(columns_of_least_, LANES)
#define price_columns NAMED(price_columns_, LANES)
#define match_tight_pairs NAMED(match_tight_pairs_, LANES)
#define extend_paths NAMED(extend_paths_, LANES)
#define find_free_column NAMED(find_free_column_, LANES)
#define make_path_tight NAMED(make_path_tight_, LANES)
#define solve_pieces NAMED(solve_pieces_, LANES)

typedef float floats __attribute__((vector_size(4 * LANES), may_alias));
typedef int32_t integers __attribute__((vector_size(4 * LANES), may_alias));

/* The columns that have the least key of all, and that key in every lane. */
INLINE uint64_t columns_of_least(uint32_t pieces, const integers *keys, integers *least)
{
	integers v = keys[0];
	for (uint32_t n = 1; n < pieces; n++)
		v = MIN(v, keys[n]);
	v = MIN(v, SWAP_HALVES(v));
	v = MIN(v, SWAP_PAIRS(v));
	v = MIN(v, SWAP_LANES(v));
	*least = v;
	uint64_t columns = 0;
	for (uint32_t n = 0; n < pieces; n++)
		columns |= (uint64_t)SIGN_BITS(keys[n] == v) << n * LANES;
	return columns;
}

/* Prices of the least cost of each column make all pairs feasible. Those of columns that only pad are finite, so that
 * their reduced costs are infinite. */
INLINE void price_columns(problem *p, uint32_t pieces)
{
	const integers *costs = (const integers *)p->costs;
	for (uint32_t n = 0; n < pieces; n++) {
		integers least = (integers)((floats){0} + FLT_MAX);
		for (uint32_t i = 0; i < p->k; i++)
			least = MIN(least, costs[i * pieces + n]);
		*(integers *)&p->price[n * LANES] = least;
		*(floats *)&p->matched_cost[n * LANES] = (floats){0};
	}
}

/* Each row takes the first column that is tight for it and free. */
INLINE void match_tight_pairs(problem *p, uint32_t pieces)
{
	const floats *costs = (const floats *)p->costs, *price = (const floats *)p->price;
	for (uint32_t i = 0; i < p->k; i++) {
		integers reduced[WIDTH_MAX / LANES], least;
		for (uint32_t n = 0; n < pieces; n++)
			reduced[n] = (integers)(costs[i * pieces + n] - price[n]);
		const uint64_t columns = columns_of_least(pieces, reduced, &least) & p->free_columns;
		if (columns) {
			match(p, i, first_of(columns));
			p->free_rows &= ~(UINT64_C(1) << i);
		}
	}
}

/* Dijkstra from a free row over reduced costs. The length is that of the shortest alternating path to a column which
 * leaves matched rows by settled columns only; settled lanes have all bits but the sign, so that they are never the
 * least again. */
typedef struct {
	integers length[WIDTH_MAX / LANES], came_from[WIDTH_MAX / LANES], settled[WIDTH_MAX / LANES];
} paths;

/* Settles a column at the least length, and goes on through the row that has it. Rounding must not make a path shorter
 * than its beginning. */
INLINE void extend_paths(const problem *p, uint32_t pieces, uint32_t column, integers least, paths *tree)
{
	const uint32_t row = p->row_of_column[column];
	const floats *costs = (const floats *)p->costs + row * pieces, *price = (const floats *)p->price;
	const floats offset = p->u[column] - (floats)least;
	const integers lanes_before = (int32_t)column - (integers){LANE_NUMBERS};
	for (uint32_t n = 0; n < pieces; n++) {
		const integers through = MAX((integers)((costs[n] - price[n]) - offset), least);
		const integers shorter = through < tree->length[n];
		tree->length[n] = MIN(through, tree->length[n]);
		tree->came_from[n] = (shorter & (int32_t)row) | (~shorter & tree->came_from[n]);
		tree->settled[n] |= (lanes_before == (int32_t)(n * LANES)) & INT32_MAX;
	}
}

/* The nearest free column, and its length in every lane. */
INLINE uint32_t find_free_column(problem *p, uint32_t pieces, uint32_t free_row, paths *tree, integers *least)
{
	const floats *costs = (const floats *)p->costs + free_row * pieces, *price = (const floats *)p->price;
	for (uint32_t n = 0; n < pieces; n++) {
		tree->length[n] = (integers)(costs[n] - price[n]);
		tree->came_from[n] = (integers){0} + (int32_t)free_row;
		tree->settled[n] = (integers){0};
		*(floats *)&p->u[n * LANES] = *(floats *)&p->matched_cost[n * LANES] - price[n];
	}
	for (;;) {
		integers open[WIDTH_MAX / LANES];
		for (uint32_t n = 0; n < pieces; n++)
			open[n] = tree->length[n] | tree->settled[n];
		const uint64_t nearest = columns_of_least(pieces, open, least);
		if (nearest & p->free_columns)
			return first_of(nearest & p->free_columns);
		extend_paths(p, pieces, first_of(nearest), *least, tree);
	}
}

/* Prices of settled columns fall by how much nearer they are than the free column; no other column is nearer. */
INLINE void make_path_tight(problem *p, uint32_t pieces, const paths *tree, integers length)
{
	for (uint32_t n = 0; n < pieces; n++) {
		const floats nearer = (floats)length - (floats)tree->length[n];
		*(floats *)&p->price[n * LANES] -= (floats)MAX((integers)nearer, (integers){0});
		*(integers *)&p->came_from[n * LANES] = tree->came_from[n];
	}
}

INLINE void solve_pieces(problem *p, uint32_t pieces)
{
	price_columns(p, pieces);
	match_tight_pairs(p, pieces);
	for (; p->free_rows; p->free_rows &= p->free_rows - 1) {
		paths tree;
		integers length;
		const uint32_t row = first_of(p->free_rows);
		const uint32_t column = find_free_column(p, pieces, row, &tree, &length);
		make_path_tight(p, pieces, &tree, length);
		match_along_path(p, row, column);
	}
}

TARGET static void NAME(problem *p)
{
	switch (p->width) {
	case 8:
		solve_pieces(p, 8 / LANES);
		break;
	case 16:
		solve_pieces(p, 16 / LANES);
		break;
	case 32:
		solve_pieces(p, 32 / LANES);
		break;
	default:
		solve_pieces(p, WIDTH_MAX / LANES);
	}
}

#undef solve_pieces
#undef make_path_tight
#undef find_free_column
#undef extend_paths
#undef match_tight_pairs
#undef price_columns
#undef columns_of_least
#undef paths
#undef integers
#undef floats
#undef INLINE
#undef NAMED
#undef JOIN
#undef LANE_NUMBERS
#undef SIGN_BITS
#undef SWAP_LANES
#undef SWAP_PAIRS
#undef SWAP_HALVES
#undef MAX
#undef MIN
#undef TARGET
#undef NAME
#undef LANES
