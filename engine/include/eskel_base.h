/* What all parts of the engine share: statuses and errors, affines, warnings. Part of eskel.h. */
#ifndef ESKEL_BASE_H
#define ESKEL_BASE_H

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

#endif
