/* Skeletons of clouds, their signatures, and distances of signatures. Part of eskel.h. */
#ifndef ESKEL_SKELETON_H
#define ESKEL_SKELETON_H

#include "eskel_volume.h"

/* ---------------------------------------------------------------------------------------------- skeleton */

#define ESKEL_LEVELS_MAX 64
#define ESKEL_LEVELS_DEFAULT 16
#define ESKEL_NODES(levels) ((size_t)(levels) * ((size_t)(levels) + 1) / 2)

typedef enum { ESKEL_PARTITION_EUCLIDEAN, ESKEL_PARTITION_MAHALANOBIS } eskel_partition_metric;

typedef struct {
	uint32_t levels;                    /* 1 to ESKEL_LEVELS_MAX; default 16 */
	eskel_partition_metric metric;      /* section 2.4.6 */
	bool coarse_start;                  /* section 2.4.4: partitions of the cloud of 3x3x3 cells start each level */
	uint32_t threads;                   /* at most; default 1 */
	bool (*progress)(void *context, uint32_t level, uint32_t levels); /* after each level; false: ESKEL_CANCELLED */
	void *context;
} eskel_skeleton_options;

#define ESKEL_THREADS_ONLINE UINT32_MAX /* as many threads as there are processors */

/* One class of one level (section 2.5). Moments are population moments of the voxel centres. */
typedef struct {
	uint32_t level;             /* 1-based */
	uint32_t class_index;       /* 0-based within its level */
	int32_t parent;             /* class of the level above, -1 at level 1 */
	uint64_t voxels;
	double weight;
	double centre[3];           /* mm */
	double covariance[3][3];    /* mm^2, symmetric */
	double eigenvalues[3];      /* mm^2, descending, never negative */
	double axes[3][3];          /* row i is the unit axis of eigenvalue i; right-handed; a line, so its sign means nothing */
	double rho;                 /* mm, distance of centre from the centre of the whole */
} eskel_node;

typedef struct {
	uint32_t level;
	int32_t split_class;        /* class of the level above that was split, -1 at level 1 */
	double split_ratio;         /* section 2.4.2, weighted; 0 at level 1; of the coarse cloud after a coarse start */
	double intraclass_ratio;    /* sum w_i V_i / (w V); 1 at level 1, 0 if V = 0 */
	bool degenerate;            /* the split axis was undefined (equal eigenvalues) */
} eskel_level;

typedef struct {
	eskel_partition_metric metric;
	bool coarse_start;
	uint32_t level_count;       /* may be fewer than asked: a level needs a class with two distinct points */
	uint32_t level_of_5_percent; /* first level whose intraclass ratio is at most 0.05, 0 if none */
	uint64_t voxels;
	double weight;
	double volume;              /* mm^3 */
	eskel_level *levels;        /* [level_count]; level k at k - 1 */
	eskel_node *nodes;          /* [ESKEL_NODES(level_count)]; class c of level k at ESKEL_NODES(k - 1) + c */
} eskel_skeleton;

/* Progressive dynamic clustering (section 2.4). A class that is not split keeps its index; of the two parts of a
 * split class the heavier keeps it and the other becomes class k - 1 of level k. */
ESKEL_API eskel_status eskel_skeleton_new(const eskel_cloud *cloud, const eskel_skeleton_options *options,
	eskel_skeleton **skeleton, eskel_error *error);
/* The skeletons of many clouds, skeletons[i] of clouds[i]. Threads take the largest first. Progress counts the levels of
 * all, in calls that do not overlap, from any thread. On failure there is none, and the error is that of the first cloud
 * that fails. */
ESKEL_API eskel_status eskel_skeletons_new(const eskel_cloud *const *clouds, size_t count,
	const eskel_skeleton_options *options, eskel_skeleton **skeletons, eskel_error *error);
ESKEL_API void eskel_skeleton_free(eskel_skeleton *skeleton);
ESKEL_API const eskel_node *eskel_skeleton_node(const eskel_skeleton *skeleton, uint32_t level, uint32_t class_index);

/* Writes the indices, in the level below, of a node's one or two children; returns how many (0 at the last level). */
ESKEL_API unsigned eskel_skeleton_children(const eskel_skeleton *skeleton, uint32_t level, uint32_t class_index,
	uint32_t children[2]);

