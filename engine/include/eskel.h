/* eskel: shapes as ellipsoidal skeletons.
 *
 * The engine, in the order of its pipeline: a volume is decoded into clouds of voxels, a cloud becomes a
 * skeleton, a skeleton has a signature, signatures are matched and searched, skeletons are compared for
 * handedness and laid on one another. Pure computation: nothing here opens a file, a socket or a database, prints, or keeps state
 * outside the objects that it returns.
 *
 * Conventions, everywhere:
 * - World space is RAS (x to the right, y to the front, z to the head) in millimetres.
 * - A function that can fail returns an eskel_status and writes its outputs last: they are untouched on failure.
 * - An eskel_error is optional (NULL); it receives one sentence with the offending and the expected value.
 * - Objects made by a _new or _decode are owned by the caller and released by the matching _free, which takes NULL.
 * - Options are plain structs in which zero means the default, and NULL means all defaults.
 * - Results are the same for any number of threads and on any machine.
 *
 * "Section" refers to the paper: Banegas, Michelucci, Roelens, Jaeger, "The Ellipsoidal Skeleton in Medical
 * Applications".
 */
#ifndef ESKEL_H
#define ESKEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ESKEL_API __attribute__((visibility("default")))

/* ---------------------------------------------------------------------------------------------- status */

#define ESKEL_STATUSES(X)                                                \
	X(ESKEL_OK, "no error")                                          \
	X(ESKEL_INVALID, "an argument is outside its range")             \
	X(ESKEL_NO_MEMORY, "memory ran out")                             \
	X(ESKEL_NOT_VOLUME, "the bytes are not a volume of a known format") \
	X(ESKEL_TRUNCATED, "the bytes end too early")                    \
	X(ESKEL_MALFORMED, "the bytes break the rules of their format")  \
	X(ESKEL_UNSUPPORTED, "the format is known, this use of it is not supported") \
	X(ESKEL_TOO_LARGE, "a limit is exceeded")                        \
	X(ESKEL_BAD_GEOMETRY, "the voxel-to-world affine is unusable")   \
	X(ESKEL_BAD_VALUE, "a voxel value is not a label")               \
	X(ESKEL_EMPTY, "there is no voxel")                              \
	X(ESKEL_NOT_FOUND, "there is no such thing")                     \
	X(ESKEL_NUMERIC, "a computation did not converge")               \
	X(ESKEL_CANCELLED, "the caller asked to stop")

#define ESKEL_STATUS_CODE(code, text) code,
typedef enum { ESKEL_STATUSES(ESKEL_STATUS_CODE) ESKEL_STATUS_COUNT } eskel_status;
#undef ESKEL_STATUS_CODE

/* A sentence for a status, static. */
ESKEL_API const char *eskel_status_text(eskel_status status);

typedef struct {
	eskel_status status;
	char text[256];
} eskel_error;

/* ---------------------------------------------------------------------------------------------- affine */

/* Voxel index (i, j, k) to world mm: world[r] = m[r][0] i + m[r][1] j + m[r][2] k + m[r][3].
 * An integer index is the centre of its voxel. */
typedef struct {
	double m[3][4];
} eskel_affine;

/* ESKEL_BAD_GEOMETRY unless every entry is finite, every column is 1e-4 to 1e4 mm long and |det| is at least
 * 1e-3 of the product of the column lengths. Oblique, sheared and left-handed affines are fine. */
ESKEL_API eskel_status eskel_affine_check(const eskel_affine *affine, eskel_error *error);
ESKEL_API double eskel_affine_determinant(const eskel_affine *affine);

/* ---------------------------------------------------------------------------------------------- warnings */

/* Things that a person should know about an accepted input. The code is stable, the text is for people. */
#define ESKEL_WARNINGS(X) \
	X(ESKEL_WARNING_SFORM_QFORM_DISAGREE, "sform_qform_disagree") \
	X(ESKEL_WARNING_NO_ORIENTATION, "no_orientation") \
	X(ESKEL_WARNING_UNIT_ASSUMED, "unit_assumed") \
	X(ESKEL_WARNING_NAMES_INCOMPLETE, "names_incomplete") \
	X(ESKEL_WARNING_NAMES_ASSUMED, "names_assumed") \
	X(ESKEL_WARNING_SELF_INTERSECTING, "self_intersecting") \
	X(ESKEL_WARNING_VOLUME_DIFFERS, "volume_differs") \
	X(ESKEL_WARNING_SLICE_DISTANCE, "slice_distance") \
	X(ESKEL_WARNING_ANISOTROPIC, "anisotropic") \
	X(ESKEL_WARNING_NOT_ORTHOGONAL, "not_orthogonal") \
	X(ESKEL_WARNING_TOUCHES_BORDER, "touches_border") \
	X(ESKEL_WARNING_FRAGMENTED, "fragmented") \
	X(ESKEL_WARNING_HOLES, "holes") \
	X(ESKEL_WARNING_FEW_VOXELS, "few_voxels") \
	X(ESKEL_WARNING_FLAT, "flat") \
	X(ESKEL_WARNING_FEWER_LEVELS, "fewer_levels")

