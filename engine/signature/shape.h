/* The features of one shape: the 32-bit floats that stand for it wherever shapes are compared.
 *
 * The numbers of a signature are brought to volume 1, by dividing lengths by V^(1/3), and kept as
 * f = ln(number + 0.02). The lengths in mm of the paper's signature are derived from the same floats by
 * (exp f - 0.02) V^(1/3), so there is one copy, and every route to a distance starts from the same bits.
 *
 * A level is 5 rows of k floats, one row a number, each row ascending; a rank says which of a row belongs to which
 * class. Sorted rows are all that lower bounds need (bound.h), and a search computes far more bounds than matchings,
 * which must put the classes together again.
 *
 * All of a shape lies in one piece, deepest level last: what a search reads of it, level after level, lies one after the
 * other. A shape never changes. */
#ifndef ESK_SHAPE_H
#define ESK_SHAPE_H

#include "elementary.h"
#include "eskel.h"

enum {
	ESK_NUMBERS_MAX = ESKEL_SIGNATURE_NUMBERS,
	ESK_PAPER_NUMBERS = 4,  /* the paper's signature has no solidity */
	ESK_SUMMED_LEVELS = 16, /* a distance sum goes no deeper */
	ESK_LEVEL_FLOATS_MAX = ESK_NUMBERS_MAX * ESKEL_LEVELS_MAX
};

/* Keeps the logarithm of a flat class's zero finite. Distances barely depend on it: anything from 0.005 to 0.1 ranks
 * shapes alike. */
#define ESK_SHAPE_OFFSET 0.02

/* How many numbers a class has in a kind of signature. */
static inline uint32_t esk_numbers(eskel_signature_kind kind)
{
	return kind == ESKEL_SIGNATURE_PAPER ? ESK_PAPER_NUMBERS : ESKEL_SIGNATURE_NUMBERS;
}

/* After the numbers of levels 1, 2, .. come the ranks, packed (shape.c). */
typedef struct {
	uint32_t level_count;
	float log_volume; /* ln V */
	float scale;      /* V^(1/3), mm */
	float numbers[];
} esk_shape;

/* ESKEL_INVALID when the signature is (signature.h). */
eskel_status esk_shape_new(const eskel_signature *signature, esk_shape **shape);
void esk_shape_release(esk_shape *shape);

/* Of a shape with so many levels, in bytes. */
size_t esk_shape_size(uint32_t level_count);
/* Writes the shape of a valid signature to memory of its size. */
void esk_shape_write(const eskel_signature *signature, esk_shape *shape);

/* The 5 sorted rows of k features of a level that the shape has. */
static inline const float *esk_shape_sorted(const esk_shape *shape, uint32_t level)
{
	return shape->numbers + ESK_NUMBERS_MAX * ESKEL_NODES(level - 1);
}

/* Puts the first rows of a level, sorted alike, into the order of classes. */
void esk_shape_unsort(const esk_shape *shape, uint32_t level, const float *sorted, uint32_t row_count, float *rows);

/* The size-free length of a feature: exp feature - 0.02; a length of 0 stays 0. */
static inline float esk_shape_length(float feature)
{
	const float length = esk_elementary_exp(feature) - (float)ESK_SHAPE_OFFSET;
	/* Below 1e-8 the difference is the rounding of a zero. */
	return length > 1e-8f ? length : 0;
}

/* Those of count features, times unit. */
void esk_shape_lengths(const float *features, size_t count, float unit, float *lengths);

/* The halves of a level: for each size-free number of its k classes, in ascending order, the sum of the lower half of them and
 * the sum of the upper half, both divided by k; of an odd number the middle one counts half in each. */
void esk_shape_halves(const esk_shape *shape, eskel_signature_kind kind, uint32_t level, float *halves);
/* Before they are divided, of the sorted rows of a level. */
void esk_shape_half_sums(const float *rows, eskel_signature_kind kind, uint32_t level, double *sums);

#endif
