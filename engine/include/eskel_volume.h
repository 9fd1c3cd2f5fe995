/* Volumes that are decoded and written, and the clouds of voxels that they hold. Part of eskel.h. */
#ifndef ESKEL_VOLUME_H
#define ESKEL_VOLUME_H

#include "eskel_base.h"

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

#endif
