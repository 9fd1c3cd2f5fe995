/* The library: many shapes searched, how well distances do on them, and what pictures of distances need. Part of
 * eskel.h. */
#ifndef ESKEL_LIBRARY_H
#define ESKEL_LIBRARY_H

#include "eskel_skeleton.h"

/* ---------------------------------------------------------------------------------------------- library */

/* Signatures of many shapes, searched coarse to fine (section 5.3). Any number of threads may search, add and remove at
 * once; readers never wait for writers, and see the library as it was when they began. */
typedef struct eskel_library eskel_library;

ESKEL_API eskel_status eskel_library_new(eskel_library **library);
ESKEL_API void eskel_library_free(eskel_library *library);
/* Keys are the caller's and unique (ESKEL_INVALID otherwise). Copies the signature. */
ESKEL_API eskel_status eskel_library_add(eskel_library *library, int64_t key, const eskel_signature *signature);
/* The same in two steps: several threads prepare shapes at once, and one adds them in its order. Adding takes the prepared
 * shape, also on failure; what is not added is to be freed. */
typedef struct eskel_prepared eskel_prepared;
ESKEL_API eskel_status eskel_library_prepare(eskel_library *library, const eskel_signature *signature,
	eskel_prepared **prepared);
ESKEL_API eskel_status eskel_library_add_prepared(eskel_library *library, int64_t key, eskel_prepared *prepared);
ESKEL_API void eskel_prepared_free(eskel_prepared *prepared);
ESKEL_API eskel_status eskel_library_remove(eskel_library *library, int64_t key);
ESKEL_API size_t eskel_library_count(const eskel_library *library);

/* Distances of every pair of rows x columns, written row by row into distances[row_count * column_count].
 * ESKEL_NOT_FOUND when a key is not in the library. */
ESKEL_API eskel_status eskel_library_distances(const eskel_library *library, const int64_t *rows, size_t row_count,
	const int64_t *columns, size_t column_count, const eskel_distance_options *options, double *distances);

/* A table of any size, computed as it is asked for, row by row, in pieces that need not end where a row does. The shapes
 * are those of the library when the table was made, whatever becomes of them meanwhile. The result is the same for any
 * pieces and threads. Of the same rows and columns each pair is computed once as far as pairs may be
 * kept, and otherwise twice. */
typedef struct eskel_distance_table eskel_distance_table;

typedef struct {
	eskel_distance_options distance;
	uint32_t threads;               /* 0: one */
	size_t most_kept;               /* pairs, 8 bytes each: all of the table or none; default 2^22, of 2895 shapes.
	                                   Beside them a table takes 16 bytes a shape, and 6 MB while it computes */
} eskel_distance_table_options;

ESKEL_API eskel_status eskel_distance_table_new(const eskel_library *library, const int64_t *rows, size_t row_count,
	const int64_t *columns, size_t column_count, const eskel_distance_table_options *options,
	eskel_distance_table **table);
ESKEL_API void eskel_distance_table_free(eskel_distance_table *table);
/* The next distances, at most so many; *count is 0 after the last one. */
ESKEL_API eskel_status eskel_distance_table_next(
	eskel_distance_table *table, size_t most, double *distances, size_t *count);

/* A set of keys is an array of these: bit i of members is set when it holds the key first + i. */
typedef struct {
	int64_t first;                  /* a multiple of 64; ascends from block to block */
	uint64_t members;
} eskel_key_block;

/* Adds key + i for each bit i of members, to a set with none above the least of them, and returns how many blocks there are
 * then: never more than keys. */
ESKEL_API size_t eskel_key_blocks_add(eskel_key_block *blocks, size_t count, int64_t key, uint64_t members);

/* exact finds what comparing with every shape would find; pruned is the paper's: the nearest tenth at each level (keep),
 * never fewer than 10 (minimum) or than are wanted, then full depth, and may miss the nearest. */
typedef enum { ESKEL_SEARCH_EXACT, ESKEL_SEARCH_PRUNED } eskel_search_mode;
/* neighbourhood puts a shortlist, the nearest 40 or 35 more than are wanted, in the order of d / sqrt(s s'), where s of a
 * shape is its mean distance to the 8 nearest in the whole library, whatever takes part (but without the left-out key for
 * the query). */
typedef enum { ESKEL_SCALE_NONE, ESKEL_SCALE_NEIGHBOURHOOD } eskel_scale;

typedef struct {
	eskel_distance_options distance;
	eskel_search_mode mode;
	double keep;                    /* pruned: the share that a level keeps, above 0 to 1; default 0.1 */
	size_t minimum;                 /* pruned: the fewest that a level keeps; default 10 */
	eskel_scale scale;
	size_t limit;                   /* neighbours wanted; default 5 */
	const eskel_key_block *keys;    /* compare with these only (a filter's answer); NULL: all */
	size_t key_block_count;
	bool leave_out;                 /* leave out the shape with this key (a stored shape's own) */
	int64_t left_out_key;
	bool watch;                     /* pruned: follow the shape with this key through the steps */
	int64_t watched_key;
} eskel_search_options;