#define ESKEL_WARNING_CODE(code, name) code,
typedef enum { ESKEL_WARNINGS(ESKEL_WARNING_CODE) ESKEL_WARNING_COUNT } eskel_warning_code;
#undef ESKEL_WARNING_CODE

typedef struct {
	eskel_warning_code code;
	char text[200];
} eskel_warning;

/* "sform_qform_disagree" and so on, static. */
ESKEL_API const char *eskel_warning_name(eskel_warning_code code);

/* ---------------------------------------------------------------------------------------------- cloud */

/* A maximal stretch of voxels of one weight along the first index axis, both ends included. */
typedef struct {
	uint16_t x_first, x_last, y, z;
} eskel_run;

/* The voxels of one object. Always canonical, so that the same object is the same cloud whatever file it came
 * from: index axes permuted and flipped to the nearest RAS orientation, the least index on each axis is 0, runs
 * sorted by (z, y, x_first), disjoint and maximal, matrix entries rounded to float (what NIfTI can hold) and to the
 * float spacing of the largest entry in their column (noise about 0 is 0), the offset to 1/1024 of the power of two
 * next below the largest matrix entry. */
typedef struct {
	eskel_affine affine;
	uint64_t voxels;         /* sum of run lengths */
	uint64_t weight;         /* sum of run lengths times weights; = voxels when weights is NULL */
	uint16_t extent[3];      /* largest index on each axis, plus 1 */
	size_t run_count;        /* at least 1 */
	eskel_run *runs;
	uint32_t *weights;       /* one positive integer a run, or NULL when every voxel weighs 1 */
} eskel_cloud;

/* Makes the canonical cloud of runs in any order, which may touch but not overlap (ESKEL_INVALID). Copies.
 * Weights are 1 to 2^20. ESKEL_EMPTY for no runs; ESKEL_TOO_LARGE past 2^27 runs, 2^33 voxels, a weight sum of 2^44
 * or an extent of 65535. O(n log n) in the runs given and made. */
ESKEL_API eskel_status eskel_cloud_new(const eskel_run *runs, const uint32_t *weights, size_t run_count,
	const eskel_affine *affine, eskel_cloud **cloud, eskel_error *error);
ESKEL_API void eskel_cloud_free(eskel_cloud *cloud);

/* Voxels times |det affine|, mm^3. */
ESKEL_API double eskel_cloud_volume(const eskel_cloud *cloud);

/* Lossless bytes with a version, a few a run; the same cloud always gives the same bytes. free() them. */
ESKEL_API eskel_status eskel_cloud_encode(const eskel_cloud *cloud, uint8_t **bytes, size_t *size);
/* ESKEL_MALFORMED, ESKEL_TRUNCATED or ESKEL_TOO_LARGE for bytes that no encode made. */
ESKEL_API eskel_status eskel_cloud_decode(const uint8_t *bytes, size_t size, eskel_cloud **cloud, eskel_error *error);

/* ---------------------------------------------------------------------------------------------- components */

/* Connected pieces, without regard to weights. */
typedef struct {
	size_t count;
	uint64_t voxels;         /* of all together */
	uint64_t *sizes;         /* [count]; voxels of each, descending */
} eskel_components;

/* The pieces that a cloud is in, joined over faces, edges and corners of voxels; at least one. Near-linear in the runs. */
ESKEL_API eskel_status eskel_cloud_components(const eskel_cloud *cloud, eskel_components **components);
/* The pieces of the background, joined over faces, that the cloud encloses. */
ESKEL_API eskel_status eskel_cloud_cavities(const eskel_cloud *cloud, eskel_components **cavities);
ESKEL_API void eskel_components_free(eskel_components *components);

/* ---------------------------------------------------------------------------------------------- volume */

/* Writes the first bytes of what is gzipped, as far as the first size bytes of the gzip stream tell; returns how many, at
 * most most. */
ESKEL_API size_t eskel_gzip_begin(const uint8_t *bytes, size_t size, uint8_t *begin, size_t most);

/* A push decoder: feed it the file's bytes as they arrive, in pieces of any size; rows become runs at once, and
 * memory is bounded by the runs. What the bytes are is decided by content. Reads NIfTI-1 and NIfTI-2 single files, NRRD
 * files with their voxels attached (raw, gzip, bzip2 or text; 3D Slicer segmentations among them), MetaImage files with
 * theirs (.mha, compressed or not) and FreeSurfer's MGH files; either endianness, gzipped or not. Overlapping segments of 3D
 * Slicer (at most 256 layers) are labelled by their label values, or, where two have the same, by their numbers from 1 on;
 * voxels of a layer that no segment describes are left out. Nothing is ever opened: a header that names another file is
 * refused.
 *
 * A closed mesh becomes a volume: STL (binary or ASCII), PLY (ASCII or binary) or OBJ, gzipped or not. Voxels whose centre
 * is inside have label 1, all else is outside; memory is bounded by the triangles, at most 2^22. Inside is where the
 * winding number is not 0, so parts that overlap unite, with a warning that says how much is enclosed more than once or
 * inside out. Voxels are cubic: of the spacing that is given, along the axes; else about 100,000, on a turned grid, where
 * flat faces along the axes gain and lose no layers. A warning says where their volume is more than 1 % off the mesh's. An
 * open mesh is ESKEL_MALFORMED. The unit is assumed to be mm, with a warning; the space is RAS, with a warning unless a
 * comment (in binary STL the header) says SPACE=RAS, or SPACE=LPS, which is turned to RAS, as 3D Slicer writes it. */
