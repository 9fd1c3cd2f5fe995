/* The one way to a distance: eskel_distance, matches, distance tables and both searches compute every D_k here, so all
 * agree to the last bit. */
#ifndef ESK_DISTANCE_H
#define ESK_DISTANCE_H

#include "shape.h"

#include <math.h>

/* One shape about to be compared with many. */
typedef struct {
	const esk_shape *shape;
	eskel_signature_kind signature;
	eskel_metric metric;
	bool size_counts, summed;
	double size_weight;                    /* of the difference of ln V, or its root, or 0 */
	uint32_t deepest;                      /* no level above this counts in the distance */
	const float *rows[ESKEL_LEVELS_MAX];   /* level k at k - 1: esk_numbers(signature) rows of k, by class */
	const float *sorted[ESKEL_LEVELS_MAX]; /* the same, each row ascending */
	float *owned;
} esk_query;

/* ESKEL_INVALID when an option is outside its range; NULL means all defaults. The shape must outlive it. */
eskel_status esk_query_init(esk_query *query, const esk_shape *shape, const eskel_distance_options *options);
void esk_query_clear(esk_query *query);

/* The deepest level that counts between the query and a shape of so many levels. */
static inline uint32_t esk_query_depth_at(const esk_query *query, uint32_t level_count)
{
	uint32_t depth = query->deepest < query->shape->level_count ? query->deepest : query->shape->level_count;
	return depth < level_count ? depth : level_count;
}

static inline uint32_t esk_query_depth(const esk_query *query, const esk_shape *other)
{
	return esk_query_depth_at(query, other->level_count);
}

/* What a difference in size adds to a distance: zero or more. */
static inline double esk_query_size_term(const esk_query *query, float log_volume)
{
	const float difference = fabsf(query->shape->log_volume - log_volume);
	return query->size_weight * (double)(query->metric == ESKEL_METRIC_ROOT ? sqrtf(difference) : difference);
}

/* The numbers of another shape, each row ascending, in the query's units: where they are or in
 * scratch[ESK_LEVEL_FLOATS_MAX]. */
const float *esk_query_sorted(const esk_query *query, const esk_shape *other, uint32_t level, float *scratch);
/* D_k at a level that both have. */
double esk_query_level(const esk_query *query, const esk_shape *other, uint32_t level);
/* The distance from D_1..D_depth, of which only the last is used unless levels are summed. */
double esk_query_combine(const esk_query *query, const esk_shape *other, const double *levels);
/* The distance, and all of D_1..D_depth into levels unless NULL. */
double esk_query_distance(const esk_query *query, const esk_shape *other, double *levels);

/* eskel_match_level for a level that both have. */
eskel_status esk_match_shapes(const esk_shape *a, const esk_shape *b, const eskel_distance_options *options,
	uint32_t level, eskel_match *match);

#endif
