/* Two shapes compared: their handedness, which class of one is which of the other, signatures that see more, and one
 * laid on the other. Part of eskel.h. */
#ifndef ESKEL_COMPARISON_H
#define ESKEL_COMPARISON_H

#include "eskel_skeleton.h"

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

#endif