typedef struct eskel_volume eskel_volume;

typedef struct {
	uint64_t most_voxels;          /* of the grid; default 2^33 */
	size_t most_runs;              /* over all labels; default 2^27 */
	uint32_t most_labels;          /* default 4096 */
	const int32_t *labels;         /* keep only these (non-zero, any order); default all non-zero labels */
	size_t label_count;
	double spacing;                /* of a mesh's voxels, mm; default what makes about 100,000; others refuse it */
	/* Voxels are no labels but say how much of one object, label 1, they hold: probabilities, partial volumes (section
	 * 2.1). Finite, not negative; kept to 1/4080 of the largest, and what rounds to 0 is not in the object. */
	bool weights;
} eskel_volume_options;

ESKEL_API eskel_status eskel_volume_new(const eskel_volume_options *options, eskel_volume **volume);
/* After a failure every further call returns the same status and error. Bytes after the last voxel are an error, but for a
 * footer of at most 1 MiB in an MGH file. */
ESKEL_API eskel_status eskel_volume_feed(eskel_volume *volume, const void *bytes, size_t size, eskel_error *error);
/* All bytes are there: ESKEL_TRUNCATED if voxels or checksums are missing, ESKEL_EMPTY if no voxel has a label. */
ESKEL_API eskel_status eskel_volume_finish(eskel_volume *volume, eskel_error *error);
ESKEL_API void eskel_volume_free(eskel_volume *volume);

#define ESKEL_VOLUME_WARNINGS_MAX 4 /* of one volume; what would be more is not said */

/* The rest is for a finished volume. */
typedef struct {
	const char *format;            /* "NIfTI-1", "NIfTI-2", "NRRD", "MetaImage", "MGH", "STL", "PLY", "OBJ" or what runs began with, static */
	bool gzipped;                  /* the whole file, header and all */
	uint32_t extent[3];
	eskel_affine affine;
	size_t warning_count;
	eskel_warning warnings[ESKEL_VOLUME_WARNINGS_MAX];
} eskel_volume_info;