typedef struct {
	int64_t key;
	double distance;
	double scaled;                         /* by neighbourhoods, or 0 */
	uint32_t level_count;
	double levels[ESKEL_LEVELS_MAX];       /* D_k */
} eskel_neighbour;

typedef struct {
	size_t library;                        /* shapes that took part */
	uint32_t step_count;                   /* coarse-to-fine steps taken */
	size_t kept[ESKEL_LEVELS_MAX];         /* shapes still in after each step */
	uint32_t watched_steps;                /* steps after which the watched shape was still in */
	size_t compared;                       /* shapes compared to full depth */
	bool proven;                           /* no shape outside the answer is nearer; scaled: all were on the shortlist */
	size_t count;
	eskel_neighbour *neighbours;           /* by distance, scaled if asked for, then key */
} eskel_search_result;

ESKEL_API eskel_status eskel_library_search(const eskel_library *library, const eskel_signature *query,
	const eskel_search_options *options, eskel_search_result **result);
ESKEL_API void eskel_search_result_free(eskel_search_result *result);

/* ---------------------------------------------------------------------------------------------- evaluation */

/* How well distances find shapes of the same class. A query's ranking is of all shapes but those left out, by distance.
 * Of n ranked, R are relevant: of the query's class; hits(t) is how many of these are among the first t. The measures are
 * those of the Princeton Shape Benchmark (Shilane, Min, Kazhdan, Funkhouser 2004), 0 to 1, more is better:
 *   nearest neighbour  hits(1)
 *   first tier         hits(R) / R
 *   second tier        hits(2 R) / R
 *   E-measure          2 / (1 / precision + 1 / recall) of the first t = min(32, n): 2 hits(t) / (t + R)
 *   DCG                the sum of 1 / max(1, log2 rank) over the relevant, divided by that over the ranks 1 to R
 *   precision          at recall s / 20, s = 1..20: the most of j / rank of the jth relevant over j >= s R / 20
 * The query is in no ranking, so R is its class's size less 1. The paper prints the whole size in the divisor of the DCG;
 * the benchmark's own program (psbTable) divides as here, so that a perfect ranking has DCG 1.
 * Where we differ: classes of two shapes count (psbTable skips them), and ties have no order. A measure is its mean over all
 * orders of shapes at equal distance; for the precision, each relevant one of them stands at its mean rank. */
#define ESKEL_UNNUMBERED UINT32_MAX

typedef struct {
	size_t count;
	const uint32_t *classes;        /* [count] any numbers; ESKEL_UNNUMBERED: of no class, never relevant */
	const uint32_t *subjects;       /* a query leaves out all of its subject, ESKEL_UNNUMBERED: of nobody;
	                                   NULL: it leaves out itself alone */
} eskel_evaluation;

#define ESKEL_RECALL_STEPS 20

typedef struct {
	size_t ranked, relevant;        /* n and R; without a relevant shape all measures are 0 */
	double nearest_neighbour, first_tier, second_tier, e_measure, dcg;
	double precision[ESKEL_RECALL_STEPS];
} eskel_retrieval;

ESKEL_API bool eskel_evaluation_leaves_out(const eskel_evaluation *evaluation, size_t query, size_t other);
/* The measures of one query by its distances to all shapes (those to the left out are not read). */
ESKEL_API eskel_status eskel_evaluation_judge(const eskel_evaluation *evaluation, size_t query,
	const double *distances, eskel_retrieval *retrieval);
/* The means over the queries that have a relevant shape; returns how many these are. */
ESKEL_API size_t eskel_retrieval_mean(const eskel_retrieval *retrievals, size_t count, eskel_retrieval *mean);
/* ---------------------------------------------------------------------------------------------- pictures of distances */

/* Both take distances[count * count], symmetric with a zero diagonal. */

/* Two clusters become one. Those of the shapes are 0 .. count - 1, that of step s is count + s. */
typedef struct {
	uint32_t first, second;     /* clusters, first < second */
	double height;              /* mean distance between their shapes */
	uint32_t size;              /* shapes of both */
} eskel_merge;

/* Hierarchical clustering by average linkage: merges[count - 1], of ascending height. Of equal distances those of the
 * shapes that come first count. O(count^2). */
ESKEL_API eskel_status eskel_clustering(const double *distances, size_t count, eskel_merge *merges);
/* The shapes from one end of the tree to the other, order[count]: of two clusters the one of lower height comes first,
 * of equal ones the one with the lower number. */
ESKEL_API eskel_status eskel_clustering_order(const eskel_merge *merges, size_t count, uint32_t *order);

/* Classical scaling: points[count] in the plane whose distances resemble the given ones best, in their unit. Centred;
 * the first coordinate has the larger spread; of each the first value that is at least 0.65 of the largest one is
 * positive. A coordinate without spread is 0. */
ESKEL_API eskel_status eskel_scaling(const double *distances, size_t count, double (*points)[2]);

#endif
