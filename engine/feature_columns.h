/* Features: the 32-bit floats that stand for a shape wherever shapes are compared.
 *
 * A shape's numbers (signature.c) are brought to volume 1, by dividing lengths by V^(1/3), and kept as
 * f = ln(number + 0.02). The lengths in mm of the paper's signature are derived from the same floats by
 * (exp f - 0.02) V^(1/3), so there is one copy, and every route to a distance starts from the same bits.
 *
 * The features of many shapes lie in columns, contiguous for each level, because a search reads one level of many
 * shapes before it reads all levels of a few. A single shape is columns with one slot. */
#ifndef ESK_FEATURE_COLUMNS_H
#define ESK_FEATURE_COLUMNS_H

#include "eskel.h"

enum {
	ESK_NUMBERS_MAX = ESKEL_SIGNATURE_NUMBERS,
	ESK_PAPER_NUMBERS = 4,  /* the paper's signature has no solidity */
	ESK_SUMMED_LEVELS = 16, /* a distance sum goes no deeper */
	ESK_LEVEL_FLOATS_MAX = ESK_NUMBERS_MAX * ESKEL_LEVELS_MAX
};

/* How many numbers a class has in a kind of signature. */
static inline uint32_t esk_numbers(eskel_signature_kind kind)
{
	return kind == ESKEL_SIGNATURE_PAPER ? ESK_PAPER_NUMBERS : ESKEL_SIGNATURE_NUMBERS;
}

/* A level's block of a slot is 5 rows of k floats, one row a number, each row ascending; rank (c, i) says which of row c
 * belongs to class i. Sorted rows are what lower bounds need (bound.h), and they are the greater part of the work;
 * matching puts the classes together again.
 *
 * Means serve lower bounds too. They are indexed by eskel_signature_kind; the paper's are those of the size-free lengths.
 * level_means: for each slot and level 1..16 the mean of each number over the level's classes. total_means: for each
 * number a column over slots, the mean of its level means over the slot's levels 1..16. */
typedef struct {
	uint32_t capacity;
	uint8_t *level_counts;
	float *log_volumes;               /* ln V */
	float *scales;                    /* V^(1/3), mm */
	float *levels[ESKEL_LEVELS_MAX];  /* [capacity][5][k]; NULL until a slot has the level */
	uint8_t *ranks[ESKEL_LEVELS_MAX]; /* [capacity][5][k], half bytes up to k = 16, then bytes */
	float *level_means[2];            /* [capacity][16][numbers] */
	float *total_means[2];            /* [numbers][capacity] */
} esk_columns;

typedef struct {
	const esk_columns *columns;
	uint32_t slot;
} esk_shape;

eskel_status esk_columns_new(uint32_t capacity, esk_columns **columns);
void esk_columns_free(esk_columns *columns);

/* Writes a slot; ESKEL_INVALID when the signature is (signature.h). A failure leaves the slot unwritten. */
eskel_status esk_columns_put(esk_columns *columns, uint32_t slot, const eskel_signature *signature);
eskel_status esk_columns_copy(esk_columns *columns, uint32_t slot, esk_shape from);

static inline uint32_t esk_shape_level_count(esk_shape shape)
{
	return shape.columns->level_counts[shape.slot];
}

static inline float esk_shape_log_volume(esk_shape shape)
{
	return shape.columns->log_volumes[shape.slot];
}

static inline float esk_shape_scale(esk_shape shape)
{
	return shape.columns->scales[shape.slot];
}

/* The 5 sorted rows of k features of a level that the shape has. */
static inline const float *esk_shape_sorted(esk_shape shape, uint32_t level)
{
	return shape.columns->levels[level - 1] + (size_t)shape.slot * ESK_NUMBERS_MAX * level;
}

/* Puts the first rows of a level, sorted alike, into the order of classes. */
void esk_shape_unsort(esk_shape shape, uint32_t level, const float *sorted, uint32_t row_count, float *rows);

/* The numbers of levels 1..16, as rows; those of levels that the shape lacks mean nothing. */
static inline const float *esk_shape_level_means(esk_shape shape, eskel_signature_kind kind)
{
	return shape.columns->level_means[kind] + (size_t)shape.slot * ESK_SUMMED_LEVELS * esk_numbers(kind);
}

/* lengths[n] = (exp features[n] - 0.02) unit; a length of 0 stays 0. */
void esk_features_lengths(const float *features, size_t count, float unit, float *lengths);

#endif