/* Adds a warning, for who describes a volume; of more than there is room for, the first stay. */
ESKEL_API void eskel_volume_warn(eskel_volume_info *info, eskel_warning_code code, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
ESKEL_API const eskel_volume_info *eskel_volume_get_info(const eskel_volume *volume);
/* The labels found, ascending. */
ESKEL_API size_t eskel_volume_label_count(const eskel_volume *volume);
ESKEL_API int32_t eskel_volume_label(const eskel_volume *volume, size_t index);
/* What the file calls the label: a segment's name, with the side that its terminology says; the entry of a label table in a
 * NIfTI header extension or in an MGH file's footer; where that has none, FreeSurfer's own name, with a warning. At most 200
 * bytes as they are in the file, which may be no UTF-8; NULL when it does not say. The volume's. */
ESKEL_API const char *eskel_volume_label_name(const eskel_volume *volume, int32_t label);
/* Bit b of sides (0..5: x low, x high, y low, y high, z low, z high) is set when the label's voxels touch that
 * border of the grid. ESKEL_NOT_FOUND when no voxel has the label. */
ESKEL_API eskel_status eskel_volume_border(const eskel_volume *volume, int32_t label, unsigned *sides);
ESKEL_API eskel_status eskel_volume_cloud(const eskel_volume *volume, int32_t label, eskel_cloud **cloud,
	eskel_error *error);

/* In place of feeding bytes, for objects that become runs elsewhere: first begin, with the format, the extent, the affine
 * and the warnings; then the runs, in any order, and what their labels are called; then finish. Labels may overlap one
 * another, none itself. Limits and kept labels are those of the options. ESKEL_INVALID for a run outside the grid. */
ESKEL_API eskel_status eskel_volume_begin_runs(eskel_volume *volume, const eskel_volume_info *info,
	eskel_error *error);
ESKEL_API eskel_status eskel_volume_add_run(eskel_volume *volume, int32_t label, eskel_run run, eskel_error *error);
ESKEL_API eskel_status eskel_volume_name_label(eskel_volume *volume, int32_t label, const char *name,
	eskel_error *error);

/* A cloud as the bytes of a file that a volume decoder reads back: the same cloud, bit for bit. Every voxel of it has the
 * label, or, where voxels have weights, its weight, to be read as such; the grid is the cloud's with one empty voxel around (none along an axis of more than 65533). */
typedef enum {
	ESKEL_VOLUME_NIFTI, /* gzipped NIfTI-1; NIfTI-2 where floats or 16-bit extents would not give the cloud back */
	ESKEL_VOLUME_NRRD   /* gzip-encoded voxels attached, space RAS */
} eskel_volume_format;

typedef struct eskel_volume_writer eskel_volume_writer;

/* Borrows the cloud. ESKEL_UNSUPPORTED for weights that no decoder gives (eskel_volume_options) or not with label 1, and for
 * label 0. */
ESKEL_API eskel_status eskel_volume_writer_new(const eskel_cloud *cloud, int32_t label, eskel_volume_format format,
	eskel_volume_writer **writer);
ESKEL_API void eskel_volume_writer_free(eskel_volume_writer *writer);
/* Writes the next bytes, at most capacity, which is not 0; returns how many, 0 after the last. */
ESKEL_API size_t eskel_volume_writer_next(eskel_volume_writer *writer, void *bytes, size_t capacity);

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

/* ---------------------------------------------------------------------------------------------- chirality */

/* A skeleton as comparing handedness needs it: made once, compared often. Levels above 16 are left out. */
typedef struct eskel_placement eskel_placement;

ESKEL_API eskel_status eskel_placement_new(const eskel_skeleton *skeleton, eskel_placement **placement);
ESKEL_API void eskel_placement_free(eskel_placement *placement);
/* In bytes; 13,900 with 16 levels. */
ESKEL_API size_t eskel_placement_size(const eskel_placement *placement);

typedef enum { ESKEL_CHIRALITY_UNDECIDED, ESKEL_CHIRALITY_SAME, ESKEL_CHIRALITY_MIRRORED } eskel_chirality_verdict;

typedef struct {
	eskel_chirality_verdict verdict;
	double score;                   /* (improper - proper) / (improper + proper + 0.01); > 0: same handedness */
	double proper, improper;        /* what is left apart when b is turned, or mirrored and turned, on a: 0 to 1 */
	bool has_determinant;           /* both have a level of at least 4 */
	uint32_t determinant_level;
	double determinant[2];          /* section 5.5: of a's four classes, and of the four matched with them in b, mm^3 */
} eskel_chirality;

/* Is b shaped like a, or like a's mirror image? Undecided when |score| < 0.05, or when nothing can be told
 * (fewer than 4 common levels). */
ESKEL_API eskel_status eskel_chirality_compare(const eskel_placement *a, const eskel_placement *b,
	eskel_chirality *chirality);

/* ---------------------------------------------------------------------------------------------- isomorphism */

/* How deep two trees are alike (section 5.4): down to depth, the splits of a are those of b under the bijection. */
typedef struct {
	uint32_t depth;                 /* deepest level with a bijection, at least 1 */
	bool complete;                  /* depth is the deepest level that both have */
	int32_t split_class[2];         /* of level depth: what a and b split next, -1 where the tree ends; unless complete,
	                                 * the bijection does not match them */
	uint8_t other[ESKEL_NODES(ESKEL_LEVELS_MAX)]; /* down to depth, class c of level k of a at ESKEL_NODES(k - 1) + c */
} eskel_isomorphism;

/* The parts of matched split classes are matched one way or the other, whichever costs less in class signatures, and in
 * their own order on a tie. Swapping a and b inverts the bijection. ESKEL_INVALID as eskel_distance. */
ESKEL_API eskel_status eskel_isomorphism_find(const eskel_skeleton *a, const eskel_skeleton *b,
	const eskel_distance_options *options, eskel_isomorphism *isomorphism);

/* ---------------------------------------------------------------------------------------------- partition signature */

/* A k-partition as a whole (section 5.6). Distances change with nothing but size and shape; so do volumes, up to the sign
 * that all of them change in a mirror. */
typedef struct {
	uint32_t level;
	double volume;              /* of the whole, mm^3 */
	size_t distance_count;      /* k (k - 1) / 2 */
	double *distances;          /* mm, of class centres i < j, lexicographic */
	size_t tetrahedron_count;   /* k (k - 1) (k - 2) (k - 3) / 24 */
	double *tetrahedra;         /* mm^3, signed volumes, of class centres i < j < l < m, lexicographic */
} eskel_partition_signature;

/* order[i] is the class that comes i-th, as in eskel_match.other to compare with a match's other shape; NULL: as they are
 * numbered. ESKEL_INVALID unless the skeleton has the level and order all its classes. 5 MB at level 64, O(k^4). */
ESKEL_API eskel_status eskel_partition_signature_new(const eskel_skeleton *skeleton, uint32_t level,
	const uint32_t *order, eskel_partition_signature **signature);
ESKEL_API void eskel_partition_signature_free(eskel_partition_signature *signature);

/* Means of differences, entry by entry: 0 where a level is too low to have any. */
typedef struct {
	double distances;           /* mm */
	double tetrahedra;          /* mm^3, of unsigned volumes; never above the next two */
	double same_tetrahedra;     /* of signed volumes */
	double mirrored_tetrahedra; /* of signed volumes, those of b with the other sign */
} eskel_partition_difference;

/* Where size is free b is brought to the volume of a first. ESKEL_INVALID unless of one level. */
ESKEL_API eskel_status eskel_partition_signature_compare(const eskel_partition_signature *a,
	const eskel_partition_signature *b, eskel_size size, eskel_partition_difference *difference);

/* ---------------------------------------------------------------------------------------------- position signature */

/* The log signature with |x|, |y|, |z| of a class centre in the natural frame (section 2.2) in the place of rho: no rotation,
 * translation or mirror changes it. Where two eigenvalues of the whole are close the frame is noise. Levels above 16 are
 * left out. */
typedef struct eskel_position_signature eskel_position_signature;

ESKEL_API eskel_status eskel_position_signature_new(const eskel_skeleton *skeleton,
	eskel_position_signature **signature);
ESKEL_API void eskel_position_signature_free(eskel_position_signature *signature);
/* In bytes; 3,800 with 16 levels. */
ESKEL_API size_t eskel_position_signature_size(const eskel_position_signature *signature);
/* The mean of matching cost / k over the levels that both have; size fixed adds 0.2 |ln V - ln V'|. */
ESKEL_API double eskel_position_distance(const eskel_position_signature *a, const eskel_position_signature *b,
	eskel_size size);

/* ---------------------------------------------------------------------------------------------- superposition */

/* An isometry that lays a shape on another one. */
typedef struct {
	eskel_affine map;   /* from world mm of a to world mm of b; its linear part is orthogonal, of determinant 1 or -1 */
	double rms;         /* mm: root mean square, over the matter of both, of the distance from the centre of a class to
	                     * the nearest one of the other shape, at the deepest level of 16 or less that both have */
} eskel_superposition;

/* The best of either hand: a turned (proper), and a mirrored and turned (improper), centre on centre. Size is not
 * changed, and does not count in which is best. */
ESKEL_API void eskel_superposition_find(const eskel_skeleton *a, const eskel_skeleton *b,
	eskel_superposition *proper, eskel_superposition *improper);

/* ---------------------------------------------------------------------------------------------- surface */

/* A surface (section 3) is the zero set of a potential d, without unit, negative inside. Each class of a level has a
 * primitive with a potential d_i of its own, and these are composed:
 *   blend  d = -ln sum_i exp(-alpha_i d_i)   Blinn's; smooth
 *   union  d = min_i d_i
 *
 * A primitive is a superquadric in a frame of its own, deformed. From a point p to its potential, with z along the class's
 * longest axis and everything in units of the radius c along it:
 *   1. moved    q = axes (p - centre) / c
 *   2. bent     x -= bx(q_z), y -= by(q_z); then (x, y) turned by -twist(q_z)
 *   3. scaled   x *= c/a e^(-tx(q_z)), y *= c/b e^(-ty(q_z))
 *   4. warped   y *= e^(-skew x), z -= cup(x, y), z *= e^(-wedge(x, y)), with x and y as they were before this step
 *   5. measured d = N(N(x^2, y^2; e1), z^2; e2) - 1, N(u, v; e) = (u^(1/e) + v^(1/e))^e
 * Steps 2 to 4 change some coordinates by amounts that depend on the others alone, so each is undone exactly whatever its
 * parameters. These are Barr's taper, twist and bend, and polynomials of higher degree in their place; the 21 modes with
 * 3 of translation, 3 of rotation and 3 radii are the 30 parameters of section 3.5. Coordinates that modes depend on
 * count as +-1.25 beyond +-1.25.
 *
 * Where the paper slips, and where we differ:
 * - The ellipsoid of section 3.3 is d = (p - G) Q (p - G)^T - 1 with Q = M^-1 / gamma^2: the printed D has lambda^(-1/2) for
 *   1 / lambda, and the world form lacks the -1. gamma = 2 is right for a blend and sqrt 5 for a union or a single class.
 * - The superquadric of section 3.4 needs |x|, |y|, |z|. Its (e1, e2) are Barr's (e2, e1): here as in the paper, e1
 *   shapes the section across z and e2 the profile along it; 1 is round, near 0 a box, 2 a pyramid.
 * - Its S grows with the power 2 / e2 of the distance from the centre, ours with its square: d = (S + 1)^e2 - 1. The
 *   surface and the sign are the same, an ellipsoid's d as well, and alpha means the same for any exponents. Creases are
 *   rounded, x^2 is x^2 + 2^-24 where e1 or e2 is not 1, so that all derivatives are finite.
 * - d is no length. The distance |d| / |grad d| of section 3.7 is in mm and of the first order.
 * - An even degree does not bound an algebraic surface (section 3.8): eskel_surface_set_algebraic.
 *
 * Lambda below h^2 / 12, the variance of one voxel of side h = (volume / voxels)^(1/3), counts as that: planes, lines and
 * single voxels get the thickness of a voxel. */
typedef enum {
	ESKEL_PRIMITIVE_ELLIPSOID,
	ESKEL_PRIMITIVE_SUPERQUADRIC,   /* with exponents */
	ESKEL_PRIMITIVE_DEFORMED,       /* with exponents and modes */
	ESKEL_PRIMITIVE_ALGEBRAIC
} eskel_primitive_kind;

typedef enum { ESKEL_COMPOSE_BLEND, ESKEL_COMPOSE_UNION } eskel_compose;

/* Z is q_z; x and y are those of step 4. */
typedef enum {
	ESKEL_MODE_TAPER_X, ESKEL_MODE_TAPER_Y,         /* tx, ty: Z */
	ESKEL_MODE_BEND_X, ESKEL_MODE_BEND_Y,           /* bx, by: Z^2 */
	ESKEL_MODE_TWIST,                               /* Z, in radians */
	ESKEL_MODE_BULGE_X, ESKEL_MODE_BULGE_Y,         /* tx, ty: Z^2 */
	ESKEL_MODE_TAPER3_X, ESKEL_MODE_TAPER3_Y,       /* tx, ty: Z^3 */
	ESKEL_MODE_BEND3_X, ESKEL_MODE_BEND3_Y,         /* bx, by: Z^3 */
	ESKEL_MODE_BEND4_X, ESKEL_MODE_BEND4_Y,         /* bx, by: Z^4 */
	ESKEL_MODE_TWIST2, ESKEL_MODE_TWIST3,           /* Z^2, Z^3 */
	ESKEL_MODE_CUP_XX, ESKEL_MODE_CUP_XY, ESKEL_MODE_CUP_YY, /* cup: x^2, x y, y^2 */
	ESKEL_MODE_WEDGE_X, ESKEL_MODE_WEDGE_Y,         /* wedge: x, y */
	ESKEL_MODE_SKEW,                                /* skew: x */
	ESKEL_MODE_COUNT
} eskel_mode;

/* Ranges in which everything stays finite, for points within 1e7 mm of the centre. */
#define ESKEL_MODE_MAX 2.0          /* of |mode| */
#define ESKEL_EXPONENT_MIN 0.1
#define ESKEL_EXPONENT_MAX 1.9
#define ESKEL_RADIUS_MIN 1e-3       /* mm */
#define ESKEL_RADIUS_MAX 1e6
#define ESKEL_ALPHA_MIN 1e-3
#define ESKEL_ALPHA_MAX 1e3

typedef struct {
	eskel_primitive_kind kind;
	double centre[3];                   /* mm */
	double axes[3][3];                  /* rows: the unit x, y, z of the frame; right-handed */
	double radii[3];                    /* mm: a, b, c */
	double exponents[2];                /* e1, e2 */
	double modes[ESKEL_MODE_COUNT];
	double alpha;
} eskel_primitive;

typedef struct {
	eskel_primitive_kind primitive;     /* what a fit may change; all start as ellipsoids. ALGEBRAIC: see below */
	eskel_compose compose;
	double gamma;                       /* radii in standard deviations; default 2, of a union or a single class sqrt 5 */
	double alpha;                       /* of all classes; default 1 */
} eskel_surface_options;

typedef struct eskel_surface eskel_surface;

/* The surface of a level before any fit: the best ellipsoid of each class. ESKEL_INVALID unless the skeleton has the level,
 * gamma is 0.1 to 10, and alpha and the radii that come out are in range. */
ESKEL_API eskel_status eskel_surface_new(const eskel_skeleton *skeleton, uint32_t level,
	const eskel_surface_options *options, eskel_surface **surface);
/* From primitives, none algebraic. ESKEL_INVALID when a number is out of its range or count is not 1 to ESKEL_LEVELS_MAX. */
ESKEL_API eskel_status eskel_surface_compose(const eskel_primitive *primitives, uint32_t count, eskel_compose compose,
	eskel_surface **surface);
ESKEL_API void eskel_surface_free(eskel_surface *surface);

ESKEL_API uint32_t eskel_surface_count(const eskel_surface *surface);
ESKEL_API eskel_compose eskel_surface_composition(const eskel_surface *surface);
/* Of class class_index < count; NULL otherwise. */
ESKEL_API const eskel_primitive *eskel_surface_primitive(const eskel_surface *surface, uint32_t class_index);

/* Replaces the primitive of a class by an algebraic surface of degree 2, 4 or 6 (section 3.8) through boundary points of the
 * class, by least squares, in the class's frame; alpha stays. It is bounded: where the points alone do not make it so, it is
 * drawn to the ellipsoid as much as needed, and proven to lie within three radii along each axis (algebraic.h).
 * ESKEL_INVALID for another degree, a class that there is not, no point, or a point that is not finite; ESKEL_NUMERIC for
 * points too far off to be fitted. */
ESKEL_API eskel_status eskel_surface_set_algebraic(eskel_surface *surface, uint32_t class_index, unsigned degree,
	const double (*points)[3], size_t count);

/* The polynomial of an algebraic class: its coefficients, the surface's own, by powers of x descending, then of y, then of z,
 * where x, y and z are along the class's axes in units of its radii. NULL for other classes. */
ESKEL_API const double *eskel_surface_polynomial(const eskel_surface *surface, uint32_t class_index, unsigned *degree);

/* The potential at a point. */
ESKEL_API double eskel_surface_value(const eskel_surface *surface, const double point[3]);
ESKEL_API void eskel_surface_values(const eskel_surface *surface, size_t count, const double (*points)[3], double *values);
/* The potential, and its gradient in 1/mm. A union's is that of the class that comes first among the least. */
ESKEL_API double eskel_surface_gradient(const eskel_surface *surface, const double point[3], double gradient[3]);
/* d / |grad d| in mm, negative inside, and the unit normal, outwards (0 where there is none). Good to a few percent within a
 * tenth of a radius of the surface. Never more, either way, than the larger of the greatest radius and the distance to the
 * nearest centre. normal may be NULL. */
ESKEL_API double eskel_surface_distance(const eskel_surface *surface, const double point[3], double normal[3]);
/* Exact: d < 0. */
ESKEL_API bool eskel_surface_contains(const eskel_surface *surface, const double point[3]);

ESKEL_API eskel_status eskel_surface_encode(const eskel_surface *surface, uint8_t **bytes, size_t *size);
ESKEL_API eskel_status eskel_surface_decode(const uint8_t *bytes, size_t size, eskel_surface **surface,
	eskel_error *error);

/* ---------------------------------------------------------------------------------------------- mesh */

/* Triangles with vertices in world space, mm; counterclockwise as seen from outside. Normals have length 1 and point
 * outwards. */
typedef struct {
	size_t vertex_count, triangle_count;
	float (*vertices)[3];
	float (*normals)[3];        /* of the surface at the vertices */
	uint32_t (*triangles)[3];   /* vertices */
} eskel_mesh;

ESKEL_API void eskel_mesh_free(eskel_mesh *mesh);

/* mm^2. */
ESKEL_API double eskel_mesh_area(const eskel_mesh *mesh);
/* mm^3, of a closed mesh; negative if its triangles are clockwise from outside. */
ESKEL_API double eskel_mesh_volume(const eskel_mesh *mesh);

typedef struct {
	size_t boundary_edges;      /* of one triangle; 0: the mesh is closed */
	size_t crowded_edges;       /* of more than two */
	size_t crowded_vertices;    /* whose triangles do not follow one another around it */
	size_t turned_edges;        /* along which two triangles run the same way; 0: the mesh is oriented */
	size_t components;          /* joined over vertices */
	int64_t euler;              /* vertices of triangles - edges + triangles: 2 for each sphere, 0 for a torus */
	double least_angle;         /* degrees, of a triangle's corner */
	bool is_manifold;           /* closed, oriented and without crowded edges or vertices */
} eskel_mesh_check_result;

/* ESKEL_INVALID if a triangle has a vertex twice, or one that is not there. O(n log n). */
ESKEL_API eskel_status eskel_mesh_check(const eskel_mesh *mesh, eskel_mesh_check_result *result);

/* The surface with a node of the lattice for each step^3 (mm): a closed manifold with the surface's normals, of at most
 * triangles_max (0: 2^24) triangles. A union of ellipsoids is made of triangles with edges of about a step on each of them,
 * cut where they meet: creases are sharp, and every piece is there, however small. Where ellipsoids touch without crossing,
 * or creases are too close to one another, it is made as the others are. ESKEL_INVALID for a step that is not positive, ESKEL_TOO_LARGE for more triangles, and
 * where modes or an algebraic class lead far beyond the radii, ESKEL_EMPTY where the step is so large that no surface is
 * met. */
ESKEL_API eskel_status eskel_surface_mesh(const eskel_surface *surface, double step, size_t triangles_max,
	eskel_mesh **mesh, eskel_error *error);

/* The surface of the voxels, for comparison: their faces, in two triangles each, without regard to weights. Voxels that touch
 * in an edge or a corner alone are apart, so that it is a closed manifold. ESKEL_TOO_LARGE for a box of more than 2^31 voxels. */
ESKEL_API eskel_status eskel_cloud_mesh(const eskel_cloud *cloud, eskel_mesh **mesh, eskel_error *error);

typedef struct {
	double error;           /* mm: how far the surface may move, by quadrics; 0: as far as it takes */
	size_t triangles;       /* to be reached, as far as the error allows; 0: as few as it allows */
} eskel_simplify_options;

/* A coarser mesh, by meshoptimizer: some of the vertices, with their normals. A closed manifold stays one: where the library
 * leaves none, less is simplified. error, in mm, is what the library says of the result. */
ESKEL_API eskel_status eskel_mesh_simplify(
	const eskel_mesh *mesh, const eskel_simplify_options *options, eskel_mesh **simplified, double *error);

/* Orders triangles and vertices as graphics processors read them fastest, by meshoptimizer. Nothing else changes. */
ESKEL_API eskel_status eskel_mesh_reorder(eskel_mesh *mesh);

typedef enum {
	ESKEL_MESH_STL, /* binary; the frame in its header */
	ESKEL_MESH_PLY, /* binary little endian, with normals; the frame in a comment */
	ESKEL_MESH_OBJ, /* with normals; the frame in a comment */
	ESKEL_MESH_GLB, /* glTF 2.0: metres, Y up and Z to the front by the transform of its node; the frame in its extras */
	ESKEL_MESH_FORMAT_COUNT
} eskel_mesh_format;

/* The axes that vertices are written in: those of the engine, or x to the left and y to the back, as DICOM and ITK have
 * them. STL, PLY and OBJ say SPACE=RAS or SPACE=LPS as 3D Slicer reads it; their unit is mm. */
typedef enum { ESKEL_FRAME_RAS, ESKEL_FRAME_LPS } eskel_frame;

/* Takes the next bytes of a file; false stops writing. */
typedef bool (*eskel_mesh_sink)(void *context, const uint8_t *bytes, size_t size);

/* Writes a file piece by piece, without holding it. The same mesh always gives the same bytes. ESKEL_CANCELLED if the sink
 * stopped; ESKEL_TOO_LARGE for a GLB of 4 GB; ESKEL_EMPTY for a GLB without triangles, which glTF does not allow. */
ESKEL_API eskel_status eskel_mesh_write(const eskel_mesh *mesh, eskel_mesh_format format, eskel_frame frame,
	eskel_mesh_sink sink, void *context);

/* ---------------------------------------------------------------------------------------------- reconstruction */

/* How far a surface and a cloud are apart, mm. The cloud's surface is its voxel faces (6 neighbours); points on it are their
 * centres, each for its area. These are up to half a voxel off the surface that was sampled: 0.17 voxel in the mean over
 * directions, below which no mean can go. */
typedef struct {
	double mean_delta, greatest_delta;  /* |d| / |grad d| from the boundary (section 3.7): first-order, too small or too
	                                     * large where |grad d| changes; saturating at the cube root of the volume */
	double mean_error, greatest_error;  /* e_me and e_max: the exact distance from the boundary to the surface */
	double mean_distance;               /* symmetric: half of e_me and of the mean distance from surface to boundary */
	double hausdorff_95;                /* of both ways, the larger 95th percentile */
	double dice;                        /* of voxel centres in the cloud and in the surface */
	double volume_ratio;                /* voxel centres in the surface over those in the cloud */
} eskel_surface_error;

/* ESKEL_EMPTY if there is no surface, ESKEL_TOO_LARGE for more than 2^26 voxel faces or if it is thrice as wide as the cloud
 * and more. About 0.1 s for 100,000 voxels. */
ESKEL_API eskel_status eskel_surface_errors(const eskel_surface *surface, const eskel_cloud *cloud, uint32_t threads,
	eskel_surface_error *errors, eskel_error *error);

/* How a surface is fitted to a cloud (sections 3.6 and 3.8); all but the last fit a blend:
 *   joint    all parameters of all classes at once, by Levenberg and Marquardt from the best ellipsoids
 *   tabu     the paper's: each primitive to the boundary of its class, by tabu search, then descent; then the alphas.
 *            Parts of a class's boundary that other classes cover are not the surface's, so where it helps is narrow
 *   hopping  joint, then again from perturbed parameters; what is better is kept. Never worse than joint
 *   squares  least squares: the union of an algebraic surface of degree 4 for each class, through the boundary that is
 *            nearest to its centre; a class that has none stays its best ellipsoid. Fast; from level 4 on the mean error is
 *            a third to two thirds above that of joint */
typedef enum { ESKEL_FIT_JOINT, ESKEL_FIT_TABU, ESKEL_FIT_HOPPING, ESKEL_FIT_LEAST_SQUARES } eskel_fit_method;

/* What a fit may change beside centre, axes, radii and alpha; of least squares it says nothing. */
typedef enum {
	ESKEL_FIT_DEFORMED,                 /* exponents and all modes */
	ESKEL_FIT_DEFORMED_SIMPLY,          /* exponents, taper, bend and twist */
	ESKEL_FIT_SUPERQUADRIC,             /* exponents */
	ESKEL_FIT_ELLIPSOID                 /* nothing */
} eskel_fit_freedom;

typedef struct {
	eskel_fit_method method;
	eskel_fit_freedom freedom;
	uint32_t boundary_points;           /* that are fitted to, 8 to 1,000,000; default 1200 + 150 level */
	uint64_t seed;                      /* of tabu and hopping */
	uint32_t hops;                      /* hopping: default 10, at most 1000 */
	uint32_t tabu_neighbours;           /* t_n: default 5, at most 1000 */
	uint32_t tabu_memory;               /* t_v: default 10, at most 64 */
	uint32_t tabu_steps;                /* default 200, at most 1,000,000 */
	double tabu_threshold;              /* mm, root mean square: a class with less is done; default a quarter of a voxel */
	uint32_t threads;                   /* at most; default 1 */
	bool (*progress)(void *context, uint32_t step, uint32_t steps); /* now and then; false: ESKEL_CANCELLED */
	void *context;
} eskel_fit_options;

typedef struct {
	uint32_t level;
	eskel_surface *surface;             /* fitted; eskel_surface_encode makes its bytes, which need no cloud */
	eskel_surface_error before, after;  /* of the blend of best ellipsoids, alpha 1, and of the surface */
} eskel_reconstruction;

/* Fits a surface of the classes of a level to the cloud that the skeleton is of. ESKEL_INVALID unless it has the level and the
 * options are in range; ESKEL_TOO_LARGE as eskel_surface_errors. */
ESKEL_API eskel_status eskel_surface_fit(const eskel_cloud *cloud, const eskel_skeleton *skeleton, uint32_t level,
	const eskel_fit_options *options, eskel_reconstruction **reconstruction, eskel_error *error);
ESKEL_API void eskel_reconstruction_free(eskel_reconstruction *reconstruction);

#endif