ESKEL_API eskel_status eskel_skeleton_encode(const eskel_skeleton *skeleton, uint8_t **bytes, size_t *size);
ESKEL_API eskel_status eskel_skeleton_decode(const uint8_t *bytes, size_t size, eskel_skeleton **skeleton,
	eskel_error *error);

/* ---------------------------------------------------------------------------------------------- signature */

/* Per class: sqrt(lambda_1), sqrt(lambda_2), sqrt(lambda_3), rho in mm (section 5.2.1), and the solidity
 * q = w V / (4/3 pi 5^1.5 sqrt(det M)), without unit, 1 for a solid ellipsoid, at most 1.25. They are 32-bit floats,
 * widened, so that their bytes lose nothing. */
#define ESKEL_SIGNATURE_NUMBERS 5

typedef struct {
	uint32_t level_count;
	double volume;                                  /* mm^3 */
	double (*rows)[ESKEL_SIGNATURE_NUMBERS];        /* [ESKEL_NODES(level_count)], ordered as skeleton nodes */
} eskel_signature;

ESKEL_API eskel_status eskel_signature_new(const eskel_skeleton *skeleton, eskel_signature **signature);
ESKEL_API void eskel_signature_free(eskel_signature *signature);
ESKEL_API eskel_status eskel_signature_encode(const eskel_signature *signature, uint8_t **bytes, size_t *size);
ESKEL_API eskel_status eskel_signature_decode(const uint8_t *bytes, size_t size, eskel_signature **signature,
	eskel_error *error);

/* ---------------------------------------------------------------------------------------------- distance, match */

typedef enum { ESKEL_SIGNATURE_LOG, ESKEL_SIGNATURE_PAPER } eskel_signature_kind;
typedef enum { ESKEL_DISTANCE_SUM, ESKEL_DISTANCE_LEVEL } eskel_distance_kind;
typedef enum { ESKEL_METRIC_MANHATTAN, ESKEL_METRIC_EUCLIDEAN, ESKEL_METRIC_ROOT } eskel_metric;
typedef enum { ESKEL_SIZE_FIXED, ESKEL_SIZE_FREE } eskel_size;

/* Two signatures:
 *   log    f = ln(number + 0.02) of the five numbers of the shape brought to volume 1; D_k = matching cost / k;
 *          sum: the mean of D_k over the levels that both have, 1 to at most 16; size fixed adds 0.2 |ln V - ln V'|.
 *   paper  sqrt(lambda) and rho in mm (size fixed) or of the shape brought to volume 1 (free), q unused;
 *          D_k = matching cost; sum: the sum of D_k / k over the levels that both have, 1 to at most 16.
 * The metric root adds up the square roots of the differences, so that one number that is far off counts for less; size fixed
 * then adds 0.15 sqrt |ln V - ln V'|.
 * Both are computed from the same 32-bit floats that the library keeps, so every route to a distance agrees. */
typedef struct {
	eskel_signature_kind signature;
	eskel_distance_kind distance;
	uint32_t level;             /* for ESKEL_DISTANCE_LEVEL; default 10; the deepest common level if that is less */
	eskel_metric metric;        /* between two class signatures */
	eskel_size size;
} eskel_distance_options;

/* levels[k - 1] receives D_k for k = 1..*level_count (NULL: not wanted); it has room for ESKEL_LEVELS_MAX. */
ESKEL_API eskel_status eskel_distance(const eskel_signature *a, const eskel_signature *b,
	const eskel_distance_options *options, double *distance, double *levels, uint32_t *level_count);

/* The min-cost bijection at one level (section 5.2.2). Ties are broken the same way every time. */
typedef struct {
	uint32_t level;
	double cost;                           /* sum of pair costs */
	uint32_t other[ESKEL_LEVELS_MAX];      /* class i of a is matched with class other[i] of b */
	double pair_cost[ESKEL_LEVELS_MAX];
} eskel_match;

/* ESKEL_INVALID unless both have the level. */
ESKEL_API eskel_status eskel_match_level(const eskel_signature *a, const eskel_signature *b,
	const eskel_distance_options *options, uint32_t level, eskel_match *match);

#endif
